#include "service/edge/cli/query_output.h"

#include "service/clearance/describe.h"
#include "service/edge/files/result.h"
#include "shared/result/say.h"

namespace soffit {
namespace {

using nlohmann::json;

// ---- For programs ----

json ToJson(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

json ToJson(const Ring& ring) {
  json corners = json::array();
  for (const Eigen::Vector2d& corner : ring) corners.push_back({corner.x(), corner.y()});
  return corners;
}

json ToJson(const std::vector<Eigen::Vector3d>& points) {
  json all = json::array();
  for (const Eigen::Vector3d& point : points) all.push_back(ToJson(point));
  return all;
}

json ToJson(const std::vector<Cell>& cells) {
  json all = json::array();
  for (const Cell& cell : cells) {
    all.push_back({{"center", ToJson(cell.center_in_map_m)},
                   {"size_m", cell.size_m},
                   {"state", ToString(cell.occupancy)}});
  }
  return all;
}

json ToJson(const Nearest& nearest) {
  if (!nearest.is_found) return nullptr;
  json found = {{"distance_m", nearest.distance_m}, {"point", ToJson(nearest.point_in_map_m)}};
  if (nearest.object_id != 0) found["object"] = nearest.object_id;
  return found;
}

json ToJson(const SceneObject& object) {
  json all = {{"id", object.footprint.object_id},
              {"color", object.footprint.color},
              {"footprint", ToJson(object.footprint.polygon_in_map_m.outer)},
              {"holes", json::array()},
              {"height_m", object.footprint.height_m},
              {"matched", object.is_matched},
              {"neighbours", object.neighbours}};
  for (const Ring& hole : object.footprint.polygon_in_map_m.holes) all["holes"].push_back(ToJson(hole));
  return all;
}

json ToJson(const DecisionReport& report) {
  json all = DecisionToJson(report.decision);
  all["decision_id"] = report.decision.decision_id;
  all["valid_until_utc_ns"] = report.valid_until_utc_ns;
  return all;
}

json ToJson(const Layer& layer) {
  return {{"bottom_m", layer.bottom_m}, {"top_m", layer.top_m}, {"state", ToString(layer.occupancy)}};
}

json ToJson(const Change& change) {
  return {{"change", ToString(change.kind)},
          {"thing", ToString(change.thing)},
          {"object", change.object_id},
          {"side", change.side}};
}

json ToJson(const Revision& revision) {
  return {{"mission_id", revision.mission_id},
          {"scene_revision", revision.scene_revision},
          {"stamp_utc_ns", revision.stamp_utc_ns},
          {"objects", revision.objects},
          {"models", revision.models},
          {"decisions", revision.decisions},
          {"octree_nodes", revision.octree_nodes},
          {"is_kept", revision.is_kept}};
}

template <class T>
json AllToJson(const std::vector<T>& items) {
  json all = json::array();
  for (const T& item : items) all.push_back(ToJson(item));
  return all;
}

json ObjectsToJson(const SceneReply& reply) {
  json all = json::array();
  for (std::size_t i = 0; i < reply.objects.size(); ++i) {
    all.push_back(ToJson(reply.objects[i].object));
    if (i < reply.distances_m.size()) all.back()["distance_m"] = reply.distances_m[i];
  }
  return all;
}

void AddGrid(const CellGrid& grid, json& all) {
  if (grid.occupancy.empty()) return;
  all["grid"] = {{"low", ToJson(grid.low_in_map_m)},
                 {"resolution_m", grid.resolution_m},
                 {"size", {grid.size.x(), grid.size.y(), grid.size.z()}},
                 {"cells", grid.occupancy}};
}

// ---- For people ----

std::string Describe(const char* what, const Nearest& nearest) {
  if (!nearest.is_found) return Say(what, ": none\n");
  return Say(what, ": ", nearest.distance_m, " m, at ", SayPlace(nearest.point_in_map_m),
             nearest.object_id != 0 ? Say(", building ", nearest.object_id) : "", "\n");
}

std::string DescribeBox(const SceneReply& reply) {
  std::string text = Say(ToString(reply.occupancy), ": ", 100.0 * reply.shares.free_ratio, " % free, ",
                         100.0 * reply.shares.occupied_ratio, " % occupied, ",
                         100.0 * reply.shares.unknown_ratio, " % unknown\n");
  if (reply.grid.occupancy.empty()) return text;
  for (int z = 0; z < reply.grid.size.z(); ++z) {
    text += Say("from z = ", reply.grid.low_in_map_m.z() + z * reply.grid.resolution_m, " m, north up:\n");
    for (int y = reply.grid.size.y() - 1; y >= 0; --y) {
      for (int x = 0; x < reply.grid.size.x(); ++x)
        text += "?.#"[reply.grid.occupancy[reply.grid.Index({x, y, z})]];
      text += '\n';
    }
  }
  return text;
}

std::string DescribeObjects(const SceneReply& reply) {
  std::string text;
  for (std::size_t i = 0; i < reply.objects.size(); ++i) {
    const SceneObject& object = reply.objects[i].object;
    const Eigen::Vector2d center = Centroid(object.footprint.polygon_in_map_m);
    text +=
        Say("building ", object.footprint.object_id, ": ", object.footprint.color, ", ",
            object.footprint.polygon_in_map_m.outer.size(), " corners about (", center.x(), ", ", center.y(),
            "), ", object.footprint.height_m, " m high", object.is_matched ? ", the wanted one" : "");
    if (i < reply.distances_m.size()) text += Say(", ", reply.distances_m[i], " m away");
    if (!object.neighbours.empty()) {
      text += "; neighbours";
      for (const std::uint32_t neighbour : object.neighbours) text += " " + std::to_string(neighbour);
    }
    text += '\n';
  }
  if (reply.model) {
    text += Say("its model: ", reply.model->volume_m3, " m3, ", reply.model->mesh.triangles.size(),
                " triangles, ", reply.model->openings.size(), " openings\n");
  }
  if (reply.objects.empty()) text = "no building\n";
  return text;
}

std::string DescribeColumn(const SceneReply& reply) {
  std::string text = reply.height_m ? Say("height: ", *reply.height_m, " m\n") : "height: not known\n";
  for (auto layer = reply.layers.rbegin(); layer != reply.layers.rend(); ++layer) {
    text += Say("from ", layer->bottom_m, " to ", layer->top_m, " m: ", ToString(layer->occupancy), "\n");
  }
  return text + DescribeObjects(reply);
}

std::string DescribeDecisions(const SceneReply& reply) {
  std::string text;
  for (const DecisionReport& report : reply.decisions) {
    const ClearanceDecision& decision = report.decision;
    text += Describe(decision) + '\n';
    if (!decision.corridor) continue;
    text += Say("  from ", SayPlace(decision.corridor->entry_in_map_m), " to ",
                SayPlace(decision.corridor->exit_in_map_m), ": ", DescribeRoom(decision), "\n");
  }
  return text;
}

std::string DescribeWay(const SceneReply& reply) {
  std::string text = Say(ToString(reply.verdict), ": ", reply.message, "\n");
  for (const Eigen::Vector3d& point : reply.path_in_map_m) text += "  " + SayPlace(point) + '\n';
  if (!reply.cells.empty()) {
    text += Say(reply.cells.size(), reply.has_more ? " cells and more are" : " cells are",
                " in the way; the first: ", ToString(reply.cells.front().occupancy), " at ",
                SayPlace(reply.cells.front().center_in_map_m), "\n");
  }
  return text;
}

std::string DescribeChanges(const SceneReply& reply) {
  std::string text;
  for (const Change& change : reply.changes) {
    text += Say(ToString(change.thing), " ", change.object_id,
                change.side >= 0 ? Say(", side ", change.side) : "", ": ", ToString(change.kind), "\n");
  }
  text += Say(reply.changed_cells, " cells have changed");
  if (!reply.changed_in_map_m.isEmpty())
    text += ", within " + SayPlace(reply.changed_in_map_m.min()) + " to " +
            SayPlace(reply.changed_in_map_m.max());
  return text + '\n';
}

std::string DescribeRevisions(const SceneReply& reply) {
  std::string text;
  for (const Revision& revision : reply.revisions) {
    text += Say("revision ", revision.scene_revision, ": ", revision.objects, " buildings, ", revision.models,
                " models, ", revision.decisions, " decisions, ", revision.octree_nodes, " nodes",
                revision.is_kept ? "" : " (no longer kept)", "\n");
  }
  return text;
}

}  // namespace

json AnswerToJson(SceneQueryKind kind, const SceneReply& reply) {
  json all = {{"mission_id", reply.origin.mission_id},
              {"scene_revision", reply.origin.scene_revision},
              {"stamp_utc_ns", reply.stamp_utc_ns},
              {"resolution_m", reply.resolution_m}};
  switch (kind) {
    case SceneQueryKind::kPoint:
      all["state"] = ToString(reply.occupancy);
      all["cell"] = ToJson(reply.cells).at(0);
      break;
    case SceneQueryKind::kBox:
      all["state"] = ToString(reply.occupancy);
      all["free_ratio"] = reply.shares.free_ratio;
      all["occupied_ratio"] = reply.shares.occupied_ratio;
      all["unknown_ratio"] = reply.shares.unknown_ratio;
      AddGrid(reply.grid, all);
      break;
    case SceneQueryKind::kRay:
      all["end"] = ToString(reply.ray);
      all["distance_m"] = reply.distance_m;
      all["point"] = ToJson(reply.point_in_map_m);
      break;
    case SceneQueryKind::kNearest:
      all["occupied"] = ToJson(reply.nearest_occupied);
      all["unknown"] = ToJson(reply.nearest_unknown);
      all["surface"] = ToJson(reply.surface);
      break;
    case SceneQueryKind::kColumn:
      all["height_m"] = reply.height_m ? json(*reply.height_m) : json(nullptr);
      all["layers"] = AllToJson(reply.layers);
      all["objects"] = ObjectsToJson(reply);
      break;
    case SceneQueryKind::kObjects:
      all["objects"] = ObjectsToJson(reply);
      if (reply.model) {
        all["model"] = {{"volume_m3", reply.model->volume_m3},
                        {"triangles", reply.model->mesh.triangles.size()},
                        {"openings", reply.model->openings.size()}};
      }
      break;
    case SceneQueryKind::kClearance:
      all["clearance"] = AllToJson(reply.decisions);
      break;
    case SceneQueryKind::kWay:
    case SceneQueryKind::kPath:
      all["decision"] = ToString(reply.verdict);
      all["reason"] = reply.message;
      all["path"] = ToJson(reply.path_in_map_m);
      all["length_m"] = reply.distance_m;
      all["in_the_way"] = ToJson(reply.cells);
      break;
    case SceneQueryKind::kChanges:
      all["changes"] = AllToJson(reply.changes);
      all["changed_cells"] = reply.changed_cells;
      all["cells"] = ToJson(reply.cells);
      break;
    case SceneQueryKind::kRevisions:
      all["revisions"] = AllToJson(reply.revisions);
      break;
    case SceneQueryKind::kNone:
      break;
  }
  if (reply.has_more) all["has_more"] = true;
  return all;
}

std::string DescribeAnswer(SceneQueryKind kind, const SceneReply& reply) {
  switch (kind) {
    case SceneQueryKind::kPoint:
      return Say(ToString(reply.occupancy), ", a cell of ", reply.cells.at(0).size_m, " m about ",
                 SayPlace(reply.cells.at(0).center_in_map_m), "\n");
    case SceneQueryKind::kBox:
      return DescribeBox(reply);
    case SceneQueryKind::kRay:
      return Say(ToString(reply.ray), " after ", reply.distance_m, " m, at ", SayPlace(reply.point_in_map_m),
                 "\n");
    case SceneQueryKind::kNearest:
      return Describe("nearest obstacle", reply.nearest_occupied) +
             Describe("nearest unknown", reply.nearest_unknown) +
             Describe("surface of a model", reply.surface);
    case SceneQueryKind::kColumn:
      return DescribeColumn(reply);
    case SceneQueryKind::kObjects:
      return DescribeObjects(reply);
    case SceneQueryKind::kClearance:
      return DescribeDecisions(reply);
    case SceneQueryKind::kWay:
    case SceneQueryKind::kPath:
      return DescribeWay(reply);
    case SceneQueryKind::kChanges:
      return DescribeChanges(reply);
    case SceneQueryKind::kRevisions:
      return DescribeRevisions(reply);
    case SceneQueryKind::kNone:
      break;
  }
  return "";
}

}  // namespace soffit
