#include "service/viewpoint/viewpoint.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace soffit {
namespace {

constexpr double kDown = -std::numbers::pi / 2.0;
constexpr double kCurveTurn_rad = 0.7;  // Sides that turn less against each other are one curved wall.
constexpr double kSeenIncidence_rad =
    0.8;                                // A wall seen under a greater angle to its normal is not seen well.
constexpr double kLowViewRatio = 0.15;  // Height of a level camera over the height of the wall.
constexpr double kLeastUnknownHeight_m = 3.0;
constexpr double kOtherHorizon_m =
    0.3;  // Haze hides what is at a camera's own height: opposite views differ in it.
constexpr double kLeastTangent = 0.02;  // Of a field of view, for optical axes near the picture's edge.

/// Tangents of the angles from the optical axis to the nearer edges of the picture, less what framing leaves
/// free.
struct FieldOfView {
  double side;
  double up;
  double down;
};

FieldOfView FieldOf(const Intrinsics& k, double framing) {
  SOFFIT_EXPECT(IsValid(k));
  const auto tangent = [framing](double from_axis_px, double focal_px) {
    return std::max(framing * from_axis_px / focal_px, kLeastTangent);
  };
  return {tangent(std::min(k.cx_px, k.width_px - 1 - k.cx_px), k.fx_px), tangent(k.cy_px, k.fy_px),
          tangent(k.height_px - 1 - k.cy_px, k.fy_px)};
}

Eigen::Vector2d Corner(const Ring& ring, std::size_t i) { return ring[i % ring.size()]; }

Eigen::Vector2d Along(const Ring& ring, std::size_t side) {
  return (Corner(ring, side + 1) - Corner(ring, side)).normalized();
}

Eigen::Vector2d Outward(const Ring& ring, std::size_t side) {
  const Eigen::Vector2d along = Along(ring, side);
  return {along.y(), -along.x()};
}

double Length(const Ring& ring, std::size_t side) {
  return (Corner(ring, side + 1) - Corner(ring, side)).norm();
}

Eigen::Vector2d Turned(const Eigen::Vector2d& v, double by_rad) { return Eigen::Rotation2Dd(by_rad) * v; }

double Angle(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0));
}

double HeightOf(const Footprint& object) {
  if (object.height_m > 0.0) return object.height_m;
  double longest_m = 0.0;
  const Ring& ring = object.polygon_in_map_m.outer;
  for (std::size_t i = 0; i < ring.size(); ++i) longest_m = std::max(longest_m, Length(ring, i));
  return std::max(kLeastUnknownHeight_m, longest_m / 2.0);
}

bool Crosses(const Ring& ring, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const auto cross = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
  };
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d a = ring[i];
    const Eigen::Vector2d b = Corner(ring, i + 1);
    const bool splits = cross(to - from, a - from) * cross(to - from, b - from) <= 0.0;
    const bool is_split = cross(b - a, from - a) * cross(b - a, to - a) <= 0.0;
    if (splits && is_split) return true;
  }
  return false;
}

/// Whether a place sees the whole side: nothing stands on the lines to points just before it.
bool SeesSide(const Eigen::Vector2d& place, const Ring& ring, std::size_t side,
              const std::vector<Footprint>& others) {
  constexpr int kSamples = 9;
  constexpr double kBefore_m = 0.01;
  for (int i = 0; i <= kSamples; ++i) {
    const double t = 0.02 + 0.96 * i / kSamples;
    const Eigen::Vector2d point =
        (1.0 - t) * Corner(ring, side) + t * Corner(ring, side + 1) + kBefore_m * Outward(ring, side);
    if (Crosses(ring, place, point)) return false;
    for (const Footprint& other : others) {
      if (other.object_id == 0) continue;  // Things that are no buildings hide too little of a wall.
      if (Crosses(other.polygon_in_map_m.outer, place, point)) return false;
    }
  }
  return true;
}

/// Off buildings by `distance_m`, off other things (without an id) by what the envelope needs.
bool IsFree(const Eigen::Vector2d& place, const Footprint& object, const std::vector<Footprint>& map,
            double distance_m, double envelope_m) {
  const auto is_free_of = [&](const Footprint& footprint) {
    const Ring& ring = footprint.polygon_in_map_m.outer;
    const double keep_m = footprint.object_id == 0 ? envelope_m : distance_m;
    return !Contains(ring, place) && DistanceToRing(place, ring) >= keep_m;
  };
  return is_free_of(object) && std::all_of(map.begin(), map.end(), is_free_of);
}

