#include "service/edge/drawing/scene_picture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <numbers>
#include <thread>

#include "service/edge/drawing/canvas.h"
#include "service/edge/drawing/ray_scene.h"
#include "service/edge/drawing/shapes.h"
#include "service/edge/drawing/space_pen.h"

namespace soffit {
namespace {

constexpr int kGrid = 2;      // Rays per pixel and axis.
constexpr int kSkyRays = 24;  // Directions in which the light of the sky is sampled, for each pixel.
constexpr double kElevation_rad = 0.45;
constexpr double kBeside_rad = 0.65;  // The camera stands this far off the corridor's axis.
constexpr double kFocal = 1.5;        // In picture widths.

const Stroke kEdge{{40, 40, 40}, 1.2, false, false};
const Stroke kThrough{ink::kGreen, 2.5, false};
const Stroke kRecess{ink::kPurple, 2.5, true};
const Stroke kClear{ink::kBlue, 2.0, false};
const Stroke kRefused{ink::kVermilion, 2.0, true};
const Stroke kTrack{ink::kOrange, 3.0, false};
const Stroke kCamera{ink::kGrey, 1.5, false};
const cv::Vec3f kVoxel(0.0F, 0.37F, 0.84F);
const cv::Vec3f kGround(0.90F, 0.92F, 0.92F);
const cv::Vec3f kHorizon(1.0F, 0.99F, 0.97F);

cv::Vec3f PaintOf(const std::string& color) {
  static const std::map<std::string, cv::Vec3f> kPaints = {
      {"red", {0.25F, 0.28F, 0.80F}},    {"orange", {0.20F, 0.55F, 0.90F}}, {"yellow", {0.30F, 0.80F, 0.92F}},
      {"green", {0.35F, 0.68F, 0.35F}},  {"cyan", {0.75F, 0.75F, 0.30F}},   {"blue", {0.78F, 0.45F, 0.25F}},
      {"magenta", {0.65F, 0.35F, 0.75F}}};
  const auto found = kPaints.find(color);
  return found == kPaints.end() ? cv::Vec3f(0.6F, 0.6F, 0.6F) : found->second;
}

cv::Vec3f Blend(const cv::Vec3f& under, const cv::Vec3f& over, float opacity) {
  return under * (1.0F - opacity) + over * opacity;
}

/// Directions of a hemisphere around z, weighted by their cosine; a Fibonacci spiral.
std::vector<Eigen::Vector3d> SkyDirections() {
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < kSkyRays; ++i) {
    const double radius = std::sqrt((i + 0.5) / kSkyRays);
    const double angle = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
    directions.emplace_back(radius * std::cos(angle), radius * std::sin(angle),
                            std::sqrt(1.0 - radius * radius));
  }
  return directions;
}

/// Which of the sky's directions one ray of a pixel takes, turned differently in each pixel so that no bands
/// show.
struct SkySample {
  int first;
  double turn_rad;
};

/// Interleaved gradient noise (Jimenez 2014), 0 to 1.
double NoiseOf(int x, int y) {
  const double inner = 0.06711056 * x + 0.00583715 * y;
  const double outer = 52.9829189 * (inner - std::floor(inner));
  return outer - std::floor(outer);
}

/// The free space of one leg of a corridor, as glass.
struct Glass {
  Section near, far;
  cv::Vec3f color;

  /// Where the ray goes in and out.
  std::optional<std::pair<double, double>> Meet(const Eigen::Vector3d& from,
                                                const Eigen::Vector3d& direction) const {
    double in = -std::numeric_limits<double>::infinity();
    double out = std::numeric_limits<double>::infinity();
    const auto cut = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
      const Eigen::Vector3d outward = (b - a).cross(c - a);
      const double slope = direction.dot(outward);
      const double at = (a - from).dot(outward) / slope;
      (slope > 0.0 ? out : in) = slope > 0.0 ? std::min(out, at) : std::max(in, at);
    };
    cut(near[0], near[1], near[2]);
    cut(far[0], far[2], far[1]);
    for (std::size_t i = 0; i < 4; ++i) cut(near[i], far[i], near[(i + 1) % 4]);
    if (!(in < out)) return std::nullopt;
    return std::make_pair(in, out);
  }
};

