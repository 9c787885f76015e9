#include "service/edge/files/result.h"

#include <cmath>
#include <iomanip>
#include <locale>
#include <numbers>
#include <sstream>

#include "service/edge/files/file.h"
#include "service/edge/files/map_file.h"

namespace soffit {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

std::string IdOf(std::uint32_t object_id) { return std::to_string(object_id); }

std::string MeshFile(const Solid& solid) { return "models/" + IdOf(solid.footprint.object_id) + ".obj"; }

double Degrees(double rad) { return rad * 180.0 / std::numbers::pi; }

template <class Vector>
Json PointToJson(const Vector& point) {
  Json json = Json::array();
  for (const double value : point) json.push_back(value);
  return json;
}

template <class Points>
Json PointsToJson(const Points& points) {
  Json json = Json::array();
  for (const auto& point : points) json.push_back(PointToJson(point));
  return json;
}

Json MatchToJson(const Match& match) {
  Json rotations = Json::array();
  for (const double rotation : match.equivalent_rotations_cw_rad) rotations.push_back(Degrees(rotation));
  return {{"scale", match.scale},
          {"rotation_cw_deg", Degrees(match.rotation_cw_rad)},
          {"equivalent_rotations_cw_deg", rotations},
          {"score", match.score}};
}

Json ObjectToJson(const SceneObject& object) {
  const Footprint& footprint = object.footprint;
  Json holes = Json::array();
  for (const Ring& hole : footprint.polygon_in_map_m.holes) holes.push_back(PointsToJson(hole));
  Json json = {{"id", IdOf(footprint.object_id)},
               {"color", footprint.color},
               {"footprint", PointsToJson(footprint.polygon_in_map_m.outer)},
               {"footprint_std_m", footprint.corner_std_m},
               {"holes", holes},
               {"height_m", footprint.height_m},
               {"height_std_m", footprint.height_std_m},
               {"cut", footprint.is_cut},
               {"captures", footprint.captures},
               {"matched", object.is_matched}};
  Json neighbours = Json::array();
  for (const std::uint32_t id : object.neighbours) neighbours.push_back(IdOf(id));
  json["neighbours"] = neighbours;
  for (const Level& level : footprint.levels)
    json["levels"].push_back({{"height_m", level.height_m}, {"inset_m", level.inset_m}});
  if (object.is_matched) json["match"] = MatchToJson(object.match);
  return json;
}

Json FaceToJson(const Face& face) {
  Json json = {{"surface", ToString(face.kind)},
               {"wall", face.wall},
               {"triangles", face.triangles},
               {"picture", nullptr}};
  if (face.opening >= 0) json["opening"] = face.opening;
  if (!face.picture) return json;
  Json holes = Json::array();
  for (const Ring& hole : face.picture->outline_px.holes) holes.push_back(PointsToJson(hole));
  json["picture"] = {{"capture", face.picture->capture_id},
                     {"polygon_px", PointsToJson(face.picture->outline_px.outer)},
                     {"holes_px", holes},
                     {"shown_ratio", face.picture->shown_ratio}};
  return json;
}

Json ModelToJson(const Solid& solid) {
  Json openings = Json::array(), faces = Json::array();
  for (const Face& face : solid.faces) faces.push_back(FaceToJson(face));
  for (const SolidOpening& opening : solid.openings) {
    openings.push_back({{"wall", opening.wall},
                        {"polygon", PointsToJson(opening.polygon_in_map_m)},
                        {"through", opening.is_through},
                        {"depth_m", opening.depth_m},
                        {"std_m", opening.std_m}});
  }
  return {{"object", IdOf(solid.footprint.object_id)},
          {"mesh", MeshFile(solid)},
          {"volume_m3", solid.volume_m3},
          {"openings", openings},
          {"faces", faces}};
}

Json ViewpointToJson(const Viewpoint& viewpoint) {
  return {{"purpose", ToString(viewpoint.purpose)},
          {"position", PointToJson(viewpoint.position_in_map_m)},
          {"yaw_deg", Degrees(viewpoint.yaw_rad)},
          {"pitch_deg", Degrees(viewpoint.pitch_rad)},
          {"reason", viewpoint.reason}};
}

Json PictureToJson(const Image& image) {
  return {{"capture", image.capture_id},
          {"file", image.name},
          {"purpose", ToString(image.purpose)},
          {"position", PointToJson(image.view.map_from_camera.translation_m)}};
}

Json ToJson(const Understanding& all, const std::vector<Observation>& observations,
            const FlightRecord& flight) {
  Json json = {{"format", "soffit-result/1"}, {"revision", all.scene.revision}, {"objects", Json::array()},
               {"models", Json::array()},     {"clearance", Json::array()},     {"candidates", Json::array()},
               {"pictures", Json::array()},   {"problems", all.problems}};
  json["map_origin"] = PointToJson(flight.map_origin_m);
  for (const SceneObject& object : all.scene.objects) json["objects"].push_back(ObjectToJson(object));
  for (const Solid& solid : all.scene.solids) json["models"].push_back(ModelToJson(solid));
  for (const ClearanceDecision& decision : all.decisions)
    json["clearance"].push_back(DecisionToJson(decision));
  for (const Match& match : all.matches) {
    Json candidate = MatchToJson(match);
    candidate["objects"] = Json::array();
    for (const std::size_t shape : match.shapes) {
      candidate["objects"].push_back(IdOf(all.scene.objects.at(shape).footprint.object_id));
    }
    candidate["ambiguous"] = match.is_ambiguous;
    json["candidates"].push_back(candidate);
  }
  for (const Observation& seen : observations) json["pictures"].push_back(PictureToJson(seen.image));
  if (!flight.mission.is_null()) json["mission"] = flight.mission;
  if (!flight.truth.is_null()) json["truth"] = flight.truth;
  return json;
}

std::string ToObj(const Solid& solid) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << "# Building " << solid.footprint.object_id << ", ENU metres, closed 2-manifold\n"
       << std::setprecision(12);
  for (const Eigen::Vector3d& p : solid.mesh.vertices_in_map_m) {
    text << "v " << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
  }
  for (const auto& [a, b, c] : solid.mesh.triangles) {
    text << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << '\n';
  }
  return text.str();
}

}  // namespace