/// `map` may hold an older shape of the object itself.
std::vector<Footprint> OthersThan(const Footprint& object, const std::vector<Footprint>& map) {
  std::vector<Footprint> others;
  std::copy_if(map.begin(), map.end(), std::back_inserter(others),
               [&](const Footprint& other) { return other.object_id != object.object_id; });
  return others;
}

double KeepOff_m(const VehicleEnvelope& vehicle, const ViewpointOptions& options) {
  return vehicle.radius_m + vehicle.safety_margin_m + options.min_distance_m;
}

/// The corners of a side and of its neighbours that belong to the same curve.
std::vector<Eigen::Vector2d> CurveAround(const Ring& ring, std::size_t side) {
  const std::size_t n = ring.size();
  const auto belongs = [&](std::size_t other) {
    return Angle(Outward(ring, side), Outward(ring, other % n)) < kCurveTurn_rad;
  };
  std::vector<Eigen::Vector2d> corners = {Corner(ring, side), Corner(ring, side + 1)};
  for (std::size_t i = 1; i < n && belongs(side + i); ++i) corners.push_back(Corner(ring, side + i + 1));
  for (std::size_t i = 1; i < n && belongs(side + n - i); ++i) corners.push_back(Corner(ring, side + n - i));
  return corners;
}

/// A level camera, its axis through a point of a wall.
struct LevelLook {
  Eigen::Vector2d target;
  Eigen::Vector2d heading;  ///< Unit.
  double distance_m;        ///< From the target.
  Eigen::Vector2d Place() const { return target - distance_m * heading; }
};

bool FitsSideways(const LevelLook& look, const std::vector<Eigen::Vector2d>& points,
                  const FieldOfView& field) {
  const Eigen::Vector2d left(-look.heading.y(), look.heading.x());
  return std::all_of(points.begin(), points.end(), [&](const Eigen::Vector2d& point) {
    const Eigen::Vector2d p = point - look.Place();
    const double depth_m = p.dot(look.heading);
    return depth_m > 0.0 && std::abs(p.dot(left)) <= field.side * depth_m;
  });
}

/// Least distance at which a level camera at `altitude_m` has both ends of the height range [0, height_m] in
/// view.
double LeastDistance(double height_m, double altitude_m, const FieldOfView& field) {
  return std::max(altitude_m / field.down, (height_m - altitude_m) / field.up);
}

bool ShowsWell(const Viewpoint& view, const Ring& ring, std::size_t side, const std::vector<Footprint>& map,
               const FieldOfView& field) {
  const Eigen::Vector2d place = view.position_in_map_m.head<2>();
  const Eigen::Vector2d heading(std::cos(view.yaw_rad), std::sin(view.yaw_rad));
  const std::vector<Eigen::Vector2d> ends = {Corner(ring, side), Corner(ring, side + 1)};
  const Eigen::Vector2d middle = (ends[0] + ends[1]) / 2.0;
  return Angle(place - middle, Outward(ring, side)) < kSeenIncidence_rad &&
         FitsSideways({place, heading, 0.0}, ends, field) && SeesSide(place, ring, side, map);
}

std::string NameOfSide(std::size_t rank) {
  static constexpr const char* kNames[] = {"front wall, the longest side", "right wall",
                                           "wall opposite of the front"};
  return rank < std::size(kNames) ? kNames[rank] : "another wall";
}

/// Front, right, opposite, then the rest by length. The ring is counter-clockwise, so its sides run to the
/// right of who stands before them.
std::vector<std::size_t> OrderSides(const Ring& ring) {
  const std::size_t n = ring.size();
  std::vector<std::size_t> by_length(n);
  for (std::size_t i = 0; i < n; ++i) by_length[i] = i;
  std::stable_sort(by_length.begin(), by_length.end(),
                   [&](std::size_t a, std::size_t b) { return Length(ring, a) > Length(ring, b) + 1e-9; });
  const std::size_t front = by_length.front();
  std::vector<std::size_t> order = {front};
  const auto facing = [&](const Eigen::Vector2d& direction) {
    return [&ring, direction](std::size_t side) { return Angle(Outward(ring, side), direction) < 0.8; };
  };
  for (const Eigen::Vector2d& direction : {Along(ring, front), Eigen::Vector2d(-Outward(ring, front))}) {
    const auto found = std::find_if(by_length.begin(), by_length.end(), facing(direction));
    if (found != by_length.end()) order.push_back(*found);
  }
  for (const std::size_t side : by_length) {
    if (std::find(order.begin(), order.end(), side) == order.end()) order.push_back(side);
  }
  return order;
}

