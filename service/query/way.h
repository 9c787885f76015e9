#pragma once

#include <string>
#include <vector>

#include "service/clearance/clearance.h"
#include "service/query/occupancy.h"

namespace soffit {

/// Whether a vehicle can fly a way, or which way it can fly.
struct Way {
  Verdict verdict = Verdict::kInsufficientData;
  std::string reason;
  std::vector<Eigen::Vector3d> points_in_map_m;  ///< Of the vehicle's centre.
  double length_m = 0.0;
  std::vector<Cell> in_the_way;  ///< Not CLEAR: what is occupied there, or what nothing is known of.
};

/// The straight lines between `points_in_map_m`, with radius, height and margin of the vehicle about them;
/// the margin has to hold what its position is uncertain by. CLEAR only when the exact geometry of the models
/// and a sweep of the OctoMap in which unknown counts as occupied agree. Pure.
Way CheckWay(const Scene& scene, const std::vector<Eigen::Vector3d>& points_in_map_m,
             const VehicleEnvelope& vehicle, const IsLate& is_late);

/// The shortest way around what is in the way, as CheckWay() finds it CLEAR (A*: P. Hart, N. Nilsson, B.
/// Raphael, 1968, on cells of the map of which `max_cells` bounds the number by making them larger). Without
/// any: what is in the way where the least is unknown, or else occupied. Pure.
Way FindWay(const Scene& scene, const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m,
            const VehicleEnvelope& vehicle, double max_cells, const IsLate& is_late);

}  // namespace soffit
