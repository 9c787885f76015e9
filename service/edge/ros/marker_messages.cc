#include "service/edge/ros/marker_messages.h"

#include <map>

#include "service/clearance/describe.h"

namespace soffit::ros {
namespace {

using std_msgs::msg::dds_::ColorRGBA_;
namespace constants = visualization_msgs::msg::dds_::Marker_Constants;

constexpr double kLineWidth_m = 0.03;
constexpr double kTextHeight_m = 0.3;
constexpr double kTextAbove_m = 0.5;
constexpr double kMissingHeight_m = 0.1;  ///< Clutter's height is not known: it is drawn as a disc.

ColorRGBA_ Color(float red, float green, float blue, float alpha = 1.0F) {
  ColorRGBA_ color;
  color.r_(red);
  color.g_(green);
  color.b_(blue);
  color.a_(alpha);
  return color;
}

ColorRGBA_ ColorOf(const std::string& name) {
  static const std::map<std::string, ColorRGBA_> known = {{"red", Color(0.8F, 0.1F, 0.1F)},
                                                          {"blue", Color(0.1F, 0.2F, 0.8F)},
                                                          {"yellow", Color(0.9F, 0.8F, 0.1F)},
                                                          {"green", Color(0.1F, 0.6F, 0.1F)}};
  const auto found = known.find(name);
  return found != known.end() ? found->second : Color(0.6F, 0.6F, 0.6F);
}

ColorRGBA_ ColorOf(Verdict verdict) {
  switch (verdict) {
    case Verdict::kClear:
      return Color(0.0F, 0.7F, 0.2F);
    case Verdict::kBlocked:
      return Color(0.8F, 0.0F, 0.0F);
    case Verdict::kInsufficientData:
      break;
  }
  return Color(1.0F, 0.6F, 0.0F);
}

std::vector<Eigen::Vector3d> Closed(std::vector<Eigen::Vector3d> ring) {
  if (!ring.empty()) ring.push_back(ring.front());
  return ring;
}

std::vector<Eigen::Vector3d> ClosedAt(const Ring& ring, double height_m) {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector2d& corner : ring) points.emplace_back(corner.x(), corner.y(), height_m);
  return Closed(std::move(points));
}

std::vector<Eigen::Vector3d> Edges(const Corridor& corridor) {
  std::vector<Eigen::Vector3d> pairs_m;
  for (const auto& [from_m, to_m] : corridor.Edges()) pairs_m.insert(pairs_m.end(), {from_m, to_m});
  return pairs_m;
}

class Drawing {
 public:
  explicit Drawing(std::int64_t stamp_utc_ns) : header_(MakeHeader(stamp_utc_ns, kMapFrame)) {
    Add("", constants::CUBE_, Color(0, 0, 0, 0), {1, 1, 1}).action_(constants::DELETEALL_);
  }

  Marker_& Add(const std::string& name_space, std::int32_t type, const ColorRGBA_& color,
               const Eigen::Vector3d& scale) {
    Marker_& marker = message_.markers_().emplace_back();
    marker.header_(header_);
    marker.ns_(name_space);
    marker.id_(next_ids_[name_space]++);
    marker.type_(type);
    marker.action_(constants::ADD_);
    marker.pose_(MakePose(Eigen::Vector3d::Zero(), Eigen::Quaterniond::Identity()));
    marker.scale_(MakeVector(scale));
    marker.color_(color);
    return marker;
  }
  void AddPoints(const std::string& name_space, std::int32_t type, const ColorRGBA_& color,
                 const Eigen::Vector3d& scale, const std::vector<Eigen::Vector3d>& points_m) {
    Marker_& marker = Add(name_space, type, color, scale);
    for (const Eigen::Vector3d& point_m : points_m) marker.points_().push_back(MakePoint(point_m));
  }
  void AddLine(const std::string& name_space, const ColorRGBA_& color,
               const std::vector<Eigen::Vector3d>& points_m) {
    AddPoints(name_space, constants::LINE_STRIP_, color, {kLineWidth_m, 0, 0}, points_m);
  }

  MarkerArray_ Take() && { return std::move(message_); }