/// Whether the view looks in about the opposite direction of the first one.
bool LooksBack(const Viewpoint& view, const std::vector<Viewpoint>& views) {
  return !views.empty() && std::cos(view.yaw_rad - views.front().yaw_rad) < -0.5;
}

}  // namespace

Viewpoint PlanOverview(const Eigen::Vector2d& center_in_map_m, double radius_m, const Intrinsics& camera,
                       const ViewpointOptions& options) {
  const FieldOfView field = FieldOf(camera, options.framing);
  const double fit_m = radius_m / std::min({field.side, field.up, field.down});
  const double altitude_m = std::min(std::max(options.overview_altitude_m, fit_m), options.max_altitude_m);
  return {Purpose::kOverview,
          {center_in_map_m.x(), center_in_map_m.y(), altitude_m},
          std::numbers::pi / 2.0,
          kDown,
          0,
          -1,
          "overview of the area"};
}

Viewpoint PlanTop(const Footprint& object, const Intrinsics& camera, const VehicleEnvelope& vehicle,
                  const ViewpointOptions& options) {
  const Ring& ring = object.polygon_in_map_m.outer;
  SOFFIT_EXPECT(ring.size() >= 3);
  const FieldOfView field = FieldOf(camera, options.framing);
  const Eigen::Vector2d along = Along(ring, OrderSides(ring).front());
  Eigen::Matrix2d box_from_map;
  box_from_map.row(0) = along;
  box_from_map.row(1) = Eigen::Vector2d(-along.y(), along.x());
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& corner : ring) box.extend(Eigen::Vector2d(box_from_map * corner));
  const Eigen::Vector2d half = box.sizes() / 2.0;
  const Eigen::Vector2d center = box_from_map.transpose() * box.center();

  const bool is_long_side_first = half.x() >= half.y();
  const double fit_m =
      std::max(half.maxCoeff() / field.side, half.minCoeff() / std::min(field.up, field.down));
  const double keep_off_m = vehicle.NeededHeight_m() + options.min_distance_m;
  double altitude_m = std::max(options.top_altitude_m, object.height_m + std::max(fit_m, keep_off_m));
  if (!(object.height_m > 0.0)) altitude_m = std::max(altitude_m, options.overview_altitude_m);
  altitude_m = std::min(altitude_m, options.max_altitude_m);

  // The picture's long side is across the heading.
  const Eigen::Vector2d heading = is_long_side_first ? Turned(along, std::numbers::pi / 2.0) : along;
  return {Purpose::kTop,
          {center.x(), center.y(), altitude_m},
          std::atan2(heading.y(), heading.x()),
          kDown,
          object.object_id,
          -1,
          "roof from above"};
}

std::optional<Viewpoint> PlanWall(const Footprint& object, int side, const std::vector<Footprint>& map,
                                  const Intrinsics& camera, const VehicleEnvelope& vehicle,
                                  const ViewpointOptions& options) {
  const Ring& ring = object.polygon_in_map_m.outer;
  SOFFIT_EXPECT(side >= 0 && static_cast<std::size_t>(side) < ring.size());
  const auto wall = static_cast<std::size_t>(side);
  const FieldOfView field = FieldOf(camera, options.framing);
  const double height_m = HeightOf(object);
  const double altitude_m =
      std::max({options.wall_altitude_m, kLowViewRatio * height_m, vehicle.NeededHeight_m() / 2.0});
  const double keep_off_m = KeepOff_m(vehicle, options);
  const double least_m = std::max(keep_off_m, LeastDistance(height_m, altitude_m, field));
  const std::vector<Footprint> others = OthersThan(object, map);
  const std::vector<Eigen::Vector2d> curve = CurveAround(ring, wall);
  const Eigen::Vector2d target = (Corner(ring, wall) + Corner(ring, wall + 1)) / 2.0;

  for (const double off_deg : {0.0, 10.0, -10.0, 20.0, -20.0, 30.0, -30.0, 40.0, -40.0}) {
    LevelLook look{target, Turned(-Outward(ring, wall), off_deg * std::numbers::pi / 180.0), least_m};
    while (!FitsSideways(look, curve, field)) look.distance_m *= 1.02;
    for (const double farther : {1.0, 1.2, 1.45}) {
      const LevelLook tried{target, look.heading, look.distance_m * farther};
      if (!IsFree(tried.Place(), object, others, keep_off_m, vehicle.radius_m + vehicle.safety_margin_m))
        continue;
      if (!SeesSide(tried.Place(), ring, wall, others)) continue;
      return Viewpoint{Purpose::kWall,
                       {tried.Place().x(), tried.Place().y(), altitude_m},
                       std::atan2(look.heading.y(), look.heading.x()),
                       0.0,
                       object.object_id,
                       side,
                       "wall"};
    }
  }
  return std::nullopt;
}

