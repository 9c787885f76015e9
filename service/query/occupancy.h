#pragma once

#include <octomap/OcTree.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace soffit {

// What an OctoMap tells of places, without a copy of it. Unknown is where there is no node. All of this is
// pure and may run on many threads at once.

/// Zero is the safe one.
enum class Occupancy { kUnknown, kFree, kOccupied };
const char* ToString(Occupancy occupancy);

/// A cube, aligned with the tree.
struct Cell {
  Eigen::Vector3d center_in_map_m = Eigen::Vector3d::Zero();
  double size_m = 0.0;
  Occupancy occupancy = Occupancy::kUnknown;
};

/// The cube of the tree about `point` whose edge is the tree's resolution doubled until it is at least
/// `resolution_m`: occupied if any of it is, else unknown if any of it is, else free.
Cell CellAt(const octomap::OcTree& tree, const Eigen::Vector3d& point_m, double resolution_m);

/// Of a volume; together 1.
struct Shares {
  double free_ratio = 0.0;
  double occupied_ratio = 0.0;
  double unknown_ratio = 0.0;

  Occupancy Worst() const;  ///< Occupied if any of it is, else unknown if any of it is, else free.
};

/// Exact by volume: a cell that lies partly in the box counts with that part. The box is not empty.
Shares SharesOf(const octomap::OcTree& tree, const Eigen::AlignedBox3d& box_m);

/// Boxes of the edge `resolution_m` that fill `box_m` from its lowest corner on, each as its worst part.
struct CellGrid {
  Eigen::Vector3d low_in_map_m = Eigen::Vector3d::Zero();
  double resolution_m = 0.0;
  Eigen::Vector3i size = Eigen::Vector3i::Zero();
  std::vector<std::uint8_t> occupancy;  ///< Occupancy values, x fastest, then y, then z.

  std::size_t Index(const Eigen::Vector3i& at) const {
    return (static_cast<std::size_t>(at.z()) * static_cast<std::size_t>(size.y()) +
            static_cast<std::size_t>(at.y())) *
               static_cast<std::size_t>(size.x()) +
           static_cast<std::size_t>(at.x());
  }
  Eigen::Vector3d CenterOf(const Eigen::Vector3i& at) const {
    return low_in_map_m + resolution_m * (at.cast<double>().array() + 0.5).matrix();
  }
};
/// Of the cells that a grid would have; not finite when it would be absurd.
double CountCells(const Eigen::AlignedBox3d& box_m, double resolution_m);
CellGrid GridOf(const octomap::OcTree& tree, const Eigen::AlignedBox3d& box_m, double resolution_m);

/// The box around everything that is known; empty when nothing is.
Eigen::AlignedBox3d KnownBox(const octomap::OcTree& tree);

enum class RayEnd {
  kUnknown,     ///< It came to a cell that nothing is known of.
  kFree,        ///< Free as far as was asked.
  kHit,         ///< It came to an occupied cell.
  kOutOfRange,  ///< Free until it left KnownBox(), or it began outside.
};
const char* ToString(RayEnd end);

struct Ray {
  RayEnd end = RayEnd::kUnknown;
  double distance_m = 0.0;  ///< To where it ended.
  Cell cell;                ///< What it came to.
};

/// @param direction  Unit vector.
/// @param range_m  Infinite: as far as anything is known.
Ray CastRay(const octomap::OcTree& tree, const Eigen::Vector3d& from_m, const Eigen::Vector3d& direction,
            double range_m);

struct CellDistance {
  double distance_m = 0.0;  ///< To the nearest point of the cell; 0 inside.
  Eigen::Vector3d point_in_map_m = Eigen::Vector3d::Zero();
};

/// Tells a search to give up.
using IsLate = std::function<bool()>;

/// The nearest cell that is `wanted`, best first through the tree: exact. None within `range_m`, or late.
std::optional<CellDistance> FindNearest(const octomap::OcTree& tree, const Eigen::Vector3d& from_m,
                                        Occupancy wanted, double range_m, const IsLate& is_late);

struct Layer {
  double bottom_m = 0.0;
  double top_m = 0.0;
  Occupancy occupancy = Occupancy::kUnknown;
};

/// What is above each other at a place, lowest first, from the lowest to the highest known cell; alike
/// neighbours are one layer.
std::vector<Layer> LayersAt(const octomap::OcTree& tree, const Eigen::Vector2d& place_m);

/// Cells of which two maps tell different things. When their resolutions differ: everything, with `has_more`.
struct CellChanges {
  std::uint64_t count = 0;           ///< In cells of the finest resolution.
  Eigen::AlignedBox3d box_in_map_m;  ///< Around all of them; empty when there are none.
  std::vector<Cell> cells;           ///< As `after` has them; the first `max_cells`.
  bool has_more = false;
};
CellChanges CompareOctrees(const octomap::OcTree& before, const octomap::OcTree& after,
                           std::size_t max_cells);

}  // namespace soffit
