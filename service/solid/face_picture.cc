#include "service/solid/face_picture.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "service/solid/face.h"

namespace soffit {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

constexpr double kSamples = 90.0;    // Of each face, about.
constexpr double kOffFace_m = 1e-3;  // Samples lie so far before it.
constexpr double kStraight_px =
    64.0;  // Of the undistorted picture: a lens bends so little by hardly a tenth.

Kernel::Point_3 ToPoint(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

std::array<Eigen::Vector3d, 3> CornersOf(const Mesh& mesh, std::size_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  const auto& at = mesh.vertices_in_map_m;
  return {at[static_cast<std::size_t>(a)], at[static_cast<std::size_t>(b)], at[static_cast<std::size_t>(c)]};
}

/// A point for a part of a face.
struct Sample {
  Eigen::Vector3d at;
  Eigen::Vector3d normal;
  double share = 0.0;  ///< Of the face's area.
};

std::vector<Sample> SamplesOf(const Mesh& mesh, const Face& face) {
  std::vector<double> areas;
  double whole = 0.0;
  for (const std::size_t triangle : face.triangles) {
    const auto [a, b, c] = CornersOf(mesh, triangle);
    areas.push_back(0.5 * (b - a).cross(c - a).norm());
    whole += areas.back();
  }
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < areas.size() && whole > 0.0; ++i) {
    const auto [a, b, c] = CornersOf(mesh, face.triangles[i]);
    const Eigen::Vector3d normal = NormalOf(mesh, face.triangles[i]);
    const int parts = std::max(1, static_cast<int>(std::ceil(std::sqrt(kSamples * areas[i] / whole))));
    const double share = areas[i] / whole / (parts * parts);
    for (int row = 0; row < parts; ++row) {
      for (int k = 0; k < 2 * (parts - row) - 1; ++k) {  // Upright and turned triangles by turns.
        const double turned = k % 2 == 0 ? 1.0 : 2.0;
        const double u = (k / 2 + turned / 3.0) / parts, v = (row + turned / 3.0) / parts;
        samples.push_back({a + u * (b - a) + v * (c - a) + kOffFace_m * normal, normal, share});
      }
    }
  }
  return samples;
}

/// One picture that a face may have come from.
class Candidate {
 public:
  Candidate(const Sight& sight, const Tree& tree) : sight_(sight), tree_(tree) {
    const Intrinsics& k = sight.view.intrinsics;
    const double left = sight.shown.x - 0.5 - k.cx_px, right = sight.shown.br().x - 0.5 - k.cx_px;
    const double upper = sight.shown.y - 0.5 - k.cy_px, lower = sight.shown.br().y - 0.5 - k.cy_px;
    edges_ = {Eigen::Vector3d(k.fx_px, 0, -left), Eigen::Vector3d(-k.fx_px, 0, right),
              Eigen::Vector3d(0, k.fy_px, -upper), Eigen::Vector3d(0, -k.fy_px, lower)};
  }

  /// None when it shows nothing of the face.
  std::optional<FacePicture> Show(const Mesh& mesh, const Face& face) const {
    FacePicture picture;
    picture.capture_id = sight_.capture_id;
    for (const Sample& sample : SamplesOf(mesh, face)) {
      if (Shows(sample)) picture.shown_ratio += sample.share;
    }
    if (!(picture.shown_ratio > 0.0)) return std::nullopt;
    for (const Ring3& ring : OutlineOf(mesh, face)) {
      Ring seen = Draw(ring);
      if (picture.outline_px.outer.empty()) {
        picture.outline_px.outer = std::move(seen);
      } else if (!seen.empty()) {
        picture.outline_px.holes.push_back(std::move(seen));
      }
    }
    return picture;
  }

 private:
  Eigen::Vector3d InCamera(const Eigen::Vector3d& in_map_m) const {
    return (sight_.view.map_from_camera.Inverse() * Point<Map>{in_map_m}).xyz_m;
  }

  bool Shows(const Sample& sample) const {
    const Eigen::Vector3d& camera = sight_.view.map_from_camera.translation_m;
    if (!(sample.normal.dot(camera - sample.at) > 0.0)) return false;
    const Eigen::Vector3d p = InCamera(sample.at);
    const bool is_inside = std::ranges::all_of(edges_, [&](const auto& edge) { return edge.dot(p) > 0.0; });
    return is_inside && !tree_.do_intersect(Kernel::Segment_3(ToPoint(camera), ToPoint(sample.at)));
  }