std::vector<Viewpoint> PlanWalls(const Footprint& object, const std::vector<Footprint>& map,
                                 const Intrinsics& camera, const VehicleEnvelope& vehicle,
                                 const ViewpointOptions& options) {
  const Ring& ring = object.polygon_in_map_m.outer;
  SOFFIT_EXPECT(ring.size() >= 3);
  const FieldOfView field = FieldOf(camera, 1.0);
  const Ring hull = ConvexHull(ring);
  const std::vector<Footprint> others = OthersThan(object, map);
  const std::vector<std::size_t> order = OrderSides(ring);
  std::vector<Viewpoint> views;

  const auto is_seen = [&](std::size_t side) {
    return std::any_of(views.begin(), views.end(),
                       [&](const Viewpoint& view) { return ShowsWell(view, ring, side, others, field); });
  };
  const auto is_half_of_hull_seen = [&] {
    std::size_t seen = 0;
    for (std::size_t i = 0; i < hull.size(); ++i) {
      seen += std::any_of(views.begin(), views.end(),
                          [&](const Viewpoint& view) { return ShowsWell(view, hull, i, {}, field); });
    }
    return 2 * seen >= hull.size();
  };

  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    const std::size_t side = order[rank];
    const bool is_wanted = Length(ring, side) >= vehicle.NeededWidth_m() || !is_half_of_hull_seen();
    if (!is_wanted || is_seen(side)) continue;
    std::optional<Viewpoint> view =
        PlanWall(object, static_cast<int>(side), others, camera, vehicle, options);
    if (!view) continue;
    view->reason = NameOfSide(rank);
    if (LooksBack(*view, views)) view->position_in_map_m.z() += kOtherHorizon_m;
    views.push_back(*view);
  }
  return views;
}

Viewpoint PlanCorridorLook(const Eigen::Vector3d& entry_in_map_m, const Eigen::Vector3d& exit_in_map_m,
                           const std::vector<Footprint>& map, const Intrinsics& camera,
                           const VehicleEnvelope& vehicle, const ViewpointOptions& options) {
  const Eigen::Vector2d heading = (exit_in_map_m - entry_in_map_m).head<2>().normalized();
  SOFFIT_EXPECT(heading.allFinite());
  const FieldOfView field = FieldOf(camera, options.framing);
  const double back_m = std::max(vehicle.NeededWidth_m() / 2.0 / field.side,
                                 vehicle.NeededHeight_m() / 2.0 / std::min(field.up, field.down));
  const auto is_free = [&](const Eigen::Vector2d& place) {
    return std::all_of(map.begin(), map.end(), [&](const Footprint& other) {
      const Ring& ring = other.polygon_in_map_m.outer;
      return !Contains(ring, place) &&
             DistanceToRing(place, ring) >= vehicle.radius_m + vehicle.safety_margin_m;
    });
  };
  Eigen::Vector2d place = entry_in_map_m.head<2>();
  constexpr int kSteps = 8;
  for (int i = 1; i <= kSteps; ++i) {
    const Eigen::Vector2d farther = entry_in_map_m.head<2>() - back_m * i / kSteps * heading;
    if (!is_free(farther)) break;
    place = farther;
  }
  return {Purpose::kCorridor,
          {place.x(), place.y(), entry_in_map_m.z()},
          std::atan2(heading.y(), heading.x()),
          0.0,
          0,
          -1,
          "look along the corridor"};
}

}  // namespace soffit