nlohmann::ordered_json DecisionToJson(const ClearanceDecision& decision) {
  Json json = {{"object", IdOf(decision.object_id)},
               {"side", decision.side},
               {"decision", ToString(decision.verdict)},
               {"reason", decision.reason}};
  if (decision.corridor) {
    json["entry"] = PointToJson(decision.corridor->entry_in_map_m);
    json["exit"] = PointToJson(decision.corridor->exit_in_map_m);
    json["free_width_m"] = decision.corridor->free_width_m;
    json["free_height_m"] = decision.corridor->free_height_m;
    json["std_m"] = decision.corridor->std_m;
    json["margins_m"] = {{"left", decision.margin_left_m},
                         {"right", decision.margin_right_m},
                         {"up", decision.margin_up_m},
                         {"down", decision.margin_down_m}};
    json["binding"] = ToString(decision.binding);
    json["distances_m"] = {{"occupied", decision.distances.to_occupied_m},
                           {"unknown", decision.distances.to_unknown_m},
                           {"surface", decision.distances.to_surface_m}};
    json["bends"] = PointsToJson(decision.corridor->bends_in_map_m);
  }
  json["seen_ratio"] = decision.seen_ratio;
  json["evidence"] = decision.evidence;
  if (decision.wanted) json["wanted"] = ViewpointToJson(*decision.wanted);
  return json;
}

Status WriteResult(const fs::path& folder, const Understanding& understanding,
                   const std::vector<Observation>& observations, const FlightRecord& flight) {
  for (const Solid& solid : understanding.scene.solids) {
    if (Status status = WriteFile(folder / MeshFile(solid), ToObj(solid)); !status.ok()) return status;
  }
  if (const auto& octree = understanding.scene.octree) {
    Status status = WriteMap(folder / "scene.bt", *octree, understanding.scene.revision, MapFormat::kBinary,
                             flight.map_origin_m);
    if (!status.ok()) return status;
  }
  return WriteFile(folder / "result.json", ToJson(understanding, observations, flight).dump(1) + "\n");
}

}  // namespace soffit
