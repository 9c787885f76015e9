#include "service/edge/live/scene_answers.h"

#include <algorithm>
#include <cmath>

namespace soffit {
namespace {

constexpr double kMaxVoxels = 1e7;

Occupancy OccupancyAt(const octomap::OcTree& tree, const Eigen::Vector3d& point) {
  const octomap::OcTreeNode* node = tree.search(point.x(), point.y(), point.z());
  if (node == nullptr) return Occupancy::kUnknown;
  return tree.isNodeOccupied(node) ? Occupancy::kOccupied : Occupancy::kFree;
}

SceneReply Refuse(SceneReply reply, const std::string& why) {
  reply.is_answered = false;
  reply.message = why;
  return reply;
}

SceneReply AnswerBox(SceneReply reply, const SceneQuery& query, const octomap::OcTree& tree) {
  const Eigen::Vector3d size = query.max_in_map_m - query.min_in_map_m;
  if (!(size.minCoeff() > 0.0))
    return Refuse(reply, "the box is empty: its highest corner must be above its lowest one");
  const Eigen::Vector3d steps = (size / tree.getResolution()).array().ceil();
  if (!(steps.prod() <= kMaxVoxels))
    return Refuse(reply, "the box has more than 10 million voxels: ask for a smaller one");
  double counts[3] = {0.0, 0.0, 0.0};
  for (int x = 0; x < steps.x(); ++x) {
    for (int y = 0; y < steps.y(); ++y) {
      for (int z = 0; z < steps.z(); ++z) {
        const Eigen::Vector3d share = (Eigen::Vector3d(x, y, z).array() + 0.5) / steps.array();
        const Eigen::Vector3d point = query.min_in_map_m.array() + share.array() * size.array();
        counts[static_cast<int>(OccupancyAt(tree, point))] += 1.0;
      }
    }
  }
  const double all = steps.prod();
  reply.unknown_ratio = counts[static_cast<int>(Occupancy::kUnknown)] / all;
  reply.free_ratio = counts[static_cast<int>(Occupancy::kFree)] / all;
  reply.occupied_ratio = counts[static_cast<int>(Occupancy::kOccupied)] / all;
  reply.occupancy = reply.occupied_ratio > 0.0  ? Occupancy::kOccupied
                    : reply.unknown_ratio > 0.0 ? Occupancy::kUnknown
                                                : Occupancy::kFree;
  return reply;
}

SceneReply AnswerObject(SceneReply reply, const SceneQuery& query, const SceneSnapshot& known) {
  const Scene& scene = known.understanding->scene;
  for (const SceneObject& object : scene.objects) {
    if (object.footprint.object_id == query.object_id) reply.object = SceneObjectReport{known.origin, object};
  }
  if (!reply.object) return Refuse(reply, "there is no object " + std::to_string(query.object_id));
  for (const Solid& solid : scene.solids) {
    if (solid.footprint.object_id == query.object_id) reply.model = ReportModel(known.origin, solid);
  }
  return reply;
}

SceneReply AnswerClearance(SceneReply reply, const SceneQuery& query, const SceneSnapshot& known) {
  for (const DecisionReport& report : known.decisions) {
    if (report.decision.object_id == query.object_id) reply.decisions.push_back(report);
  }
  if (reply.decisions.empty()) {
    return Refuse(reply, "nothing was decided about object " + std::to_string(query.object_id));
  }
  return reply;
}

}  // namespace

BuildingModelReport ReportModel(const Origin& origin, const Solid& solid) {
  return {origin, solid.footprint.object_id, solid.mesh, solid.volume_m3, solid.openings};
}

SceneReply AnswerQuery(const SceneQuery& query, const SceneSnapshot& known) {
  SceneReply reply;
  reply.id = query.id;
  if (known.understanding == nullptr) {
    return Refuse(reply, "no scene is known for vehicle " + std::to_string(query.vehicle_id));
  }
  reply.is_answered = true;
  reply.scene_revision = known.origin.scene_revision;
  const octomap::OcTree& tree = *known.understanding->scene.octree;
  switch (query.kind) {
    case SceneQueryKind::kPoint:
      reply.occupancy = OccupancyAt(tree, query.min_in_map_m);
      return reply;
    case SceneQueryKind::kBox:
      return AnswerBox(std::move(reply), query, tree);
    case SceneQueryKind::kObject:
      return AnswerObject(std::move(reply), query, known);
    case SceneQueryKind::kClearance:
      return AnswerClearance(std::move(reply), query, known);
    case SceneQueryKind::kNone:
      break;
  }
  return Refuse(reply, "the query has no kind");
}

}  // namespace soffit
