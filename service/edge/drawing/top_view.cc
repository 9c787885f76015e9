#include "service/edge/drawing/top_view.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "service/edge/drawing/canvas.h"
#include "service/edge/drawing/shapes.h"

namespace soffit {
namespace {

constexpr int kLongSide_px = 1280;
constexpr double kBorder_m = 1.0;
constexpr double kLeastSlice_m = 0.5;

const Stroke kBuilding{ink::kSky, 2.0, false};
const Stroke kWanted{ink::kYellow, 4.0, false};
const Stroke kThrough{ink::kGreen, 5.0, false};
const Stroke kRecess{ink::kPurple, 5.0, true};
const Stroke kClear{ink::kBlue, 4.0, false};
const Stroke kRefused{ink::kVermilion, 4.0, true};
const Stroke kTrack{ink::kOrange, 2.5, false};
const Stroke kObstacle{ink::kVermilion, 2.0, false};
const Stroke kClutter{ink::kGrey, 2.0, true};
const Stroke kCamera{ink::kBlack, 1.5, false};
const Stroke kWantedView{ink::kPurple, 2.0, true};
const cv::Vec3b kFree(250, 246, 236);
const cv::Vec3b kUnknown(205, 205, 205);
const cv::Vec3b kOccupied(90, 90, 90);

cv::Scalar ToScalar(const cv::Vec3b& color) { return {double(color[0]), double(color[1]), double(color[2])}; }

class TopView {
 public:
  TopView(const Understanding& all, const std::vector<Observation>& observations,
          const std::vector<Eigen::Vector3d>& track)
      : all_(all),
        observations_(observations),
        track_(track),
        box_(Frame()),
        px_per_m_(kLongSide_px / box_.sizes().maxCoeff()),
        canvas_(DrawOccupancy()) {}

  Drawing Draw() {
    for (const SceneObject& object : all_.scene.objects) DrawObject(object);
    for (const Solid& solid : all_.scene.solids) DrawOpenings(solid);
    for (const Obstacle& thing : all_.scene.obstacles) DrawObstacle(thing, kObstacle);
    for (const Obstacle& thing : all_.scene.clutter) DrawObstacle(thing, kClutter);
    for (const ClearanceDecision& decision : ChooseShownDecisions(all_.decisions)) DrawCorridor(decision);
    DrawTrack();
    for (const Observation& seen : observations_) DrawCamera(seen.image);
    for (const ClearanceDecision& decision : all_.decisions) DrawWanted(decision);
    DrawScaleBar();
    std::vector<std::string> lines = DescribeDecisions(all_);
    for (const std::string& problem : all_.problems) lines.push_back(problem);
    return {canvas_.picture(),
            "Scene from above, north up; occupancy at " + FormatNumber(SliceHeight(), 2) + " m", lines,
            Legend()};
  }

 private:
  static const std::vector<LegendEntry>& Legend() {
    static const std::vector<LegendEntry> legend = {{kBuilding, "building"},
                                                    {kWanted, "wanted building"},
                                                    {kThrough, "opening, through"},
                                                    {kRecess, "opening, a recess"},
                                                    {kClear, "corridor, CLEAR"},
                                                    {kRefused, "corridor, refused"},
                                                    {kObstacle, "obstacle"},
                                                    {kClutter, "thing of unknown height"},
                                                    {kTrack, "flown track"},
                                                    {kCamera, "where a picture was taken"},
                                                    {kWantedView, "picture that would settle it"},
                                                    {{ToScalar(kFree), 8.0, false}, "seen to be free"},
                                                    {{ToScalar(kUnknown), 8.0, false}, "unknown"},
                                                    {{ToScalar(kOccupied), 8.0, false}, "occupied"}};
    return legend;
  }

