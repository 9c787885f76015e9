#include "test/sim/truth/passage.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "test/sim/world/clip.h"

namespace soffit::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kStep_rad = 5.0 * std::numbers::pi / 180.0;
constexpr int kMostPerDirection = 3;
constexpr double kLeastRatio = 0.35;  // Gaps that are narrower for their need are not worth telling.
constexpr double kMostRatio = 6.0;

struct Span {
  double low = 1e9;
  double high = -1e9;
  void Include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  double Length() const { return high - low; }
  double Middle() const { return 0.5 * (low + high); }
};

/// A free rectangle in the section across the direction of flight: u to the right, z up.
struct Gap {
  Span u;
  Span z;
};

using Convex = std::vector<Vector2d>;

/// From the building to where the vehicle's centre enters and leaves the line.
double Approach_m(const VehicleEnvelope& vehicle) {
  const double clearance_m = vehicle.radius_m + vehicle.safety_margin_m;
  return clearance_m + std::max(1.0, 0.5 * clearance_m);
}

/// Everything within a slab of space, seen along the direction of flight.
class Section {
 public:
  Section(const Site& site, double yaw_rad)
      : along_(std::cos(yaw_rad), std::sin(yaw_rad), 0.0), right_(along_.y(), -along_.x(), 0.0) {
    for (const Triangle& triangle : site.building) {
      for (const Vector3d& p : triangle) {
        reach_.Include(along_.dot(p));
        width_.Include(right_.dot(p));
        top_m_ = std::max(top_m_, p.z());
      }
    }
    approach_m_ = Approach_m(site.vehicle);
    const double slack_m = approach_m_ + site.vehicle.radius_m + site.vehicle.safety_margin_m;
    for (const Triangle& triangle : site.all) {
      std::vector<Vector3d> part(triangle.begin(), triangle.end());
      part = Clip(part, along_, reach_.low - slack_m);
      part = Clip(part, Vector3d(-along_), -(reach_.high + slack_m));
      if (part.size() >= 3) shapes_.push_back(Flatten(part));
    }
    for (const Triangle& triangle : site.building)
      building_.push_back(Flatten({triangle.begin(), triangle.end()}));
    cell_m_ = std::max(0.01, std::max(width_.Length(), top_m_) / 1000.0);
  }

  /// White where a vehicle cannot be: things, and all that is not below something of the building.
  cv::Mat1b DrawTaken() const {
    const cv::Size size(static_cast<int>(width_.Length() / cell_m_), static_cast<int>(top_m_ / cell_m_));
    cv::Mat1b taken(size, std::uint8_t{0}), building(size, std::uint8_t{0});
    for (const Convex& shape : shapes_) Draw(shape, taken);
    for (const Convex& shape : building_) Draw(shape, building);
    for (int column = 0; column < size.width; ++column) {
      for (int row = size.height - 1; row >= 0 && building(row, column) == 0; --row) taken(row, column) = 255;
    }
    return taken;
  }

  Gap FromCells(const cv::Rect& cells) const {
    return {{width_.low + cells.x * cell_m_, width_.low + (cells.x + cells.width) * cell_m_},
            {cells.y * cell_m_, (cells.y + cells.height) * cell_m_}};
  }

  /// The exact extent of a free rectangle that was found on the raster: first in the direction that binds.
  Gap Grow(const Gap& gap, const VehicleEnvelope& vehicle) const {
    const double width_ratio = gap.u.Length() / vehicle.NeededWidth_m(),
                 height_ratio = gap.z.Length() / vehicle.NeededHeight_m();
    Gap grown = gap;
    for (const bool in_width : {width_ratio <= height_ratio, width_ratio > height_ratio}) {
      if (in_width)
        grown.u = GrowAlong(grown, 0);
      else
        grown.z = GrowAlong(grown, 1);
    }
    return grown;
  }

  Vector3d Place(double u, double z, double along) const {
    return u * right_ + along * along_ + Vector3d(0, 0, z);
  }
  double cell_m() const { return cell_m_; }
  Span flight() const { return {reach_.low - approach_m_, reach_.high + approach_m_}; }

 private:
  Convex Flatten(const std::vector<Vector3d>& points) const {
    Convex flat;
    for (const Vector3d& p : points) flat.emplace_back(right_.dot(p), p.z());
    return flat;
  }

  void Draw(const Convex& shape, cv::Mat1b& raster) const {
    constexpr int kShift = 8;
    std::vector<cv::Point> corners;
    for (const Vector2d& p : shape) {
      corners.emplace_back(cv::saturate_cast<int>(((p.x() - width_.low) / cell_m_ - 0.5) * (1 << kShift)),
                           cv::saturate_cast<int>((p.y() / cell_m_ - 0.5) * (1 << kShift)));
    }
    cv::fillConvexPoly(raster, corners, 255, cv::LINE_8, kShift);
  }

