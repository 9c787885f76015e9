#include "service/edge/drawing/overlay.h"

#include <algorithm>
#include <numbers>

#include "service/clearance/describe.h"
#include "service/edge/drawing/canvas.h"
#include "service/edge/drawing/shapes.h"
#include "service/footprint/wireframe.h"

namespace soffit {
namespace {

const Stroke kContour{ink::kWhite, 1.0, true};
const Stroke kNoBuilding{ink::kOrange, 1.0, true};
const Stroke kBuilding{ink::kSky, 2.0, false};
const Stroke kWanted{ink::kYellow, 3.0, false};
const Stroke kThrough{ink::kGreen, 3.0, false};
const Stroke kRecess{ink::kPurple, 3.0, true};
const Stroke kClear{ink::kBlue, 3.0, false};
const Stroke kRefused{ink::kVermilion, 3.0, true};

const std::vector<LegendEntry>& Legend() {
  static const std::vector<LegendEntry> legend = {
      {kContour, "outline of the colour"}, {kNoBuilding, "outline refused"},
      {kBuilding, "building of the map"},  {kWanted, "wanted building"},
      {kThrough, "opening, goes through"}, {kRecess, "opening, a recess"},
      {kClear, "corridor, CLEAR"},         {kRefused, "corridor, refused"}};
  return legend;
}

class Overlay {
 public:
  Overlay(const Observation& seen, const Understanding& all)
      : seen_(seen), all_(all), view_(seen.image.view), canvas_(seen.image.bgr) {}

  Drawing Draw() {
    for (const RefusedOutline& refused : seen_.refused) DrawRefused(refused);
    for (const Outline& outline : seen_.outlines) DrawOutline(outline, kContour);
    for (const SceneObject& object : all_.scene.objects) DrawObject(object);
    for (const Solid& solid : all_.scene.solids) DrawOpenings(solid);
    for (const ClearanceDecision& decision : ChooseShownDecisions(all_.decisions)) DrawCorridor(decision);
    for (const SceneObject& object : all_.scene.objects) LabelObject(object);
    return {canvas_.picture(), Title(), Lines(), Legend()};
  }

 private:
  void Draw3d(const std::vector<Eigen::Vector3d>& line, const Stroke& stroke, bool is_closed) {
    for (const PixelLine& piece : ProjectLine(view_, line, is_closed)) canvas_.DrawLine(piece, stroke);
  }

  bool IsFacing(const std::vector<Eigen::Vector3d>& ring) const {
    return PolygonNormal(ring).dot(view_.map_from_camera.translation_m - ring.front()) > 0.0;
  }

  void DrawOutline(const Outline& outline, const Stroke& stroke) {
    canvas_.DrawLine(outline.polygon_px.outer, stroke, true);
    for (const Ring& hole : outline.polygon_px.holes) canvas_.DrawLine(hole, stroke, true);
  }

  void DrawRefused(const RefusedOutline& refused) {
    DrawOutline(refused.outline, kNoBuilding);
    canvas_.DrawLabel(Centroid(refused.outline.polygon_px), refused.reason, kNoBuilding.color, 0.6);
  }

  void DrawObject(const SceneObject& object) {
    const Footprint& footprint = object.footprint;
    const Stroke& stroke = object.is_matched ? kWanted : kBuilding;
    if (!footprint.levels.empty()) return DrawFrame(footprint, stroke);
    std::vector<Ring> rings = footprint.polygon_in_map_m.holes;
    rings.push_back(footprint.polygon_in_map_m.outer);
    for (const Ring& ring : rings) {
      const bool is_roof_seen = view_.map_from_camera.translation_m.z() > footprint.height_m;
      if (is_roof_seen) Draw3d(Lift(ring, footprint.height_m), stroke, true);
      for (std::size_t i = 0; i < ring.size() && footprint.height_m > 0.0; ++i) {
        const std::vector<Eigen::Vector3d> wall = WallOver(ring, i, footprint.height_m);
        if (IsFacing(wall)) Draw3d(wall, stroke, true);
      }
    }
  }

  void DrawFrame(const Footprint& footprint, const Stroke& stroke) {
    Massing massing = Upright(footprint.polygon_in_map_m, footprint.height_m);
    massing.levels = footprint.levels;
    const Wireframe frame = FrameOf(massing);
    for (const auto& [from, to] : frame.edges)
      Draw3d({frame.corners[from].in_map_m, frame.corners[to].in_map_m}, stroke, false);
  }

  void LabelObject(const SceneObject& object) {
    const Eigen::Vector2d middle = Centroid(object.footprint.polygon_in_map_m);
    const auto pixel = Project(view_, {middle.x(), middle.y(), object.footprint.height_m});
    if (!pixel || !cv::Rect({0, 0}, canvas_.size()).contains(cv::Point2d(pixel->x(), pixel->y()))) return;
    std::string text = std::to_string(object.footprint.object_id);
    if (object.footprint.height_m > 0.0) text += "  h " + FormatNumber(object.footprint.height_m, 2) + " m";
    if (object.is_matched) text = "WANTED " + text;
    canvas_.DrawLabel(*pixel, text, object.is_matched ? kWanted.color : kBuilding.color);
  }

  void DrawOpenings(const Solid& solid) {
    for (const SolidOpening& opening : solid.openings) {
      if (!IsFacing(opening.polygon_in_map_m)) continue;
      const Stroke& stroke = opening.is_through ? kThrough : kRecess;
      canvas_.Fill({ProjectPolygon(view_, opening.polygon_in_map_m)}, stroke.color, 0.25);
      Draw3d(opening.polygon_in_map_m, stroke, true);
    }
  }

  void DrawCorridor(const ClearanceDecision& decision) {
    const bool is_clear = decision.verdict == Verdict::kClear;
    const Stroke& stroke = is_clear ? kClear : kRefused;
    for (const auto& [from, to] : decision.corridor->Edges()) Draw3d({from, to}, stroke, false);
    const std::vector<Eigen::Vector3d> path = decision.corridor->Path();
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      for (const PixelLine& line : ProjectLine(view_, {path[i], path[i + 1]}, false))
        canvas_.DrawArrow(line.front(), line.back(), stroke);
    }
  }

  std::string Title() const {
    return seen_.image.name + "  (" + ToString(seen_.image.purpose) + ", picture " +
           std::to_string(seen_.image.capture_id) + ")";
  }

  std::vector<std::string> Lines() const {
    std::vector<std::string> lines;
    for (const SceneObject& object : all_.scene.objects) {
      if (!object.is_matched) continue;
      lines.push_back("Building " + std::to_string(object.footprint.object_id) + " is wanted: score " +
                      FormatNumber(object.match.score, 3) + ", turned clockwise by " +
                      FormatNumber(object.match.rotation_cw_rad * 180.0 / std::numbers::pi, 1) + " deg, " +
                      FormatNumber(object.match.scale, 4) + " m per pixel of the reference");
    }
    for (const ClearanceDecision& decision : all_.decisions) lines.push_back(Describe(decision));
    for (const std::string& problem : all_.problems) lines.push_back(problem);
    return lines;
  }

  const Observation& seen_;
  const Understanding& all_;
  const View& view_;
  Canvas canvas_;
};

}  // namespace

Drawing DrawOverlay(const Observation& seen, const Understanding& understanding) {
  return Overlay(seen, understanding).Draw();
}

}  // namespace soffit
