#pragma once

#include <opencv2/imgproc.hpp>

#include "service/pipeline/pipeline.h"
#include "service/solid/face_picture.h"

namespace soffit::test {

/// A red arch of 4 x 1.5 x 2.3 m with a passage of 1.6 x 1.4 m from its south to its north side, a blue
/// neighbour, a pole that no model accounts for, and a CLEAR corridor: what a good survey of it would give.
inline Footprint BoxFootprint(std::uint32_t id, const std::string& color, double x0, double y0, double x1,
                              double y1, double height_m) {
  Footprint footprint;
  footprint.object_id = id;
  footprint.color = color;
  footprint.polygon_in_map_m.outer = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  footprint.corner_std_m = {0.01, 0.01, 0.01, 0.01};
  footprint.height_m = height_m;
  footprint.height_std_m = 0.01;
  footprint.captures = {1};
  return footprint;
}

/// A level picture of the arch from the south and one from straight above, plain grey.
inline std::vector<Observation> ArchObservations() {
  const Intrinsics camera{640, 480, 425.0, 425.0, 319.5, 239.5, {}};
  std::vector<Observation> observations(2);
  for (std::size_t i = 0; i < 2; ++i) {
    Image& image = observations[i].image;
    image.capture_id = static_cast<std::uint32_t>(i + 1);
    image.bgr = cv::Mat3b(480, 640, cv::Vec3b(150, 150, 150));
    image.seen = {0, 0, 640, 480};
    image.has_trusted_pose = true;
    image.view.intrinsics = image.taken = camera;
    observations[i].mask.label = cv::Mat1b(480, 640, uchar{0});
  }
  observations[0].image.name = "overview.jpg";
  observations[0].image.purpose = Purpose::kOverview;
  observations[0].image.view.map_from_camera = {CameraAttitude(1.57, -1.5707963), {3.0, 1.0, 9.0}};
  observations[1].image.name = "wall.jpg";
  observations[1].image.purpose = Purpose::kWall;
  observations[1].image.view.map_from_camera = {CameraAttitude(1.5707963, 0.0), {1.5, -4.5, 1.2}};
  return observations;
}

/// Its walls were read from the second of these pictures, its outline was drawn from the first.
inline Solid ArchSolid(Footprint footprint, const std::vector<Observation>& observations) {
  footprint.silhouettes = {{1, observations[0].image.view, {}}};
  std::vector<Facade> walls(4);
  for (int side = 0; side < 4; ++side) {
    Facade& wall = walls[static_cast<std::size_t>(side)];
    wall.object_id = footprint.object_id;
    wall.side = side;
    wall.was_seen = true;
    wall.capture_id = 2;
    if (side % 2 != 0) continue;
    Opening mouth;
    mouth.ring_in_wall_m = {{1.2, 0}, {2.8, 0}, {2.8, 1.4}, {1.2, 1.4}};
    mouth.is_through = mouth.shows_background = true;
    wall.openings = {mouth};
  }
  std::vector<Sight> sights(2);
  for (std::size_t i = 0; i < 2; ++i) {
    const Image& image = observations[i].image;
    sights[i].capture_id = image.capture_id;
    sights[i].view = image.view;
    sights[i].taken = image.taken;
    sights[i].shown = image.seen;
  }
  return FindFacePictures({RaiseSolid(footprint, walls).value()}, walls, sights).front();
}

inline Understanding ArchUnderstanding() {
  Understanding all;
  SceneObject arch;
  arch.footprint = BoxFootprint(1, "red", 0, 0, 4, 1.5, 2.3);
  arch.is_matched = true;
  arch.match.shapes = {0};
  arch.match.scale = 0.02;
  arch.match.rotation_cw_rad = 0.5;
  arch.match.score = 0.98;
  arch.neighbours = {2};
  SceneObject neighbour;
  neighbour.footprint = BoxFootprint(2, "blue", 6, 2, 8, 4, 1.2);
  neighbour.neighbours = {1};
  all.scene.revision = 7;
  all.scene.objects = {arch, neighbour};
  all.matches = {arch.match};

  all.scene.solids = {ArchSolid(arch.footprint, ArchObservations())};

  auto octree = std::make_shared<octomap::OcTree>(0.1);
  for (double z = 0.05; z < 1.5; z += 0.1) {
    for (double x = 1.25; x < 2.8; x += 0.1) {
      for (double y = -2.0; y < 3.0; y += 0.1) octree->updateNode(x, y, z, false);
    }
    for (int i = 0; i < 3; ++i) octree->updateNode(0.55, -1.05, z, true);
  }
  all.scene.octree = octree;

  Corridor corridor;
  corridor.object_id = 1;
  corridor.entry_wall = 0;
  corridor.exit_wall = 2;
  corridor.entry_in_map_m = {2.0, -1.6, 0.7};
  corridor.exit_in_map_m = {2.0, 3.1, 0.7};
  corridor.free_width_m = 1.6;
  corridor.free_height_m = 1.4;
  corridor.left_m = 0.8;
  ClearanceDecision decision;
  decision.object_id = 1;
  decision.side = 0;
  decision.verdict = Verdict::kClear;
  decision.reason = "clear by 0.20 m";
  decision.corridor = corridor;
  decision.vehicle = {0.35, 0.30, 0.25};
  decision.margin_left_m = decision.margin_right_m = 0.2;
  decision.margin_up_m = decision.margin_down_m = 0.3;
  decision.binding = Bound::kLeft;
  decision.distances = {kDistanceReach_m, 0.35, 0.45};
  decision.seen_ratio = 1.0;
  decision.evidence = {2};
  all.decisions = {decision};
  return all;
}

}  // namespace soffit::test
