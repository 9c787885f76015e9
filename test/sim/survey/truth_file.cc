#include "test/sim/survey/truth_file.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "test/sim/world/space.h"

namespace soffit::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using nlohmann::json;

constexpr double kDeg = std::numbers::pi / 180.0;
constexpr double kNoisy_m = 0.03;  // From here on the honest answer may be that the pictures cannot tell.

json ToJson(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }
json ToJson(const Eigen::Quaterniond& q) { return {q.x(), q.y(), q.z(), q.w()}; }
json ToJson(const Ring& ring) {
  json corners = json::array();
  for (const Vector2d& corner : ring) corners.push_back({corner.x(), corner.y()});
  return corners;
}
json ToJson(const std::vector<Ring>& rings) {
  json list = json::array();
  for (const Ring& ring : rings) list.push_back(ToJson(ring));
  return list;
}

/// Compass heading: clockwise from north.
double Heading_deg(double yaw_rad) { return std::fmod(90.0 - yaw_rad / kDeg + 720.0, 360.0); }

json DescribeVehicle(const VehicleEnvelope& vehicle) {
  return {{"radius_m", vehicle.radius_m},
          {"height_m", vehicle.height_m},
          {"safety_margin_m", vehicle.safety_margin_m}};
}

/// A prism as polygon (u, v) in a frame (columns of R, origin t) between two values of w.
json DescribeSolid(const Prism& prism, const Structure& structure) {
  Eigen::Matrix3d turn = Eigen::AngleAxisd(structure.yaw_rad, Vector3d::UnitZ()).toRotationMatrix();
  Vector3d origin(structure.position_m.x(), structure.position_m.y(), 0.0);
  double low = prism.low_m, high = prism.high_m;
  if (prism.is_lying) {
    origin += turn * Vector3d(prism.at.x(), prism.at.y(), 0.0);
    Eigen::Matrix3d frame;
    frame.col(0) = Vector3d(prism.axis.y(), -prism.axis.x(), 0.0);
    frame.col(1) = Vector3d::UnitZ();
    frame.col(2) = Vector3d(-prism.axis.x(), -prism.axis.y(), 0.0);
    turn = turn * frame;
    low = -prism.high_m;
    high = -prism.low_m;
  }
  json rows = json::array();
  for (int i = 0; i < 3; ++i) rows.push_back({turn(i, 0), turn(i, 1), turn(i, 2)});
  return {{"R", rows},
          {"t", ToJson(origin)},
          {"polygon", ToJson(prism.section.outer)},
          {"holes", ToJson(prism.section.holes)},
          {"w", {low, high}}};
}

/// The format knows prisms only: one that changes on its way up is cut into slabs, each as it is half-way up.
std::vector<Prism> CutIntoSlabs(const Prism& prism) {
  if (prism.top.empty()) return {prism};
  constexpr int kSlabs = 64;
  std::vector<Prism> slabs;
  for (int k = 0; k < kSlabs; ++k) {
    const double step_m = (prism.high_m - prism.low_m) / kSlabs;
    Prism slab = prism;
    slab.top.clear();
    slab.low_m = prism.low_m + k * step_m;
    slab.high_m = slab.low_m + step_m;
    const double share = (k + 0.5) / kSlabs;
    for (std::size_t i = 0; i < prism.top.size(); ++i)
      slab.section.outer[i] += share * (prism.top[i] - prism.section.outer[i]);
    slabs.push_back(std::move(slab));
  }
  return slabs;
}

json DescribeSolids(const Structure& structure) {
  json solids = json::array();
  for (const Part& part : structure.parts) {
    const auto* prism = std::get_if<Prism>(&part.shape);
    if (prism == nullptr) continue;
    for (const Prism& slab : CutIntoSlabs(*prism)) solids.push_back(DescribeSolid(slab, structure));
  }
  return solids;
}

