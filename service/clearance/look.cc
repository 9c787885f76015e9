#include "service/clearance/look.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace soffit {
namespace {

constexpr std::size_t kMaxPlaces = 60;     // Of the unknown ones, evenly taken: more tell no more.
constexpr double kSameDirection = 0.9945;  // Cosine (6 degrees).
constexpr double kInPicture = 0.94;        // Of the picture's half width and height.
constexpr std::array<double, 4> kBack = {0.2, 1.0, 2.0, 3.5};  // Metres behind the corridor's end.
constexpr std::array<double, 5> kAside = {0.0, -0.3, 0.3, -0.7,
                                          0.7};  // Of the distance from the corridor's middle.
constexpr double kBeforeModel = 1.0;
constexpr double kBeforeGround = 0.8;
constexpr double kBeforeSky = 0.6;
constexpr double kLeastAltitude_m = 0.6;  // Of the vehicle's centre, beside what its envelope needs.

/// Share of the way from `from` to `to` and beyond at which a triangle is met; infinite when it is not.
double Meet(const Eigen::Vector3d& from, const Eigen::Vector3d& way, const Eigen::Vector3d& a,
            const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d ab = b - a, ac = c - a;
  const Eigen::Vector3d p = way.cross(ac);
  const double determinant = ab.dot(p);
  if (std::abs(determinant) < 1e-12) return kNever;
  const Eigen::Vector3d t = from - a;
  const double u = t.dot(p) / determinant;
  const Eigen::Vector3d q = t.cross(ab);
  const double v = way.dot(q) / determinant;
  if (u < 0.0 || v < 0.0 || u + v > 1.0) return kNever;
  const double at = ac.dot(q) / determinant;
  return at > 0.0 ? at : kNever;
}

class Lookout {
 public:
  Lookout(const Scene& scene, const std::vector<Sight>& sights, const VehicleEnvelope& vehicle)
      : scene_(scene), sights_(sights), vehicle_(vehicle) {}

  /// How much a picture from `place` along `forward` would tell of the places.
  double Score(const Eigen::Vector3d& place, const Eigen::Vector2d& forward,
               const std::vector<Eigen::Vector3d>& unknown_m) const {
    double score = 0.0;
    for (const Eigen::Vector3d& point : unknown_m) {
      if (IsInPicture(place, forward, point) && IsNew(place, point)) score += Background(place, point);
    }
    return score;
  }

  /// Free of every building by what the vehicle keeps from everything, and of all that stands there.
  bool HasRoom(const Eigen::Vector3d& place) const {
    const double keep_m = vehicle_.radius_m + vehicle_.safety_margin_m;
    const Eigen::Vector2d plan = place.head<2>();
    const auto is_near = [&](const Obstacle& thing) {
      return (plan - thing.base_in_map_m.head<2>()).norm() < thing.radius_m + 3.0 * thing.std_m + keep_m;
    };
    const bool is_clear = std::none_of(scene_.obstacles.begin(), scene_.obstacles.end(), is_near) &&
                          std::none_of(scene_.clutter.begin(), scene_.clutter.end(), is_near);
    return is_clear &&
           std::all_of(scene_.objects.begin(), scene_.objects.end(), [&](const SceneObject& object) {
             const Ring& ring = object.footprint.polygon_in_map_m.outer;
             return !Contains(ring, plan) && DistanceToRing(plan, ring) >= keep_m;
           });
  }

 private:
  bool IsInPicture(const Eigen::Vector3d& place, const Eigen::Vector2d& forward,
                   const Eigen::Vector3d& point) const {
    const Intrinsics& k = sights_.front().view.intrinsics;
    const Eigen::Vector3d way = point - place;
    const double depth = way.head<2>().dot(forward);
    const double side = way.x() * forward.y() - way.y() * forward.x();
    return depth > 0.3 && std::abs(side) <= kInPicture * 0.5 * k.width_px / k.fx_px * depth &&
           std::abs(way.z()) <= kInPicture * 0.5 * k.height_px / k.fy_px * depth;
  }