 private:
  Header_ header_;
  std::map<std::string, std::int32_t> next_ids_;
  MarkerArray_ message_;
};

void DrawFootprint(const Footprint& footprint, Drawing& drawing) {
  const ColorRGBA_ color = ColorOf(footprint.color);
  drawing.AddLine("footprints", color, ClosedAt(footprint.polygon_in_map_m.outer, 0.0));
  const Ring& outer = footprint.polygon_in_map_m.outer;
  const Ring roof = footprint.levels.empty() ? outer : InsetRing(outer, footprint.levels.back().inset_m);
  if (footprint.height_m > 0.0) drawing.AddLine("footprints", color, ClosedAt(roof, footprint.height_m));
  for (const Ring& hole : footprint.polygon_in_map_m.holes)
    drawing.AddLine("footprints", color, ClosedAt(hole, 0.0));
}

void DrawSolid(const Solid& solid, Drawing& drawing) {
  std::vector<Eigen::Vector3d> corners_m;
  for (const auto& triangle : solid.mesh.triangles) {
    for (const int corner : triangle)
      corners_m.push_back(solid.mesh.vertices_in_map_m[static_cast<std::size_t>(corner)]);
  }
  drawing.AddPoints("models", constants::TRIANGLE_LIST_, ColorOf(solid.footprint.color), {1, 1, 1},
                    corners_m);
  for (const SolidOpening& opening : solid.openings) {
    drawing.AddLine("openings", opening.is_through ? ColorOf(Verdict::kClear) : Color(0.3F, 0.3F, 0.3F),
                    Closed(opening.polygon_in_map_m));
  }
}

void DrawObstacle(const Obstacle& obstacle, Drawing& drawing) {
  const double height_m = obstacle.height_m > 0.0 ? obstacle.height_m : kMissingHeight_m;
  Marker_& marker = drawing.Add("obstacles", constants::CYLINDER_, Color(0.7F, 0.3F, 0.7F, 0.8F),
                                {2.0 * obstacle.radius_m, 2.0 * obstacle.radius_m, height_m});
  marker.pose_(MakePose(obstacle.base_in_map_m + 0.5 * height_m * Eigen::Vector3d::UnitZ(),
                        Eigen::Quaterniond::Identity()));
}

void DrawDecision(const ClearanceDecision& decision, const Scene& scene, Drawing& drawing) {
  const ColorRGBA_ color = ColorOf(decision.verdict);
  if (decision.corridor) {
    drawing.AddLine("corridor_paths", color, decision.corridor->Path());
    drawing.AddPoints("corridors", constants::LINE_LIST_, color, {kLineWidth_m, 0, 0},
                      Edges(*decision.corridor));
  }
  for (const SceneObject& object : scene.objects) {
    if (object.footprint.object_id != decision.object_id) continue;
    const Eigen::Vector2d center_m = Centroid(object.footprint.polygon_in_map_m);
    // Decisions about the sides of one building stand above each other.
    const double height_m =
        object.footprint.height_m + kTextAbove_m + (decision.side + 1) * 1.5 * kTextHeight_m;
    Marker_& text = drawing.Add("decisions", constants::TEXT_VIEW_FACING_, color, {0, 0, kTextHeight_m});
    text.pose_(MakePose({center_m.x(), center_m.y(), height_m}, Eigen::Quaterniond::Identity()));
    text.text_(std::string(ToString(decision.verdict)) + ": " + decision.reason + "\n" +
               DescribeRoom(decision));
  }
}

}  // namespace

MarkerArray_ MakeSceneMarkers(std::int64_t stamp_utc_ns, const Scene& scene,
                              const std::vector<ClearanceDecision>& decisions) {
  Drawing drawing(stamp_utc_ns);
  for (const SceneObject& object : scene.objects) DrawFootprint(object.footprint, drawing);
  for (const Solid& solid : scene.solids) DrawSolid(solid, drawing);
  for (const Obstacle& obstacle : scene.obstacles) DrawObstacle(obstacle, drawing);
  for (const Obstacle& thing : scene.clutter) DrawObstacle(thing, drawing);
  for (const ClearanceDecision& decision : decisions) DrawDecision(decision, scene, drawing);
  return std::move(drawing).Take();
}

MarkerArray_ MakeVoxelMarkers(std::int64_t stamp_utc_ns, const octomap::OcTree& octree) {
  std::map<double, std::vector<Eigen::Vector3d>> centers_by_size;
  for (auto leaf = octree.begin_leafs(); leaf != octree.end_leafs(); ++leaf) {
    if (octree.isNodeOccupied(*leaf))
      centers_by_size[leaf.getSize()].emplace_back(leaf.getX(), leaf.getY(), leaf.getZ());
  }
  Drawing drawing(stamp_utc_ns);
  for (const auto& [size_m, centers_m] : centers_by_size) {
    drawing.AddPoints("occupied", constants::CUBE_LIST_, Color(0.5F, 0.5F, 0.8F),
                      Eigen::Vector3d::Constant(size_m), centers_m);
  }
  return std::move(drawing).Take();
}

}  // namespace soffit::ros
