#pragma once

#include <octomap/OcTree.h>

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "shared/result/result.h"

namespace soffit {

/// OctoMap's two formats: `.bt` tells free from occupied, `.ot` keeps the log-odds of each node.
enum class MapFormat { kBinary, kFull };

/// What a map file says of itself, in `FILE.json` beside it.
struct MapManifest {
  MapFormat format = MapFormat::kBinary;
  std::string sha256;                                  ///< Of the whole file, hexadecimal.
  std::string frame;                                   ///< "map": ENU metres about the home point.
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();  ///< Of the octree's coordinates, in the frame's.
  std::uint64_t scene_revision = 0;
  double resolution_m = 0.0;
  std::uint64_t nodes = 0;
  std::uint64_t bytes = 0;
};

/// A file as OctoMap's own programs read it. Same tree, same bytes.
std::string EncodeMap(const octomap::OcTree& octree, MapFormat format);

/// The tree of a file's bytes. Before OctoMap sees them they are walked through: the header, the depth (at
/// most 16), the number of nodes (as the header says, at most `kMaxMapNodes`), every value finite, and not a
/// byte too few or too many. OctoMap's own reader trusts all of that.
Result<std::shared_ptr<const octomap::OcTree>> DecodeMap(std::span<const std::uint8_t> bytes);
inline constexpr std::uint64_t kMaxMapNodes = 200'000'000;

/// Writes the map and then its manifest, each as a whole.
Status WriteMap(const std::filesystem::path& file, const octomap::OcTree& octree,
                std::uint64_t scene_revision, MapFormat format,
                const Eigen::Vector3d& origin_m = Eigen::Vector3d::Zero());

struct MapFile {
  std::shared_ptr<const octomap::OcTree> octree;
  MapManifest manifest;
};

/// Reads a map that has to be what its manifest says: an error when that is missing, or when anything of it
/// differs.
Result<MapFile> ReadMap(const std::filesystem::path& file);

}  // namespace soffit