  /// How far the gap reaches to both sides along one axis (0: u, 1: z), at its extent along the other.
  Span GrowAlong(const Gap& gap, int axis) const {
    const Span& other = axis == 0 ? gap.z : gap.u;
    const double inset = std::min(0.75 * cell_m_, 0.1 * other.Length());
    const double middle = (axis == 0 ? gap.u : gap.z).Middle();
    const Vector2d across = Vector2d::Unit(1 - axis);
    Span free = axis == 0 ? width_ : Span{0.0, top_m_};
    for (const Convex& shape : shapes_) {
      Convex part = Clip(shape, across, other.low + inset);
      part = Clip(part, Vector2d(-across), -(other.high - inset));
      Span taken;
      for (const Vector2d& p : part) taken.Include(p[axis]);
      if (taken.high <= middle)
        free.low = std::max(free.low, taken.high);
      else if (taken.low >= middle)
        free.high = std::min(free.high, taken.low);
    }
    return free;
  }

  Vector3d along_;
  Vector3d right_;
  Span reach_;
  Span width_;
  double top_m_ = 0.0;
  double approach_m_ = 0.0;
  double cell_m_ = 0.01;
  std::vector<Convex> shapes_;
  std::vector<Convex> building_;
};

/// A place for an empty rectangle of the given size, if there is one.
std::optional<cv::Rect> FindEmpty(const cv::Mat1i& integral, const cv::Size& size) {
  for (int row = 0; row + size.height < integral.rows; ++row) {
    const int* top = integral[row];
    const int* bottom = integral[row + size.height];
    for (int column = 0; column + size.width < integral.cols; ++column) {
      if (bottom[column + size.width] - bottom[column] == top[column + size.width] - top[column]) {
        return cv::Rect({column, row}, size);
      }
    }
  }
  return std::nullopt;
}

/// The largest empty rectangle of the vehicle's proportions.
std::optional<cv::Rect> FindLargest(const cv::Mat1b& taken, const VehicleEnvelope& vehicle, double cell_m) {
  cv::Mat1i integral;
  cv::integral(taken, integral, CV_32S);
  const auto size_at = [&](double ratio) {
    return cv::Size(std::max(1, static_cast<int>(ratio * vehicle.NeededWidth_m() / cell_m)),
                    std::max(1, static_cast<int>(ratio * vehicle.NeededHeight_m() / cell_m)));
  };
  std::optional<cv::Rect> best = FindEmpty(integral, size_at(kLeastRatio));
  double low = kLeastRatio, high = kMostRatio;
  while (best && high - low > 0.004) {
    const double middle = 0.5 * (low + high);
    if (const auto found = FindEmpty(integral, size_at(middle))) {
      best = found;
      low = middle;
    } else {
      high = middle;
    }
  }
  return best;
}

/// The vehicle with its margins moves along the line and touches nothing.
bool Sweeps(const Site& site, const Passage& passage) {
  constexpr double kRounding_m = 1e-4;
  const VehicleEnvelope& vehicle = site.vehicle;
  const Cylinder cylinder{passage.entry_m, vehicle.radius_m + vehicle.safety_margin_m - kRounding_m,
                          vehicle.NeededHeight_m() - 2.0 * kRounding_m};
  return site.space->IsFreeAlong(cylinder, passage.exit_m);
}

Passage Describe(const Site& site, const Section& section, const Gap& gap) {
  const VehicleEnvelope& vehicle = site.vehicle;
  Passage passage;
  passage.entry_m = section.Place(gap.u.Middle(), gap.z.Middle(), section.flight().low);
  passage.exit_m = section.Place(gap.u.Middle(), gap.z.Middle(), section.flight().high);
  passage.free_width_m = gap.u.Length();
  passage.free_height_m = gap.z.Length();
  passage.ratio = std::min(passage.free_width_m / vehicle.NeededWidth_m(),
                           passage.free_height_m / vehicle.NeededHeight_m());
  passage.spare_m = std::min(passage.free_width_m - vehicle.NeededWidth_m(),
                             passage.free_height_m - vehicle.NeededHeight_m());
  passage.is_passable = passage.spare_m >= 0.0 && Sweeps(site, passage);
  return passage;
}

std::vector<Passage> FindAlong(const Site& site, double yaw_rad) {
  const Section section(site, yaw_rad);
  cv::Mat1b taken = section.DrawTaken();
  std::vector<Passage> passages;
  for (int i = 0; i < kMostPerDirection; ++i) {
    const auto cells = FindLargest(taken, site.vehicle, section.cell_m());
    if (!cells) break;
    passages.push_back(Describe(site, section, section.Grow(section.FromCells(*cells), site.vehicle)));
    taken(*cells) = 255;
  }
  return passages;
}