class ScenePicture {
 public:
  ScenePicture(const Understanding& all, const std::vector<Observation>& observations,
               const std::vector<Eigen::Vector3d>& track, const cv::Size& size)
      : all_(all),
        observations_(observations),
        track_(track),
        shown_(ChooseShownDecisions(all.decisions)),
        focus_(Focus()),
        unit_m_(focus_.sizes().maxCoeff() / 100.0),
        view_(ChooseView(size)) {
    for (const Solid& solid : all.scene.solids) {
      const cv::Vec3f paint = PaintOf(solid.footprint.color);
      const bool is_wanted = IsWanted(solid.footprint.object_id);
      solids_.AddMesh(solid.mesh, is_wanted ? paint : Blend(paint, {0.8F, 0.8F, 0.8F}, 0.5F));
    }
    solids_.Commit();
    track_tube_.AddTube(track_, 0.35 * unit_m_, {0.0F, 0.62F, 0.90F});
    track_tube_.Commit();
    AddObstacles();
    obstacles_.Commit();
    for (const ClearanceDecision& decision : shown_) {
      const Stroke& stroke = StrokeOf(decision);
      const cv::Vec3d color(stroke.color[0], stroke.color[1], stroke.color[2]);
      const std::vector<Section> sections = decision.corridor->Sections();
      for (std::size_t i = 0; i + 1 < sections.size(); ++i)
        glasses_.push_back({sections[i], sections[i + 1], cv::Vec3f(color / 255.0)});
    }
  }

  Drawing Draw() {
    Canvas canvas(Render());
    DrawLines(canvas);
    std::vector<std::string> lines = DescribeDecisions(all_);
    return {canvas.picture(),
            "Enriched scene",
            lines,
            {{kThrough, "opening, goes through"},
             {kRecess, "opening, a recess"},
             {kClear, "corridor, CLEAR"},
             {kRefused, "corridor, refused"},
             {kTrack, "flown track"},
             {kCamera, "camera of a picture"},
             {{ink::kVermilion, 8.0, false}, "occupied beside the models"}}};
  }

 private:
  static const Stroke& StrokeOf(const ClearanceDecision& decision) {
    return decision.verdict == Verdict::kClear ? kClear : kRefused;
  }

  bool IsWanted(std::uint32_t object_id) const {
    return std::any_of(all_.scene.objects.begin(), all_.scene.objects.end(), [&](const SceneObject& object) {
      return object.is_matched && object.footprint.object_id == object_id;
    });
  }

  /// What has to be in the picture: the wanted buildings and their corridors, or else all buildings.
  Eigen::AlignedBox3d Focus() const {
    Eigen::AlignedBox3d box;
    const bool has_wanted = std::any_of(all_.scene.objects.begin(), all_.scene.objects.end(),
                                        [](const SceneObject& object) { return object.is_matched; });
    for (const SceneObject& object : all_.scene.objects) {
      if (has_wanted && !object.is_matched) continue;
      for (const Eigen::Vector2d& corner : object.footprint.polygon_in_map_m.outer) {
        box.extend(Eigen::Vector3d(corner.x(), corner.y(), 0.0));
        box.extend(Eigen::Vector3d(corner.x(), corner.y(), std::max(0.5, object.footprint.height_m)));
      }
    }
    for (const ClearanceDecision& decision : shown_) {
      for (const Section& section : decision.corridor->Sections()) {
        for (const Eigen::Vector3d& corner : section) box.extend(corner);
      }
    }
    if (box.isEmpty()) box = Eigen::AlignedBox3d(Eigen::Vector3d(-5, -5, 0), Eigen::Vector3d(5, 5, 2));
    const Eigen::Vector3d border = 0.15 * Eigen::Vector3d(box.sizes().x(), box.sizes().y(), 0.0);
    return {box.min() - border, box.max() + border};
  }

