#include "service/footprint/carve.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "service/footprint/cross.h"
#include "service/outline/region.h"
#include "service/outline/ring_fit.h"

namespace soffit {
namespace {

using Eigen::Vector2d;

struct Bounds {
  Vector2d low, high;
};

Bounds FindBounds(const Ring& ring) {
  Bounds bounds{ring.front(), ring.front()};
  for (const Vector2d& p : ring) {
    bounds.low = bounds.low.cwiseMin(p);
    bounds.high = bounds.high.cwiseMax(p);
  }
  return bounds;
}

/// A part of the ground as a bitmap.
class Grid {
 public:
  Grid(const Ring& extent, double least_cell_m) {
    constexpr double kMostCells = 400.0;
    const Bounds bounds = FindBounds(extent);
    const Vector2d size = bounds.high - bounds.low;
    cell_m_ = std::max(least_cell_m, size.maxCoeff() / kMostCells);
    origin_ = bounds.low - Vector2d::Constant(2.0 * cell_m_);
    cells_ = cv::Mat1b(static_cast<int>(size.y() / cell_m_) + 5, static_cast<int>(size.x() / cell_m_) + 5,
                       uchar{0});
  }

  void Fill(const std::vector<Ring>& rings, std::uint8_t value) {
    std::vector<std::vector<cv::Point>> shapes;
    for (const Ring& ring : rings) {
      shapes.emplace_back();
      for (const Vector2d& p : ring) {
        const Vector2d cell = (p - origin_) / cell_m_ * (1 << kShift);
        shapes.back().emplace_back(static_cast<int>(std::lround(cell.x())),
                                   static_cast<int>(std::lround(cell.y())));
      }
    }
    cv::fillPoly(cells_, shapes, cv::Scalar(value), cv::LINE_8, kShift);
  }

  /// The largest region that is filled.
  Polygon Trace() const {
    constexpr double kMinArea = 30.0;
    const std::vector<Region> regions = TraceRegions(cells_, kMinArea);
    if (regions.empty()) return {};
    Polygon polygon{FitOnMap(regions.front().boundary.outer), {}};
    if (polygon.outer.empty()) return {};
    for (const Ring& boundary : regions.front().boundary.holes) {
      Ring hole = FitOnMap(boundary);
      if (!hole.empty()) polygon.holes.push_back(std::move(hole));
    }
    return polygon;
  }

 private:
  Ring FitOnMap(const Ring& boundary) const {
    constexpr double kTolerance = 1.5;
    Ring ring = FitRing(boundary, 1.0, kTolerance).ring;
    for (Vector2d& p : ring) p = origin_ + cell_m_ * p;
    return ring;
  }