/// Volume that the building's surfaces enclose, null when those that look up do not lie over those that look
/// down. Upright ones count for nothing, so the surfaces need not be closed there (windows, passages).
json Volume_m3(const Structure& structure) {
  constexpr double kOpenRatio = 1e-3;
  const Mesh mesh = BuildMesh(structure);
  double volume_m3 = 0.0, open_m2 = 0.0, all_m2 = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vector3d &p = mesh.vertices_m[a], &q = mesh.vertices_m[b], &r = mesh.vertices_m[c];
    const double level_m2 = 0.5 * (q - p).cross(r - p).z();
    volume_m3 += level_m2 * (p.z() + q.z() + r.z()) / 3.0;
    open_m2 += level_m2;
    all_m2 += std::abs(level_m2);
  }
  return std::abs(open_m2) > kOpenRatio * all_m2 ? json() : json(volume_m3);
}

/// Rotations that take the outline to itself.
std::vector<double> FindSymmetries_deg(const Polygon& polygon) {
  constexpr double kAlike_m = 1e-3;
  const Vector2d center = Centroid(polygon);
  std::vector<double> angles = {0.0};
  for (const double angle_deg : {90.0, 180.0, 270.0}) {
    const Eigen::Rotation2Dd turn(angle_deg * kDeg);
    const bool is_same = std::all_of(polygon.outer.begin(), polygon.outer.end(), [&](const Vector2d& corner) {
      const Vector2d turned = center + turn * (corner - center);
      return std::any_of(polygon.outer.begin(), polygon.outer.end(),
                         [&](const Vector2d& other) { return (other - turned).norm() < kAlike_m; });
    });
    if (is_same) angles.push_back(angle_deg);
  }
  return angles;
}

/// Where the line through the passage enters and leaves the footprint.
std::pair<Vector3d, Vector3d> FindMouths(const Passage& passage, const Polygon& footprint) {
  constexpr int kSteps = 4000;
  Vector3d first = passage.entry_m, last = passage.exit_m;
  bool is_found = false;
  for (int i = 0; i <= kSteps; ++i) {
    const Vector3d at = passage.entry_m + (passage.exit_m - passage.entry_m) * i / kSteps;
    if (!Contains(footprint, at.head<2>())) continue;
    if (!is_found) first = at;
    is_found = true;
    last = at;
  }
  return {first, last};
}

json DescribePassage(const Passage& passage, const Polygon& footprint, const VehicleEnvelope& vehicle,
                     int index) {
  const auto [mouth, far_mouth] = FindMouths(passage, footprint);
  const Vector3d along = (passage.exit_m - passage.entry_m).normalized();
  return {{"id", "p" + std::to_string(index)},
          {"opening", "o" + std::to_string(index)},
          {"need_width_m", vehicle.NeededWidth_m()},
          {"need_height_m", vehicle.NeededHeight_m()},
          {"length_m", (far_mouth - mouth).norm()},
          {"direction", ToJson(along)},
          {"free_width_m", passage.free_width_m},
          {"free_height_m", passage.free_height_m},
          {"ratio", passage.ratio},
          {"decision", passage.is_passable ? "CLEAR" : "BLOCKED"},
          {"mouth", ToJson(mouth)},
          {"far_mouth", ToJson(far_mouth)},
          {"entry", ToJson(passage.entry_m)},
          {"exit", ToJson(passage.exit_m)}};
}

bool IsAcrossAWall(const Passage& passage, const Polygon& footprint) {
  const Vector2d along = (passage.exit_m - passage.entry_m).head<2>().normalized();
  for (std::size_t i = 0; i < footprint.outer.size(); ++i) {
    const Vector2d side = footprint.outer[(i + 1) % footprint.outer.size()] - footprint.outer[i];
    if (std::abs(along.dot(side.normalized())) < 0.01) return true;
  }
  return false;
}

