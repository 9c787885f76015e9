#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "service/scene/evidence.h"
#include "service/scene/voxels.h"

namespace soffit {

/// Gathers what pictures prove of voxels, one picture after the other; none is kept.
///
/// What is surely free is free, even when one picture shows one part of a voxel and another the rest, but for
/// where a bar stands, as it may not show from afar, and where a thin line may hang: there a picture has to
/// see the voxel free without a trace of a line. A thing that two pictures show from different directions
/// outweighs what is likely free; what is perhaps free takes two pictures from very different directions, and
/// none that shows a thing.
class Carving {
 public:
  /// @param voxels  What is kSolid stays so.
  explicit Carving(Voxels voxels);

  void Add(const Evidence& picture);

  /// All voxels as the pictures so far tell them.
  Voxels Judge() const;

  /// Capture ids of the two pictures that show a thing at this voxel from the most different directions.
  std::vector<std::uint32_t> CapturesOfThingAt(const Index& at) const;

 private:
  /// The two pictures of the most different directions among those that show something of a place; numbers
  /// from 1, 0 is none.
  struct Pair {
    std::uint16_t first = 0;
    std::uint16_t second = 0;
  };
  /// What the pictures prove of one voxel as a whole. There are many: a byte each.
  struct Proof {
    bool is_surely_free : 1 = false;
    bool is_likely_free : 1 = false;
    bool is_disputed : 1 = false;   ///< What is likely free by its colour is not, here.
    bool has_bar : 1 = false;       ///< A bar stands there, which other pictures may not resolve.
    bool has_line : 1 = false;      ///< A thin line may hang there,
    bool has_no_trace : 1 = false;  ///< and a picture that sees the voxel free shows not even a trace of it.
    bool has_parts : 1 = false;     ///< There is something in `parts_` for it,
    bool shows_things : 1 = false;  ///< and in `things_`.
  };
  /// A cube of voxels, some of which may lie beyond the grid.
  struct Block {
    Index first;
    int edge = 1;  ///< In voxels, a power of 2.
  };
  /// What they prove of the 4 x 4 x 4 parts of a voxel that no picture surely shows to be free as a whole; a
  /// bit stands for a part.
  struct Parts {
    std::uint64_t sure = 0;
    std::uint64_t likely = 0;
    std::uint64_t things = 0;
    std::uint16_t first = 0;            ///< Number of the first picture that shows some of it perhaps free.
    std::uint64_t perhaps = 0;          ///< Parts that it, or one from about its direction, shows so,
    std::uint64_t perhaps_besides = 0;  ///< and those that others do, from very different directions.

    bool AreFree() const;
  };

  void AddTo(const Block& block, const Evidence& picture);
  void Mark(const Block& block, Evidence::Sees sees, bool may_show_lines);
  void AddTo(std::size_t number, const Evidence& picture, const Eigen::Vector3d& center);
  void AddParts(Parts& parts, const Evidence& picture, const Eigen::Vector3d& center) const;
  void Widen(Pair& pair, const Eigen::Vector3d& place) const;
  double Cosine(std::uint16_t a, std::uint16_t b, const Eigen::Vector3d& place) const;
  double Cosine(const Pair& pair, const Eigen::Vector3d& place) const;
  Voxel Judge(std::size_t number, const Eigen::Vector3d& center) const;
  std::uint16_t last() const { return static_cast<std::uint16_t>(cameras_in_map_m_.size()); }

  Voxels voxels_;
  std::vector<Proof> proofs_;                     ///< By a voxel's number, as these;
  std::unordered_map<std::size_t, Parts> parts_;  ///< most voxels need none of them.
  std::unordered_map<std::size_t, Pair> things_;  ///< Pictures that show a thing there.
  std::vector<Eigen::Vector3d> cameras_in_map_m_;
  std::vector<std::uint32_t> capture_ids_;
};

}  // namespace soffit
