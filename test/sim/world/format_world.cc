#include <yaml-cpp/yaml.h>

#include <cmath>
#include <numbers>

#include "test/sim/world/world.h"

namespace soffit::sim {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;

const char* NameOf(Pattern pattern) {
  switch (pattern) {
    case Pattern::kPlain:
      return "plain";
    case Pattern::kMottled:
      return "mottled";
    case Pattern::kPanels:
      return "panels";
    case Pattern::kBricks:
      return "bricks";
    case Pattern::kSlabs:
      return "slabs";
    case Pattern::kGrass:
      return "grass";
  }
  return "plain";
}

void Put(YAML::Emitter& out, const Eigen::Vector2d& v) {
  out << YAML::Flow << YAML::BeginSeq << v.x() << v.y() << YAML::EndSeq;
}

void Put(YAML::Emitter& out, const char* key, const Eigen::Vector2d& v) {
  out << YAML::Key << key << YAML::Value;
  Put(out, v);
}

template <class T>
void Put(YAML::Emitter& out, const char* key, const T& value) {
  out << YAML::Key << key << YAML::Value << value;
}

void Begin(YAML::Emitter& out, const char* key) { out << YAML::Key << key << YAML::Value << YAML::BeginMap; }

void PutRing(YAML::Emitter& out, const Ring& ring) {
  out << YAML::Flow << YAML::BeginSeq;
  for (const Eigen::Vector2d& corner : ring) Put(out, corner);
  out << YAML::EndSeq;
}

void PutFinish(YAML::Emitter& out, const Finish& finish) {
  const Eigen::Vector3d color = 255.0 * finish.color_srgb;
  out << YAML::Key << "color" << YAML::Value << YAML::Flow << YAML::BeginSeq << color.x() << color.y()
      << color.z() << YAML::EndSeq;
  Put(out, "pattern", NameOf(finish.pattern));
  Put(out, "grain_m", finish.grain_m);
  Put(out, "contrast", finish.contrast);
}

void PutPrism(YAML::Emitter& out, const Prism& prism) {
  out << YAML::Key << (prism.is_lying ? "profile" : "polygon") << YAML::Value;
  PutRing(out, prism.section.outer);
  if (!prism.top.empty()) {
    out << YAML::Key << "top" << YAML::Value;
    PutRing(out, prism.top);
  }
  if (!prism.section.holes.empty()) {
    out << YAML::Key << "holes" << YAML::Value << YAML::BeginSeq;
    for (const Ring& hole : prism.section.holes) PutRing(out, hole);
    out << YAML::EndSeq;
  }
  if (prism.is_lying) {
    Put(out, "axis", prism.axis);
    Put(out, "at", prism.at);
  }
  Put(out, prism.is_lying ? "depth" : "z", Eigen::Vector2d(prism.low_m, prism.high_m));
}

void PutMesh(YAML::Emitter& out, const MeshFile& mesh) {
  Begin(out, "mesh");
  Put(out, "file", mesh.file);
  if (mesh.origin) {
    out << YAML::Key << "origin" << YAML::Value << YAML::Flow << YAML::BeginSeq << mesh.origin->x()
        << mesh.origin->y() << mesh.origin->z() << YAML::EndSeq;
  }
  if (!mesh.only.empty()) out << YAML::Key << "only" << YAML::Value << YAML::Flow << mesh.only;
  if (!mesh.without.empty()) out << YAML::Key << "without" << YAML::Value << YAML::Flow << mesh.without;
  if (!mesh.cuts.empty()) {
    out << YAML::Key << "cut" << YAML::Value << YAML::BeginSeq;
    for (const Prism& cut : mesh.cuts) {
      out << YAML::BeginMap;
      PutPrism(out, cut);
      out << YAML::EndMap;
    }
    out << YAML::EndSeq;
  }
  out << YAML::EndMap;
}

void PutStructures(YAML::Emitter& out, const char* key, const std::vector<Structure>& structures) {
  if (structures.empty()) return;
  out << YAML::Key << key << YAML::Value << YAML::BeginSeq;
  for (const Structure& structure : structures) {
    out << YAML::BeginMap;
    Put(out, "id", structure.id);
    Put(out, "position", structure.position_m);
    Put(out, "yaw_deg", structure.yaw_rad / kDeg);
    if (structure.is_absent) Put(out, "absent", true);
    PutFinish(out, structure.finish);
    out << YAML::Key << "parts" << YAML::Value << YAML::BeginSeq;
    for (const Part& part : structure.parts) {
      out << YAML::BeginMap;
      if (const auto* prism = std::get_if<Prism>(&part.shape)) PutPrism(out, *prism);
      if (const auto* mesh = std::get_if<MeshFile>(&part.shape)) PutMesh(out, *mesh);
      if (part.finish) PutFinish(out, *part.finish);
      out << YAML::EndMap;
    }
    out << YAML::EndSeq << YAML::EndMap;
  }
  out << YAML::EndSeq;
}

void PutBushes(YAML::Emitter& out, const std::vector<Bush>& bushes) {
  if (bushes.empty()) return;
  out << YAML::Key << "bushes" << YAML::Value << YAML::BeginSeq;
  for (const Bush& bush : bushes) {
    out << YAML::Flow << YAML::BeginMap;
    Put(out, "position", bush.position_m);
    Put(out, "radius", bush.radius_m);
    out << YAML::EndMap;
  }
  out << YAML::EndSeq;
}

void PutWeather(YAML::Emitter& out, const World& world) {
  Begin(out, "sun");
  Put(out, "yaw_deg", world.sun.yaw_rad / kDeg);
  Put(out, "elevation_deg", world.sun.elevation_rad / kDeg);
  Put(out, "strength", world.sun.strength);
  out << YAML::EndMap;
  Begin(out, "sky");
  Put(out, "cloud_ratio", world.sky.cloud_ratio);
  Put(out, "haze_m", world.sky.haze_m);
  out << YAML::EndMap;
  Begin(out, "wind");
  Put(out, "mean_mps", world.wind.mean_mps);
  Put(out, "gust_std_mps", world.wind.gust_std_mps);
  out << YAML::EndMap;
  Begin(out, "pose_noise");
  Put(out, "position_std_m", world.pose_noise.position_std_m);
  Put(out, "orientation_std_deg", world.pose_noise.orientation_std_rad / kDeg);
  out << YAML::EndMap;
}

void PutCamera(YAML::Emitter& out, const CameraModel& camera) {
  const Intrinsics& lens = camera.intrinsics;
  Begin(out, "camera");
  Put(out, "width_px", lens.width_px);
  Put(out, "height_px", lens.height_px);
  Put(out, "fx_px", lens.fx_px);
  Put(out, "fy_px", lens.fy_px);
  Put(out, "cx_px", lens.cx_px);
  Put(out, "cy_px", lens.cy_px);
  out << YAML::Key << "distortion" << YAML::Value << YAML::Flow << YAML::BeginSeq;
  for (const double coefficient : lens.distortion) out << coefficient;
  out << YAML::EndSeq;
  Put(out, "exposure_s", camera.exposure_s);
  Put(out, "exposure_ev", camera.exposure_ev);
  Put(out, "noise_levels", camera.noise_levels);
  Put(out, "blur_px", camera.blur_px);
  Put(out, "vignetting", camera.vignetting);
  Put(out, "jpeg_quality", camera.jpeg_quality);
  out << YAML::EndMap;
}

void PutMission(YAML::Emitter& out, const MissionPlan& mission) {
  Begin(out, "mission");
  out << YAML::Key << "wanted" << YAML::Value << YAML::Flow << mission.wanted;
  Put(out, "reference_m_per_px", mission.reference_m_per_px);
  Put(out, "reference_rotation_cw_deg", mission.reference_rotation_cw_rad / kDeg);
  Put(out, "area_center", mission.area_center_m);
  Put(out, "overview_altitude_m", mission.overview_altitude_m);
  out << YAML::EndMap;
}

}  // namespace