  Eigen::AlignedBox2d Frame() const {
    Eigen::AlignedBox2d box;
    for (const SceneObject& object : all_.scene.objects) {
      for (const Eigen::Vector2d& corner : object.footprint.polygon_in_map_m.outer) box.extend(corner);
    }
    for (const Observation& seen : observations_) {
      box.extend(Eigen::Vector2d(seen.image.view.map_from_camera.translation_m.head<2>()));
    }
    for (const Eigen::Vector3d& point : track_) box.extend(Eigen::Vector2d(point.head<2>()));
    for (const ClearanceDecision& decision : all_.decisions) {
      if (!decision.corridor) continue;
      for (const Eigen::Vector3d& point : decision.corridor->Path())
        box.extend(Eigen::Vector2d(point.head<2>()));
    }
    for (const ClearanceDecision& decision : all_.decisions) {
      if (decision.wanted) box.extend(Eigen::Vector2d(decision.wanted->position_in_map_m.head<2>()));
    }
    if (box.isEmpty()) box.extend(Eigen::Vector2d(0.0, 0.0));
    const Eigen::Vector2d border = Eigen::Vector2d::Constant(kBorder_m + 0.05 * box.sizes().maxCoeff());
    return {box.min() - border, box.max() + border};
  }

  double SliceHeight() const {
    for (const ClearanceDecision& decision : all_.decisions) {
      if (decision.corridor) return std::max(kLeastSlice_m, decision.corridor->entry_in_map_m.z());
    }
    return kLeastSlice_m;
  }

  Eigen::Vector2d ToPixel(const Eigen::Vector2d& p) const {
    return {(p.x() - box_.min().x()) * px_per_m_, (box_.max().y() - p.y()) * px_per_m_};
  }

  PixelLine ToPixels(const Ring& ring) const {
    PixelLine line;
    for (const Eigen::Vector2d& p : ring) line.push_back(ToPixel(p));
    return line;
  }

  cv::Mat3b DrawOccupancy() const {
    const Eigen::Vector2d size = box_.sizes() * px_per_m_;
    cv::Mat3b picture(std::max(1, cvCeil(size.y())), std::max(1, cvCeil(size.x())), kUnknown);
    const octomap::OcTree& octree = *all_.scene.octree;
    const double z = SliceHeight();
    const auto color_at = [&](int x, int y) {
      const octomap::OcTreeNode* node =
          octree.search(box_.min().x() + x / px_per_m_, box_.max().y() - y / px_per_m_, z);
      if (node == nullptr) return kUnknown;
      return octree.isNodeOccupied(node) ? kOccupied : kFree;
    };
    for (int y = 0; y < picture.rows; ++y) {
      for (int x = 0; x < picture.cols; ++x) picture(y, x) = color_at(x, y);
    }
    return picture;
  }

  void DrawObject(const SceneObject& object) {
    const Polygon& polygon = object.footprint.polygon_in_map_m;
    const Stroke& stroke = object.is_matched ? kWanted : kBuilding;
    std::vector<PixelLine> rings = {ToPixels(polygon.outer)};
    for (const Ring& hole : polygon.holes) rings.push_back(ToPixels(hole));
    canvas_.Fill(rings, stroke.color, 0.35);
    for (const PixelLine& ring : rings) canvas_.DrawLine(ring, stroke, true);
    std::string text = std::to_string(object.footprint.object_id);
    if (object.footprint.height_m > 0.0) text += "  h " + FormatNumber(object.footprint.height_m, 2) + " m";
    const Eigen::Vector2d north =
        *std::max_element(polygon.outer.begin(), polygon.outer.end(),
                          [](const auto& a, const auto& b) { return a.y() < b.y(); });
    canvas_.DrawLabel(ToPixel(north) - Eigen::Vector2d(0.0, 6.0), text, stroke.color);
  }

  void DrawOpenings(const Solid& solid) {
    for (const SolidOpening& opening : solid.openings) {
      if (opening.wall < 0) continue;
      // A vertical opening is a line from above: its two points that lie farthest apart.
      Eigen::Vector2d a = opening.polygon_in_map_m.front().head<2>();
      Eigen::Vector2d b = a;
      for (const Eigen::Vector3d& p : opening.polygon_in_map_m) {
        if ((p.head<2>() - a).norm() > (b - a).norm()) b = p.head<2>();
      }
      for (const Eigen::Vector3d& p : opening.polygon_in_map_m) {
        if ((p.head<2>() - b).norm() > (b - a).norm()) a = p.head<2>();
      }
      canvas_.DrawLine({ToPixel(a), ToPixel(b)}, opening.is_through ? kThrough : kRecess);
    }
  }