  double ChooseYaw() const {
    for (const ClearanceDecision& decision : shown_) {
      const Eigen::Vector3d along = decision.corridor->exit_in_map_m - decision.corridor->entry_in_map_m;
      return std::atan2(along.y(), along.x()) + kBeside_rad;
    }
    return std::numbers::pi / 4.0;
  }

  View ChooseView(const cv::Size& size) const {
    View view;
    view.intrinsics = {size.width,
                       size.height,
                       kFocal * size.width,
                       kFocal * size.width,
                       (size.width - 1) / 2.0,
                       (size.height - 1) / 2.0,
                       {}};
    view.map_from_camera.rotation = CameraAttitude(ChooseYaw(), -kElevation_rad);
    const Eigen::Vector3d forward = view.map_from_camera.rotation * Eigen::Vector3d::UnitZ();
    for (double distance_m = focus_.sizes().norm();; distance_m *= 1.05) {
      view.map_from_camera.translation_m = focus_.center() - distance_m * forward;
      Eigen::AlignedBox2d box;
      for (int i = 0; i < 8; ++i) {
        const auto pixel = Project(view, focus_.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)));
        box.extend(pixel.value_or(Eigen::Vector2d::Constant(1e9)));
      }
      if (box.sizes().x() > 0.95 * size.width || box.sizes().y() > 0.95 * size.height) continue;
      view.intrinsics.cx_px += size.width / 2.0 - box.center().x();
      view.intrinsics.cy_px += size.height / 2.0 - box.center().y();
      return view;
    }
  }

  /// Occupied space that no model accounts for: obstacles.
  void AddObstacles() {
    const octomap::OcTree& octree = *all_.scene.octree;
    const octomap::point3d low(static_cast<float>(focus_.min().x()), static_cast<float>(focus_.min().y()),
                               0.0F);
    const octomap::point3d high(static_cast<float>(focus_.max().x()), static_cast<float>(focus_.max().y()),
                                static_cast<float>(focus_.max().z() + 1.0));
    for (auto leaf = octree.begin_leafs_bbx(low, high); leaf != octree.end_leafs_bbx(); ++leaf) {
      if (!octree.isNodeOccupied(*leaf)) continue;
      const Eigen::Vector3d center(leaf.getX(), leaf.getY(), leaf.getZ());
      if (!IsInSolid(center, leaf.getSize())) obstacles_.AddBox(center, 0.9 * leaf.getSize(), kVoxel);
    }
  }

  /// A solid's surface passes through the voxel or close by, or all of the voxel lies inside.
  bool IsInSolid(const Eigen::Vector3d& center, double edge_m) const {
    for (int i = 0; i < 27; ++i) {
      const Eigen::Vector3i direction(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
      const Eigen::Vector3d towards = direction.cast<double>().normalized();
      if (i != 13 && solids_.IsBlocked(center, towards, 1.1 * edge_m)) return true;
    }
    return IsInsideSolids(center);
  }

  bool IsInsideSolids(Eigen::Vector3d point) const {
    bool inside = false;
    for (int crossings = 0; crossings < 1000; ++crossings) {
      const auto hit = solids_.Cast(point, Eigen::Vector3d::UnitZ());
      if (!hit) break;
      inside = !inside;
      point.z() += hit->distance_m + 1e-4;
    }
    return inside;
  }

  cv::Vec3f ColorOfGround(const Eigen::Vector3d& point) const {
    const double pitch_m = unit_m_ < 0.2 ? 1.0 : unit_m_ < 1.0 ? 5.0 : 20.0;
    const auto to_line_m = [pitch_m](double x) { return std::abs(x - pitch_m * std::round(x / pitch_m)); };
    const double line_m = std::min(to_line_m(point.x()), to_line_m(point.y()));
    const cv::Vec3f color = line_m < 0.1 * unit_m_ ? kGround * 0.88F : kGround;
    const double away = (point - focus_.center()).head<2>().norm() / focus_.sizes().norm();
    return Blend(color, kHorizon, static_cast<float>(std::clamp(away - 0.8, 0.0, 1.0)));
  }

  bool IsShaded(const Eigen::Vector3d& from, const Eigen::Vector3d& direction, double distance_m) const {
    return solids_.IsBlocked(from, direction, distance_m) ||
           obstacles_.IsBlocked(from, direction, distance_m);
  }

  /// The nearest thing on a ray, the ground included.
  std::optional<RayScene::Hit> Cast(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) const {
    std::optional<RayScene::Hit> nearest;
    for (const RayScene* things : {&solids_, &obstacles_, &track_tube_}) {
      const auto hit = things->Cast(from, direction);
      if (hit && (!nearest || hit->distance_m < nearest->distance_m)) nearest = hit;
    }
    if (!(direction.z() < 0.0)) return nearest;
    const double ground_m = -from.z() / direction.z();
    if (nearest && nearest->distance_m < ground_m) return nearest;
    return RayScene::Hit{ground_m, Eigen::Vector3d::UnitZ(), ColorOfGround(from + ground_m * direction)};
  }

  cv::Vec3f Shade(const Eigen::Vector3d& from, const Eigen::Vector3d& direction,
                  const SkySample& sample) const {
    const auto hit = Cast(from, direction);
    cv::Vec3f color = kHorizon;
    double opaque_m = std::numeric_limits<double>::infinity();
    if (hit) {
      opaque_m = hit->distance_m;
      const Eigen::Vector3d point = from + opaque_m * direction + 0.02 * unit_m_ * hit->normal;
      const double cosine = hit->normal.dot(sun_);
      const bool is_lit = cosine > 0.0 && !IsShaded(point, sun_, 1e4);
      const double light = 0.60 * SkyLight(point, hit->normal, sample) + (is_lit ? 0.45 * cosine : 0.0);
      color = hit->color * static_cast<float>(0.10 + light);
    }
    for (const Glass& glass : glasses_) {
      const auto met = glass.Meet(from, direction);
      if (!met) continue;
      for (const double t : {met->second, met->first}) {
        if (t > 0.0 && t < opaque_m) color = Blend(color, glass.color, 0.16F);
      }
    }
    return color;
  }

  double SkyLight(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                  const SkySample& sample) const {
    const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), normal) *
                                    Eigen::AngleAxisd(sample.turn_rad, Eigen::Vector3d::UnitZ());
    double light = 0.0;
    int count = 0;
    for (int i = sample.first; i < kSkyRays; i += kGrid * kGrid, ++count) {
      const Eigen::Vector3d direction = turn * sky_[static_cast<std::size_t>(i)];
      const bool is_open = !IsShaded(point, direction, 50.0 * unit_m_);
      light += !is_open ? 0.0 : direction.z() > 0.0 ? 1.0 : 0.45;  // The ground gives some light back.
    }
    return light / count;
  }

  cv::Mat3b Render() const {
    const cv::Size size(view_.intrinsics.width_px, view_.intrinsics.height_px);
    cv::Mat3b picture(size);
    std::atomic<int> next{0};
    const auto work = [&] {
      for (int y = next++; y < size.height; y = next++) {
        for (int x = 0; x < size.width; ++x) picture(y, x) = RenderPixel(x, y);
      }
    };
    std::vector<std::jthread> helpers;
    for (unsigned i = 1; i < std::max(1U, std::thread::hardware_concurrency()); ++i)
      helpers.emplace_back(work);
    work();
    helpers.clear();
    return picture;
  }

  cv::Vec3b RenderPixel(int x, int y) const {
    cv::Vec3f sum(0.0F, 0.0F, 0.0F);
    for (int i = 0; i < kGrid * kGrid; ++i) {
      const int column = i % kGrid;
      const int row = i / kGrid;
      const Eigen::Vector2d pixel(x + (column + 0.5) / kGrid - 0.5, y + (row + 0.5) / kGrid - 0.5);
      sum += Shade(view_.map_from_camera.translation_m, RayDirection(view_, pixel),
                   {i, 2.0 * std::numbers::pi * NoiseOf(x, y)});
    }
    const cv::Vec3f mean = sum * (255.0F / (kGrid * kGrid));
    return {cv::saturate_cast<uchar>(mean[0]), cv::saturate_cast<uchar>(mean[1]),
            cv::saturate_cast<uchar>(mean[2])};
  }

  void DrawLines(Canvas& canvas) const {
    const SpacePen pen(view_, solids_, unit_m_);
    for (const Solid& solid : all_.scene.solids) {
      for (const auto& [a, b] : Creases(solid.mesh)) pen.Draw(canvas, {a, b}, kEdge, false);
      for (const SolidOpening& opening : solid.openings) {
        Ring3 ring = opening.polygon_in_map_m;
        ring.push_back(ring.front());
        pen.Draw(canvas, ring, opening.is_through ? kThrough : kRecess, false);
      }
    }
    for (const SceneObject& object : all_.scene.objects) {
      Ring3 ring = Lift(object.footprint.polygon_in_map_m.outer, 0.0);
      ring.push_back(ring.front());
      pen.Draw(canvas, ring, kEdge, false);
    }
    for (const Observation& seen : observations_) DrawCamera(pen, 6.0 * unit_m_, canvas, seen.image.view);
    for (const ClearanceDecision& decision : shown_) {
      for (const auto& [a, b] : decision.corridor->Edges())
        pen.Draw(canvas, {a, b}, StrokeOf(decision), true);
      const auto entry = Project(view_, decision.corridor->entry_in_map_m);
      const auto exit = Project(view_, decision.corridor->exit_in_map_m);
      if (entry) canvas.DrawLabel(*entry, "entry", StrokeOf(decision).color);
      if (exit) canvas.DrawLabel(*exit, "exit", StrokeOf(decision).color);
    }
    pen.Draw(canvas, track_, kTrack, true);
  }

  static void DrawCamera(const SpacePen& pen, double depth_m, Canvas& canvas, const View& camera) {
    const Intrinsics& k = camera.intrinsics;
    const auto corner = [&](double x_px, double y_px) -> Eigen::Vector3d {
      const Eigen::Vector3d ray((x_px - k.cx_px) / k.fx_px, (y_px - k.cy_px) / k.fy_px, 1.0);
      return (camera.map_from_camera * Point<Camera>{depth_m * ray}).xyz_m;
    };
    const Eigen::Vector3d& eye = camera.map_from_camera.translation_m;
    const Ring3 frame = {corner(0, 0), corner(k.width_px, 0), corner(k.width_px, k.height_px),
                         corner(0, k.height_px)};
    for (std::size_t i = 0; i < 4; ++i) {
      pen.Draw(canvas, {eye, frame[i], frame[(i + 1) % 4]}, kCamera, false);
    }
  }

  const Understanding& all_;
  const std::vector<Observation>& observations_;
  const std::vector<Eigen::Vector3d>& track_;
  std::vector<ClearanceDecision> shown_;
  Eigen::AlignedBox3d focus_;
  double unit_m_;  ///< A hundredth of what is shown: the measure of line widths and offsets.
  View view_;
  RayScene solids_;
  RayScene obstacles_;
  RayScene track_tube_;
  std::vector<Glass> glasses_;
  std::vector<Eigen::Vector3d> sky_ = SkyDirections();
  Eigen::Vector3d sun_ = Eigen::Vector3d(-0.5, -0.35, 0.8).normalized();
};

}  // namespace

Drawing DrawScenePicture(const Understanding& understanding, const std::vector<Observation>& observations,
                         const std::vector<Eigen::Vector3d>& track_in_map_m, const cv::Size& size_px) {
  return ScenePicture(understanding, observations, track_in_map_m, size_px).Draw();
}

}  // namespace soffit
