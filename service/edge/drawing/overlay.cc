#include "service/edge/drawing/overlay.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>

#include "service/edge/drawing/canvas.h"
#include "service/edge/drawing/shapes.h"
#include "service/edge/drawing/space_pen.h"
#include "service/facade/wall.h"
#include "shared/result/say.h"

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

const Stroke kObstacle{ink::kOrange, 3.0, false};
const Stroke kClutter{ink::kGrey, 2.0, true};

constexpr double kStep_m = 0.03;

const std::vector<LegendEntry>& Legend() {
  static const std::vector<LegendEntry> legend = {{kContour, "outline of the colour"},
                                                  {kNoBuilding, "outline refused"},
                                                  {kBuilding, "building of the map"},
                                                  {kWanted, "wanted building"},
                                                  {kThrough, "opening, goes through"},
                                                  {kRecess, "opening, a recess"},
                                                  {kClear, "corridor, CLEAR"},
                                                  {kRefused, "corridor, refused"},
                                                  {kObstacle, "obstacle"},
                                                  {kClutter, "thing of unknown height"}};
  return legend;
}

/// The adjusted one, that the models fit.
const View& ViewOf(const Image& image, const Understanding& all) {
  const auto adjusted = all.views.find(image.capture_id);
  return adjusted == all.views.end() ? image.view : adjusted->second;
}

class Overlay {
 public:
  Overlay(const Observation& seen, const Understanding& all)
      : seen_(seen),
        all_(all),
        view_(ViewOf(seen.image, all)),
        canvas_(seen.image.bgr),
        pen_(view_, solids_, kStep_m) {
    for (const Solid& solid : all.scene.solids) solids_.AddMesh(solid.mesh, {});
    solids_.Commit();
  }

  Drawing Draw() {
    for (const RefusedOutline& refused : seen_.refused) DrawRefused(refused);
    for (const Outline& outline : seen_.outlines) DrawOutline(outline, kContour);
    for (const SceneObject& object : all_.scene.objects) DrawObject(object);
    for (const Solid& solid : all_.scene.solids) DrawOpenings(solid);
    for (const Obstacle& thing : all_.scene.obstacles) DrawObstacle(thing, kObstacle);
    for (const Obstacle& thing : all_.scene.clutter) DrawObstacle(thing, kClutter);
    for (const ClearanceDecision& decision : ChooseShownDecisions(all_.decisions)) DrawCorridor(decision);
    for (const SceneObject& object : all_.scene.objects) LabelObject(object);
    for (const Facade& facade : all_.facades) LabelOpenings(facade);
    return {canvas_.picture(), Title(), Lines(), Legend()};
  }

 private:
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

  const Solid* FindSolid(std::uint32_t object_id) const {
    const auto found = std::ranges::find(all_.scene.solids, object_id,
                                         [](const Solid& solid) { return solid.footprint.object_id; });
    return found == all_.scene.solids.end() ? nullptr : &*found;
  }

  void DrawObject(const SceneObject& object) {
    const Footprint& footprint = object.footprint;
    const Stroke& stroke = object.is_matched ? kWanted : kBuilding;
    if (const Solid* solid = FindSolid(footprint.object_id)) {
      for (const auto& [from, to] : Creases(solid->mesh)) pen_.Draw(canvas_, {from, to}, stroke, false);
    } else {
      DrawRing(Lift(footprint.polygon_in_map_m.outer, footprint.height_m), stroke);
    }
  }

  void DrawRing(Ring3 ring, const Stroke& stroke) {
    ring.push_back(ring.front());
    pen_.Draw(canvas_, ring, stroke, false);
  }

  std::optional<Eigen::Vector2d> FindInPicture(const Eigen::Vector3d& point) const {
    const auto pixel = Project(view_, point);
    if (!pixel || !cv::Rect({0, 0}, canvas_.size()).contains(cv::Point2d(pixel->x(), pixel->y())))
      return std::nullopt;
    return pixel;
  }