/// The free rectangle of a passage in its two walls.
json DescribeOpening(const Passage& passage, const Polygon& footprint, int index) {
  const auto [mouth, far_mouth] = FindMouths(passage, footprint);
  const Vector3d along = (passage.exit_m - passage.entry_m).normalized(), right(along.y(), -along.x(), 0.0);
  const auto outline = [&](const Vector3d& middle) {
    const Vector3d side = passage.free_width_m / 2 * right, up(0, 0, passage.free_height_m / 2);
    return json{ToJson(Vector3d(middle - side - up)), ToJson(Vector3d(middle - side + up)),
                ToJson(Vector3d(middle + side + up)), ToJson(Vector3d(middle + side - up))};
  };
  const double back_rad = std::atan2(-along.y(), -along.x());
  return {{"id", "o" + std::to_string(index)},
          {"kind", "through"},
          {"depth_m", (far_mouth - mouth).norm()},
          {"wall_azimuth_deg", Heading_deg(back_rad)},
          {"polygon", outline(mouth)},
          {"width_m", passage.free_width_m},
          {"z", {mouth.z() - passage.free_height_m / 2, mouth.z() + passage.free_height_m / 2}},
          {"far_wall_azimuth_deg", Heading_deg(back_rad + std::numbers::pi)},
          {"far_polygon", outline(far_mouth)}};
}

json AcceptedFor(const ObjectTruth& object, bool is_clear, double position_std_m) {
  if (!object.is_wanted) return {nullptr, is_clear ? "CLEAR" : "BLOCKED", "INSUFFICIENT_DATA"};
  json accepted = {is_clear ? "CLEAR" : "BLOCKED"};
  if (position_std_m >= kNoisy_m) accepted.push_back("INSUFFICIENT_DATA");
  return accepted;
}

json DescribeObject(const Structure& building, const ObjectTruth& object, const World& world,
                    double overview_heading_deg) {
  const Polygon& footprint = object.footprint_in_map_m.at(0);
  const Vector2d center = Centroid(footprint);
  const bool is_clear = !object.passages.empty() && object.passages[0].is_passable;
  json passages = json::array(), openings = json::array();
  for (std::size_t i = 0; i < object.passages.size(); ++i) {
    passages.push_back(
        DescribePassage(object.passages[i], footprint, world.vehicle, static_cast<int>(i + 1)));
    if (object.passages[i].is_passable && IsAcrossAWall(object.passages[i], footprint)) {
      openings.push_back(DescribeOpening(object.passages[i], footprint, static_cast<int>(i + 1)));
    }
  }
  json described = {{"id", object.id},
                    {"role", object.is_wanted ? "target" : "distractor"},
                    {"footprint", ToJson(footprint.outer)},
                    {"holes", ToJson(footprint.holes)},
                    {"centroid", {center.x(), center.y()}},
                    {"height_m", object.height_m},
                    {"vertices", footprint.outer.size()},
                    {"volume_m3", Volume_m3(building)},
                    {"solids", DescribeSolids(building)},
                    {"openings", openings},
                    {"passages", passages},
                    {"physical", is_clear ? "CLEAR" : "BLOCKED"},
                    {"expected", nullptr},
                    {"accepted", AcceptedFor(object, is_clear, world.pose_noise.position_std_m)},
                    {"marginal", false}};
  if (object.is_wanted) {
    const double rotation_deg = world.mission.reference_rotation_cw_rad / kDeg;
    const bool is_alone = world.mission.wanted.size() == 1;
    described["expected"] = described["physical"];
    described["match"] = {
        {"scale_m_per_px", world.mission.reference_m_per_px},
        {"rotation_cw_deg", rotation_deg},
        {"rotation_cw_overview_deg", rotation_deg - overview_heading_deg},
        {"symmetry_deg", is_alone ? FindSymmetries_deg(footprint) : std::vector<double>{0.0}}};
  }
  return described;
}

