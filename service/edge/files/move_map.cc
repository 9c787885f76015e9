#include "service/edge/files/move_map.h"

namespace soffit {
namespace {

class Mover {
 public:
  explicit Mover(const Eigen::Vector3d& by_m) : by_m_(by_m) {}

  void Move(Eigen::Vector3d& point) const { point += by_m_; }
  void Move(Eigen::Vector2d& point) const { point += by_m_.head<2>(); }
  void Move(Polygon& polygon) const {
    Move(polygon.outer);
    Move(polygon.holes);
  }
  void Move(Pose<Map, Camera>& pose) const { Move(pose.translation_m); }
  void Move(Footprint& footprint) const {
    Move(footprint.polygon_in_map_m);
    for (Silhouette& silhouette : footprint.silhouettes) Move(silhouette.view.map_from_camera);
  }
  void Move(Match& match) const { Move(match.translation); }
  void Move(SceneObject& object) const {
    Move(object.footprint);
    Move(object.match);
  }
  void Move(SolidOpening& opening) const { Move(opening.polygon_in_map_m); }
  void Move(Passage& passage) const { Move(passage.sections_in_map_m); }
  void Move(Solid& solid) const {
    Move(solid.footprint);
    Move(solid.mesh.vertices_in_map_m);
    Move(solid.openings);
    Move(solid.passages);
  }
  void Move(Obstacle& obstacle) const { Move(obstacle.base_in_map_m); }
  void Move(ClearanceDecision& decision) const {
    if (decision.corridor) {
      Move(decision.corridor->entry_in_map_m);
      Move(decision.corridor->exit_in_map_m);
      Move(decision.corridor->bends_in_map_m);
    }
    if (decision.wanted) Move(decision.wanted->position_in_map_m);
  }
  void Move(Observation& seen) const {
    Move(seen.image.view.map_from_camera);
    Move(seen.sight.view.map_from_camera);
    Move(seen.footprints);
  }
  template <class Item>
  void Move(std::vector<Item>& items) const {
    for (Item& item : items) Move(item);
  }

 private:
  Eigen::Vector3d by_m_;
};

}  // namespace

Analysis MoveMap(Analysis analysis, const Eigen::Vector3d& origin_m) {
  const Mover mover(origin_m);
  Understanding& all = analysis.understanding;
  all.scene.map_origin_m -= origin_m;
  mover.Move(analysis.observations);
  mover.Move(all.scene.objects);
  mover.Move(all.scene.solids);
  mover.Move(all.scene.obstacles);
  mover.Move(all.scene.clutter);
  mover.Move(all.matches);
  mover.Move(all.decisions);
  return analysis;
}

}  // namespace soffit