  void DrawObstacle(const Obstacle& thing, const Stroke& stroke) {
    PixelLine circle;
    for (const Eigen::Vector3d& p : Circle(thing.base_in_map_m, thing.radius_m))
      circle.push_back(ToPixel(p.head<2>()));
    canvas_.DrawLine(circle, stroke);
  }

  void DrawCorridor(const ClearanceDecision& decision) {
    const Stroke& stroke = decision.verdict == Verdict::kClear ? kClear : kRefused;
    const std::vector<Section> sections = decision.corridor->Sections();
    PixelLine area;
    for (const Section& section : sections) area.push_back(ToPixel(section[0].head<2>()));
    for (std::size_t i = sections.size(); i-- > 0;) area.push_back(ToPixel(sections[i][1].head<2>()));
    canvas_.Fill({area}, stroke.color, 0.2);
    const std::vector<Eigen::Vector3d> path = decision.corridor->Path();
    for (std::size_t i = 0; i + 1 < path.size(); ++i)
      canvas_.DrawArrow(ToPixel(path[i].head<2>()), ToPixel(path[i + 1].head<2>()), stroke);
  }

  void DrawTrack() {
    PixelLine line;
    for (const Eigen::Vector3d& point : track_) line.push_back(ToPixel(point.head<2>()));
    canvas_.DrawLine(line, kTrack);
  }

  void DrawCamera(const Image& image) {
    const Pose<Map, Camera>& pose = image.view.map_from_camera;
    const Eigen::Vector2d place = ToPixel(pose.translation_m.head<2>());
    const Eigen::Vector3d forward = pose.rotation * Eigen::Vector3d::UnitZ();
    if (forward.head<2>().norm() > 0.5) {
      const Eigen::Vector2d ahead(forward.x(), -forward.y());
      canvas_.DrawArrow(place, place + 30.0 * canvas_.unit_px() * ahead.normalized(), kCamera);
    }
    canvas_.DrawDot(place, 4.0, ink::kBlack);
    canvas_.DrawLabel(place - Eigen::Vector2d(0.0, 8.0), std::to_string(image.capture_id), ink::kBlack, 0.8);
  }

  void DrawWanted(const ClearanceDecision& decision) {
    if (!decision.wanted) return;
    const Eigen::Vector2d place = ToPixel(decision.wanted->position_in_map_m.head<2>());
    const Eigen::Vector2d ahead(std::cos(decision.wanted->yaw_rad), -std::sin(decision.wanted->yaw_rad));
    canvas_.DrawArrow(place, place + 30.0 * canvas_.unit_px() * ahead, kWantedView);
    canvas_.DrawDot(place, 4.0, kWantedView.color);
  }

  void DrawScaleBar() {
    const double wanted_m = box_.sizes().x() / 5.0;
    const double decade = std::pow(10.0, std::floor(std::log10(wanted_m)));
    const double length_m = wanted_m >= 5.0 * decade   ? 5.0 * decade
                            : wanted_m >= 2.0 * decade ? 2.0 * decade
                                                       : decade;
    const Eigen::Vector2d from(20.0, canvas_.size().height - 20.0);
    const Eigen::Vector2d to = from + Eigen::Vector2d(length_m * px_per_m_, 0.0);
    canvas_.DrawLine({from, to}, {ink::kBlack, 4.0, false});
    canvas_.DrawLabel((from + to) / 2.0 - Eigen::Vector2d(0.0, 6.0),
                      FormatNumber(length_m, length_m < 1.0 ? 1 : 0) + " m");
    canvas_.DrawArrow({30.0, 70.0}, {30.0, 25.0}, {ink::kBlack, 3.0, false});
    canvas_.DrawLabel({30.0, 100.0}, "N");
  }

  const Understanding& all_;
  const std::vector<Observation>& observations_;
  const std::vector<Eigen::Vector3d>& track_;
  Eigen::AlignedBox2d box_;
  double px_per_m_;
  Canvas canvas_;
};

}  // namespace

Drawing DrawTopView(const Understanding& understanding, const std::vector<Observation>& observations,
                    const std::vector<Eigen::Vector3d>& track_in_map_m) {
  return TopView(understanding, observations, track_in_map_m).Draw();
}

}  // namespace soffit