/// Heading of the top of a picture that looks down.
double HeadingOfTop_deg(const Pose<Map, Camera>& pose) {
  const Vector3d up = pose.rotation * Vector3d(0, -1, 0);
  return Heading_deg(std::atan2(up.y(), up.x()));
}

json DescribeFrame(const SurveyFrame& frame, const Pose<Map, Camera>& pose) {
  return {{"file", frame.file},
          {"purpose", ToString(frame.purpose)},
          {"position", ToJson(pose.translation_m)},
          {"orientation", ToJson(pose.rotation)}};
}

}  // namespace

json DescribeTruth(const World& world, const Truth& truth, const std::vector<SurveyFrame>& frames) {
  const double heading_deg = HeadingOfTop_deg(frames.at(0).map_from_camera);
  json objects = json::array(), obstacles = json::array(), described = json::array(), group = json::array();
  for (std::size_t i = 0; i < world.buildings.size(); ++i) {
    const ObjectTruth& object = truth.objects.at(i);
    if (object.is_absent) continue;
    objects.push_back(DescribeObject(world.buildings[i], object, world, heading_deg));
    if (object.is_wanted && truth.expected != Outcome::kNoMatch) group.push_back(object.id);
  }
  for (const Structure& obstacle : world.obstacles)
    obstacles.push_back({{"id", obstacle.id}, {"solids", DescribeSolids(obstacle)}});
  for (const SurveyFrame& frame : frames) {
    json entry = DescribeFrame(frame, frame.map_from_camera);
    entry["object"] = frame.object.empty() ? json() : json(frame.object);
    entry["wall_azimuth_deg"] =
        frame.purpose == Purpose::kWall ? json(Heading_deg(frame.wall_yaw_rad)) : json();
    described.push_back(entry);
  }
  const PoseNoise& noise = world.pose_noise;
  return {
      {"format", "soffit-truth/1"},
      {"scene", world.name},
      {"title", world.title},
      {"scale_class", world.mission.overview_altitude_m > 40.0 ? "real" : "model"},
      {"pose_noise",
       {{"position_std_m", noise.position_std_m}, {"orientation_std_deg", noise.orientation_std_rad / kDeg}}},
      {"vehicle", DescribeVehicle(world.vehicle)},
      {"reference",
       {{"metres_per_px", world.mission.reference_m_per_px},
        {"rotation_cw_deg", world.mission.reference_rotation_cw_rad / kDeg},
        {"group", group}}},
      {"overview_heading_deg", heading_deg},
      {"expected_outcome", ToString(truth.expected)},
      {"reason", truth.reason},
      {"frames", described},
      {"objects", objects},
      {"obstacles", obstacles}};
}

json DescribeSurvey(const World& world, const std::vector<SurveyFrame>& frames) {
  constexpr double kBetweenFrames_s = 2.5;
  const Intrinsics& lens = world.camera.intrinsics;
  json described = json::array();
  for (const SurveyFrame& frame : frames) {
    json entry = DescribeFrame(frame, frame.reported);
    entry["stamp_s"] = kBetweenFrames_s * static_cast<double>(described.size());
    entry["position_std_m"] = world.pose_noise.position_std_m;
    entry["orientation_std_rad"] = world.pose_noise.orientation_std_rad;
    described.push_back(entry);
  }
  return {{"format", "soffit-survey/1"},
          {"camera",
           {{"width", lens.width_px},
            {"height", lens.height_px},
            {"fx", lens.fx_px},
            {"fy", lens.fy_px},
            {"cx", lens.cx_px},
            {"cy", lens.cy_px},
            {"distortion_model", "plumb_bob"},
            {"d", lens.distortion}}},
          {"vehicle", DescribeVehicle(world.vehicle)},
          {"reference", {{"image", "reference.png"}}},
          {"colors", {"red", "blue", "yellow"}},
          {"frames", described}};
}

}  // namespace soffit::sim