  bool IsNew(const Eigen::Vector3d& place, const Eigen::Vector3d& point) const {
    const Eigen::Vector3d direction = (place - point).normalized();
    return std::none_of(sights_.begin(), sights_.end(), [&](const Sight& sight) {
      return direction.dot((sight.view.map_from_camera.translation_m - point).normalized()) > kSameDirection;
    });
  }

  double Background(const Eigen::Vector3d& place, const Eigen::Vector3d& point) const {
    const Eigen::Vector3d way = point - place;
    double nearest = std::numeric_limits<double>::infinity();
    for (const Solid& solid : scene_.solids) {
      const auto& p = solid.mesh.vertices_in_map_m;
      for (const std::array<int, 3>& t : solid.mesh.triangles) {
        nearest =
            std::min(nearest, Meet(place, way, p[static_cast<std::size_t>(t[0])],
                                   p[static_cast<std::size_t>(t[1])], p[static_cast<std::size_t>(t[2])]));
      }
    }
    if (nearest <= 1.0) return 0.0;
    const double ground = way.z() < 0.0 ? -place.z() / way.z() : std::numeric_limits<double>::infinity();
    if (nearest < ground) return kBeforeModel;
    return std::isfinite(ground) ? kBeforeGround : kBeforeSky;
  }

  const Scene& scene_;
  const std::vector<Sight>& sights_;
  const VehicleEnvelope& vehicle_;
};

std::vector<Eigen::Vector3d> Thin(const std::vector<Eigen::Vector3d>& places) {
  std::vector<Eigen::Vector3d> kept;
  const std::size_t step = 1 + places.size() / kMaxPlaces;
  for (std::size_t i = step / 2; i < places.size(); i += step) kept.push_back(places[i]);
  return kept;
}

}  // namespace

std::optional<Viewpoint> PlanLook(const Scene& scene, const Corridor& corridor,
                                  const std::vector<Eigen::Vector3d>& unknown_m,
                                  const std::vector<Sight>& sights, const VehicleEnvelope& vehicle) {
  if (sights.empty() || unknown_m.empty()) return std::nullopt;
  const Lookout lookout(scene, sights, vehicle);
  const std::vector<Eigen::Vector3d> places = Thin(unknown_m);
  Eigen::Vector3d aim = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& place : places) aim += place / static_cast<double>(places.size());
  const double lowest_m =
      0.5 * vehicle.NeededHeight_m() + std::min(kLeastAltitude_m, vehicle.safety_margin_m);
  const double flown_m = corridor.entry_in_map_m.z();
  const double top_m = corridor.floor_m + corridor.free_height_m;
  const std::array<double, 4> heights = {flown_m, lowest_m, std::max(lowest_m, top_m - 0.1), top_m + 0.5};

  std::optional<Viewpoint> best;
  double best_score = 0.0;
  const std::vector<Eigen::Vector3d> path = corridor.Path();
  for (const bool is_reverse : {false, true}) {
    const Eigen::Vector3d& end = is_reverse ? path.back() : path.front();
    const Eigen::Vector3d& next = is_reverse ? path[path.size() - 2] : path[1];
    const Eigen::Vector3d middle = 0.5 * (end + next);
    const Eigen::Vector2d outward = (end - middle).head<2>().normalized();
    const Eigen::Vector2d aside(-outward.y(), outward.x());
    for (const double back_m : kBack) {
      const double distance_m = (end - middle).head<2>().norm() + back_m;
      for (const double share : kAside) {
        for (const double height_m : heights) {
          const Eigen::Vector2d plan = middle.head<2>() + distance_m * (outward + share * aside);
          const Eigen::Vector3d place(plan.x(), plan.y(), std::max(height_m, lowest_m));
          const Eigen::Vector2d forward = (aim.head<2>() - plan).normalized();
          if (!forward.allFinite() || !lookout.HasRoom(place)) continue;
          const double score = lookout.Score(place, forward, places);
          if (score <= best_score + 1e-9) continue;
          best_score = score;
          best = Viewpoint{Purpose::kCorridor,
                           place,
                           std::atan2(forward.y(), forward.x()),
                           0.0,
                           corridor.object_id,
                           -1,
                           "the parts of the corridor that were not seen to be free"};
        }
      }
    }
  }
  return best;
}

}  // namespace soffit