  void LabelObject(const SceneObject& object) {
    const Eigen::Vector2d middle = Centroid(object.footprint.polygon_in_map_m);
    const auto pixel = FindInPicture({middle.x(), middle.y(), object.footprint.height_m});
    if (!pixel) return;
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
      DrawRing(opening.polygon_in_map_m, stroke);
    }
  }

  /// With its place, where a reason names it.
  void DrawObstacle(const Obstacle& thing, const Stroke& stroke) {
    const Eigen::Vector3d top = thing.base_in_map_m + thing.height_m * Eigen::Vector3d::UnitZ();
    const Ring3 low = Circle(thing.base_in_map_m, thing.radius_m), high = Circle(top, thing.radius_m);
    pen_.Draw(canvas_, low, stroke, false);
    if (!(thing.height_m > 0.0)) return;
    pen_.Draw(canvas_, high, stroke, false);
    for (std::size_t i = 0; i < low.size(); i += low.size() / 4)
      pen_.Draw(canvas_, {low[i], high[i]}, stroke, false);
    const std::string place = SayPlace(all_.scene.map_origin_m + thing.base_in_map_m);
    const bool is_named = std::ranges::any_of(all_.decisions, [&](const ClearanceDecision& decision) {
      return decision.reason.find(place) != std::string::npos;
    });
    const auto pixel = FindInPicture(top);
    if (is_named && pixel && pen_.IsVisible(top)) canvas_.DrawLabel(*pixel, place, stroke.color, 0.8);
  }

  void DrawCorridor(const ClearanceDecision& decision) {
    const Stroke& stroke = decision.verdict == Verdict::kClear ? kClear : kRefused;
    for (const auto& [from, to] : decision.corridor->Edges()) pen_.Draw(canvas_, {from, to}, stroke, true);
    const std::vector<Eigen::Vector3d> path = decision.corridor->Path();
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      for (const PixelLine& line : ProjectLine(view_, {path[i], path[i + 1]}, false))
        canvas_.DrawArrow(line.front(), line.back(), stroke);
    }
  }

  bool IsReadHere(const Opening& opening) const {
    return std::ranges::count(opening.captures, seen_.image.capture_id) > 0;
  }

  /// Each opening that was read from this picture, with its number on its wall.
  void LabelOpenings(const Facade& facade) {
    const Solid* solid = FindSolid(facade.object_id);
    if (solid == nullptr) return;
    const Wall wall = WallOf(solid->footprint, facade.side);
    for (std::size_t i = 0; i < facade.openings.size(); ++i) {
      const Opening& opening = facade.openings[i];
      if (!IsReadHere(opening)) continue;
      Eigen::AlignedBox2d box;
      for (const Eigen::Vector2d& p : opening.ring_in_wall_m) box.extend(p);
      const auto pixel = FindInPicture(wall.InMap({box.center().x(), box.max().y()}));
      if (pixel) canvas_.DrawLabel(*pixel, NameOf(facade, i));
    }
  }

  static std::string NameOf(const Facade& facade, std::size_t opening) {
    return Say("opening ", facade.side, ".", opening + 1);
  }

  static std::string Explain(const Opening& opening) {
    const std::string found = opening.is_through         ? "shows what is beyond"
                              : opening.shows_background ? "perhaps shows what is beyond"
                              : opening.recess ? Say("a recess, ", opening.recess->depth_m, " m deep")
                                               : "shows nothing beyond";
    return found + (opening.evidence.empty() ? "" : ": " + opening.evidence);
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
    for (const Facade& facade : all_.facades) {
      for (std::size_t i = 0; i < facade.openings.size(); ++i) {
        if (IsReadHere(facade.openings[i]))
          lines.push_back(Say(NameOf(facade, i), ": ", Explain(facade.openings[i])));
      }
    }
    for (std::string& line : DescribeDecisions(all_)) lines.push_back(std::move(line));
    for (const std::string& problem : all_.problems) lines.push_back(problem);
    return lines;
  }

  const Observation& seen_;
  const Understanding& all_;
  const View& view_;
  Canvas canvas_;
  RayScene solids_;
  SpacePen pen_;
};

}  // namespace

Drawing DrawOverlay(const Observation& seen, const Understanding& understanding) {
  return Overlay(seen, understanding).Draw();
}

}  // namespace soffit