  /// What of a ring lies within the picture (I. Sutherland and G. Hodgman, 1974), in its pixels.
  Ring Draw(const Ring3& ring) const {
    Ring3 kept;
    for (const Eigen::Vector3d& p : ring) kept.push_back(InCamera(p));
    for (const Eigen::Vector3d& edge : edges_) {
      const Ring3 whole = std::exchange(kept, {});
      for (std::size_t i = 0; i < whole.size(); ++i) {
        const Eigen::Vector3d &a = whole[i], &b = whole[(i + 1) % whole.size()];
        const double of_a = edge.dot(a), of_b = edge.dot(b);
        if (of_a >= 0.0) kept.push_back(a);
        if ((of_a >= 0.0) != (of_b >= 0.0)) kept.push_back(a + of_a / (of_a - of_b) * (b - a));
      }
    }
    Ring drawn;
    for (std::size_t i = 0; i < kept.size(); ++i) DrawSide(kept[i], kept[(i + 1) % kept.size()], drawn);
    return drawn;
  }

  /// All but its end; several pieces where the lens bends it.
  void DrawSide(const Eigen::Vector3d& from, const Eigen::Vector3d& to, Ring& drawn) const {
    const Eigen::Vector2d first = from.hnormalized(), last = to.hnormalized();
    const bool bends = std::ranges::any_of(sight_.taken.distortion, [](double d) { return d != 0.0; });
    const double length_px = (last - first).norm() * sight_.view.intrinsics.fx_px;
    const int pieces = bends ? std::max(1, static_cast<int>(std::ceil(length_px / kStraight_px))) : 1;
    const Eigen::Vector2d end(sight_.taken.width_px - 0.5, sight_.taken.height_px - 0.5);
    for (int i = 0; i < pieces; ++i) {
      const Eigen::Vector2d pixel = PixelOf(sight_.taken, first + i * (last - first) / pieces);
      drawn.emplace_back(pixel.cwiseMax(-0.5).cwiseMin(end));
    }
  }

  const Sight& sight_;
  const Tree& tree_;
  std::array<Eigen::Vector3d, 4> edges_;  ///< Planes through the camera; positive inside.
};

using Captures = std::vector<std::uint32_t>;

/// The pictures that the facades of a solid's walls were read from.
Captures FacadePicturesOf(const Face& face, const Solid& solid, const std::vector<Facade>& facades) {
  std::vector<int> walls = {face.wall};
  for (const Passage& passage : solid.passages) {
    if (face.opening >= 0 && passage.entry_opening == static_cast<std::size_t>(face.opening))
      walls = {passage.entry_wall, passage.exit_wall};
  }
  Captures captures;
  for (const Facade& facade : facades) {
    if (facade.object_id == solid.footprint.object_id && facade.was_seen &&
        std::ranges::count(walls, facade.side) > 0)
      captures.push_back(facade.capture_id);
  }
  return captures;
}

Captures OutlinePicturesOf(const Footprint& footprint) {
  Captures captures;
  for (const Silhouette& silhouette : footprint.silhouettes) captures.push_back(silhouette.capture_id);
  return captures;
}

std::optional<FacePicture> FindBest(const Captures& captures,
                                    const std::map<std::uint32_t, Candidate>& pictures, const Mesh& mesh,
                                    const Face& face) {
  std::optional<FacePicture> best;
  double most_px = 0.0;
  for (const std::uint32_t capture : captures) {
    const auto candidate = pictures.find(capture);
    if (candidate == pictures.end()) continue;
    std::optional<FacePicture> picture = candidate->second.Show(mesh, face);
    if (!picture) continue;
    const double shown_px = picture->shown_ratio * std::abs(SignedArea(picture->outline_px.outer));
    if (best && shown_px <= most_px) continue;
    most_px = shown_px;
    best = std::move(picture);
  }
  return best;
}

}  // namespace

std::vector<Solid> FindFacePictures(std::vector<Solid> solids, const std::vector<Facade>& facades,
                                    const std::vector<Sight>& sights) {
  Triangles triangles;
  for (const Solid& solid : solids) {
    for (std::size_t i = 0; i < solid.mesh.triangles.size(); ++i) {
      const auto [a, b, c] = CornersOf(solid.mesh, i);
      triangles.emplace_back(ToPoint(a), ToPoint(b), ToPoint(c));
    }
  }
  const Tree tree(triangles.begin(), triangles.end());
  std::map<std::uint32_t, Candidate> pictures;
  for (const Sight& sight : sights) {
    SOFFIT_EXPECT(IsValid(sight.taken));
    pictures.try_emplace(sight.capture_id, sight, tree);
  }
  for (Solid& solid : solids) {
    const Captures outline = OutlinePicturesOf(solid.footprint);
    for (Face& face : solid.faces) {
      face.picture = FindBest(FacadePicturesOf(face, solid, facades), pictures, solid.mesh, face);
      if (!face.picture) face.picture = FindBest(outline, pictures, solid.mesh, face);
    }
  }
  return solids;
}

}  // namespace soffit