std::string FormatWorld(const World& world) {
  YAML::Emitter out;
  out.SetDoublePrecision(12);
  out << YAML::BeginMap;
  Put(out, "title", world.title);
  Begin(out, "geodetic_origin");
  Put(out, "latitude_deg", world.origin.latitude_deg);
  Put(out, "longitude_deg", world.origin.longitude_deg);
  Put(out, "altitude_amsl_m", world.origin.altitude_amsl_m);
  out << YAML::EndMap;
  Begin(out, "home");
  Put(out, "yaw_deg", world.home_yaw_rad / kDeg);
  out << YAML::EndMap;
  PutWeather(out, world);
  Begin(out, "ground");
  PutFinish(out, world.ground);
  out << YAML::EndMap;
  PutCamera(out, world.camera);
  Begin(out, "vehicle");
  Put(out, "radius_m", world.vehicle.radius_m);
  Put(out, "height_m", world.vehicle.height_m);
  Put(out, "safety_margin_m", world.vehicle.safety_margin_m);
  out << YAML::EndMap;
  PutMission(out, world.mission);
  PutStructures(out, "buildings", world.buildings);
  PutStructures(out, "obstacles", world.obstacles);
  PutStructures(out, "scenery", world.scenery);
  PutBushes(out, world.bushes);
  out << YAML::EndMap;
  return std::string(out.c_str()) + "\n";
}

}  // namespace soffit::sim