  static constexpr int kShift = 6;
  Vector2d origin_;
  double cell_m_ = 0.0;
  cv::Mat1b cells_;
};

Ring ProjectRing(const View& view, const Ring& ring_px, double height_m) {
  Ring ring;
  for (const Vector2d& pixel : ring_px) {
    const auto p = MeetHorizontalPlane(view, pixel, height_m);
    if (!p) return {};
    ring.push_back(*p);
  }
  std::reverse(ring.begin(), ring.end());  // Pixels are y down, seen from above.
  return ring;
}

/// Share of a region of the map at `height_m` that lies in the silhouette's blob.
double ShareSeen(const Silhouette& silhouette, const Ring& region, double height_m) {
  constexpr int kCells = 16;
  const Bounds bounds = FindBounds(region);
  int inside = 0;
  int seen = 0;
  for (int cell = 0; cell < kCells * kCells; ++cell) {
    const int column = cell % kCells;
    const int row = cell / kCells;
    const Vector2d share((column + 0.5) / kCells, (row + 0.5) / kCells);
    const Vector2d p = bounds.low + (bounds.high - bounds.low).cwiseProduct(share);
    if (!Contains(region, p)) continue;
    ++inside;
    const auto pixel = Project(silhouette.view, {p.x(), p.y(), height_m});
    if (pixel && Contains(silhouette.outline.polygon_px, *pixel)) ++seen;
  }
  return inside > 0 ? static_cast<double>(seen) / inside : 0.0;
}

bool IsUnderRoof(const Ring& dent, const std::vector<Silhouette>& silhouettes, double height_m) {
  constexpr double kMinShareOfRoof = 0.95;
  return std::all_of(silhouettes.begin(), silhouettes.end(), [&](const Silhouette& s) {
    return !IsWhole(s) || ShareSeen(s, dent, height_m) >= kMinShareOfRoof;
  });
}

/// The same where the ring is convex but for the dent: piers beside an opening may be too slim to be traced.
Ring ClosePockets(const Ring& ring, const Vector2d& nadir, const std::vector<Silhouette>& all,
                  double height_m) {
  const Ring hull = ConvexHull(ring);
  const auto is_on_hull = [&](const Vector2d& p) {
    return std::find(hull.begin(), hull.end(), p) != hull.end();
  };
  const auto first = std::find_if(ring.begin(), ring.end(), is_on_hull);
  if (first == ring.end()) return ring;
  Ring turned(first, ring.end());
  turned.insert(turned.end(), ring.begin(), first);
  Ring closed;
  for (std::size_t i = 0; i < turned.size();) {
    Ring pocket = {turned[i]};
    std::size_t next = i + 1;
    while (next < turned.size() && !is_on_hull(turned[next])) pocket.push_back(turned[next++]);
    pocket.push_back(turned[next % turned.size()]);
    const bool faces_nadir = Cross(pocket.front() - nadir, pocket.back() - pocket.front()) < 0.0;
    const bool is_opening = pocket.size() > 2 && faces_nadir && IsUnderRoof(pocket, all, height_m);
    closed.insert(closed.end(), pocket.begin(), is_opening ? pocket.begin() + 1 : pocket.end() - 1);
    i = next;
  }
  return closed;
}

}  // namespace

double GroundSampling_m(const Silhouette& s) {
  const Vector2d middle = Centroid(s.outline.polygon_px);
  const auto a = MeetHorizontalPlane(s.view, middle, 0.0);
  const auto b = MeetHorizontalPlane(s.view, middle + Vector2d(1.0, 0.0), 0.0);
  if (a && b) return (*a - *b).norm();
  return s.view.map_from_camera.translation_m.z() / s.view.intrinsics.fx_px;
}

Polygon ProjectOutline(const Silhouette& silhouette, double height_m) {
  Polygon polygon{ProjectRing(silhouette.view, silhouette.outline.polygon_px.outer, height_m), {}};
  if (polygon.outer.empty()) return {};
  for (const Ring& hole_px : silhouette.outline.polygon_px.holes) {
    Ring hole = ProjectRing(silhouette.view, hole_px, height_m);
    if (!hole.empty()) polygon.holes.push_back(std::move(hole));
  }
  return polygon;
}

Polygon Carve(const Silhouette& silhouette, double height_m) {
  const Polygon foot = ProjectOutline(silhouette, 0.0);
  const Polygon roof = ProjectOutline(silhouette, height_m);
  if (foot.outer.empty() || foot.holes.size() != roof.holes.size()) return {};
  std::vector<Ring> feet = foot.holes;
  std::vector<Ring> roofs = roof.holes;
  feet.push_back(foot.outer);
  roofs.push_back(roof.outer);
  Grid grid(foot.outer, 0.5 * GroundSampling_m(silhouette));
  grid.Fill(feet, 1);
  const Vector2d nadir = silhouette.view.map_from_camera.translation_m.head<2>();
  for (std::size_t r = 0; r < feet.size(); ++r) {
    for (std::size_t i = 0; i < feet[r].size(); ++i) {
      const std::size_t next = (i + 1) % feet[r].size();
      const bool faces_away = Cross(feet[r][i] - nadir, feet[r][next] - feet[r][i]) > 0.0;
      if (faces_away) grid.Fill({{feet[r][i], feet[r][next], roofs[r][next], roofs[r][i]}}, 0);
    }
  }
  return grid.Trace();
}

Ring CloseOpenings(Ring ring, const Silhouette& silhouette, const std::vector<Silhouette>& all,
                   double height_m) {
  constexpr std::size_t kMaxSides = 8;
  const double noise_m = GroundSampling_m(silhouette);
  const Vector2d nadir = silhouette.view.map_from_camera.translation_m.head<2>();
  const auto is_in_line = [&](const Vector2d& side, const Vector2d& along) {
    const double tolerance = 0.04 + 1.5 * noise_m / std::max(side.norm(), 1e-12);
    return side.dot(along) > 0.0 && std::abs(Cross(side.normalized(), along)) < std::min(tolerance, 0.2);
  };
  for (std::size_t i = 0; i < ring.size(); ++i) {
    for (std::size_t sides = 3; sides <= kMaxSides && sides + 3 <= ring.size(); ++sides) {
      const std::size_t n = ring.size();
      const auto at = [&](std::size_t k) { return ring[(i + k) % n]; };
      const Vector2d gap = at(sides) - at(0);
      const Vector2d along = gap.normalized();
      const bool faces_nadir = Cross(at(0) - nadir, gap) < 0.0;
      if (!faces_nadir || !is_in_line(at(0) - at(n - 1), along) ||
          !is_in_line(at(sides + 1) - at(sides), along)) {
        continue;
      }
      Ring dent;
      for (std::size_t k = 0; k <= sides; ++k) dent.push_back(at(k));
      const bool is_dent = std::all_of(dent.begin() + 1, dent.end() - 1, [&](const Vector2d& p) {
        return Cross(along, p - dent.front()) > 0.0;
      });
      if (!is_dent || !IsUnderRoof(dent, all, height_m)) continue;
      Ring closed;
      for (std::size_t k = sides + 1; k < n; ++k) closed.push_back(at(k));
      ring = std::move(closed);
      i = 0;
      sides = 2;
    }
  }
  return ClosePockets(ring, nadir, all, height_m);
}

Polygon Unite(const std::vector<Polygon>& polygons, double least_cell_m) {
  Ring corners;
  for (const Polygon& polygon : polygons)
    corners.insert(corners.end(), polygon.outer.begin(), polygon.outer.end());
  if (corners.empty()) return {};
  Grid grid(corners, least_cell_m);
  for (const Polygon& polygon : polygons) {
    std::vector<Ring> rings = polygon.holes;
    rings.push_back(polygon.outer);
    grid.Fill(rings, 1);
  }
  return grid.Trace();
}

std::vector<double> HeightsOfUprightSides(const Silhouette& silhouette) {
  constexpr double kTolerance = 0.04;
  const View& view = silhouette.view;
  const Vector2d nadir = view.map_from_camera.translation_m.head<2>();
  const double camera_m = view.map_from_camera.translation_m.z();
  const double noise_m = GroundSampling_m(silhouette);
  const Ring ring = ProjectOutline(silhouette, 0.0).outer;
  std::vector<double> heights;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vector2d a = ring[i] - nadir;
    const Vector2d b = ring[(i + 1) % ring.size()] - nadir;
    const double near = std::min(a.norm(), b.norm());
    const double far = std::max(a.norm(), b.norm());
    const double length = std::max(1e-9, (b - a).norm());
    const double tolerance =
        kTolerance + 1.5 * noise_m / length + 3.0 * camera_m * view.orientation_std_rad / far;
    const bool is_radial = a.dot(b) > 0.0 && std::abs(Cross(a, b)) / length < near * std::min(0.5, tolerance);
    if (is_radial && length > 3.0 * noise_m) heights.push_back(camera_m * (1.0 - near / far));
  }
  return heights;
}

}  // namespace soffit