/// Directions from 0 to 180 degrees along the largest upright faces, the walls of a slanted passage among
/// them, largest first.
std::vector<double> ListWallDirections(const std::vector<Triangle>& building) {
  constexpr int kMost = 12;
  constexpr double kBin_rad = 0.25 * std::numbers::pi / 180.0;
  struct Walls {
    double area_m2 = 0.0;
    double yaw_rad = 0.0;  ///< Of the largest.
    double largest_m2 = 0.0;
  };
  std::map<long, Walls> by_direction;
  for (const auto& [a, b, c] : building) {
    const Vector3d normal = 0.5 * (b - a).cross(c - a);
    if (!(std::abs(normal.z()) < 1e-3 * normal.norm())) continue;
    const double yaw =
        std::fmod(std::atan2(normal.x(), -normal.y()) + 2.0 * std::numbers::pi, std::numbers::pi);
    Walls& walls = by_direction[std::lround(yaw / kBin_rad)];
    walls.area_m2 += normal.norm();
    if (normal.norm() <= walls.largest_m2) continue;
    walls.largest_m2 = normal.norm();
    walls.yaw_rad = yaw;
  }
  std::vector<Walls> sorted;
  for (const auto& [bin, walls] : by_direction) sorted.push_back(walls);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Walls& a, const Walls& b) { return a.area_m2 > b.area_m2; });
  std::vector<double> directions;
  for (const Walls& walls : sorted) {
    if (directions.size() < kMost) directions.push_back(walls.yaw_rad);
  }
  return directions;
}

/// Directions from 0 to 180 degrees: across each side of the footprint first, then along the largest walls,
/// then evenly.
std::vector<double> ListDirections(const Site& site) {
  std::vector<double> directions;
  const auto add = [&](double yaw_rad, double least_rad) {
    const double yaw = std::fmod(yaw_rad + 4.0 * std::numbers::pi, std::numbers::pi);
    const bool is_known = std::any_of(directions.begin(), directions.end(), [&](double known) {
      return std::abs(std::remainder(yaw - known, std::numbers::pi)) < least_rad;
    });
    if (!is_known) directions.push_back(yaw);
  };
  for (const Polygon& polygon : site.footprint) {
    for (std::size_t i = 0; i < polygon.outer.size(); ++i) {
      const Vector2d side = polygon.outer[(i + 1) % polygon.outer.size()] - polygon.outer[i];
      add(std::atan2(-side.x(), side.y()), 1e-3);
    }
  }
  for (const double yaw : ListWallDirections(site.building)) add(yaw, 1e-3);
  for (double yaw = 0.0; yaw < std::numbers::pi; yaw += kStep_rad) add(yaw, 0.4 * kStep_rad);
  return directions;
}

bool IsNearlyTheSame(const Passage& a, const Passage& b, const VehicleEnvelope& vehicle) {
  constexpr double kAlike = 0.8;  // Cosine of the angle between.
  const Vector3d along_a = (a.exit_m - a.entry_m).normalized(), along_b = (b.exit_m - b.entry_m).normalized();
  const Vector3d apart = (a.exit_m + a.entry_m - b.exit_m - b.entry_m) / 2.0;
  return std::abs(along_a.dot(along_b)) > kAlike && apart.head<2>().norm() < vehicle.NeededWidth_m() &&
         std::abs(apart.z()) < vehicle.NeededHeight_m();
}

/// Leaves out what no line through the building comes near.
Site WithoutFarThings(const Site& site) {
  Vector3d low = site.building[0][0], high = low;
  for (const Triangle& triangle : site.building) {
    for (const Vector3d& p : triangle) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  const Vector2d middle = (low + high).head<2>() / 2.0;
  const double reach_m = (high - low).head<2>().norm() + 2.0 * Approach_m(site.vehicle);
  Site near = site;
  std::erase_if(near.all, [&](const Triangle& triangle) {
    const Vector3d center = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
    double radius_m = 0.0;
    for (const Vector3d& p : triangle) radius_m = std::max(radius_m, (p - center).norm());
    return (center.head<2>() - middle).norm() > reach_m + radius_m;
  });
  return near;
}

}  // namespace

std::vector<Passage> FindPassages(const Site& whole_site) {
  if (whole_site.building.empty()) return {};
  const Site site = WithoutFarThings(whole_site);
  std::vector<Passage> found;
  for (const double yaw : ListDirections(site)) {
    for (const Passage& passage : FindAlong(site, yaw)) found.push_back(passage);
  }
  // Passable before impassable; those across a wall, which were found first, before slanted ones that win by
  // a hair.
  std::stable_sort(found.begin(), found.end(), [](const Passage& a, const Passage& b) {
    return a.is_passable != b.is_passable ? a.is_passable : a.ratio > b.ratio + 0.02;
  });
  std::vector<Passage> passages;
  for (const Passage& passage : found) {
    const bool is_known = std::any_of(passages.begin(), passages.end(), [&](const Passage& known) {
      return IsNearlyTheSame(passage, known, site.vehicle);
    });
    if (!is_known) passages.push_back(passage);
  }
  return passages;
}

}  // namespace soffit::sim
