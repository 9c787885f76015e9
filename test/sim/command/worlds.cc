#include "test/sim/command/worlds.h"

#include <fstream>
#include <iostream>
#include <opencv2/imgcodecs.hpp>

#include "test/sim/draw/draw.h"
#include "test/sim/survey/reference.h"
#include "test/sim/survey/survey.h"
#include "test/sim/truth/truth.h"
#include "test/sim/world/world.h"

namespace soffit::sim {

Status PrintTruth(const std::string& world_file) {
  const auto world = LoadWorld(world_file);
  if (!world.ok()) return world.error();
  std::cout << ToJson(FindTruth(world.value())).dump(1) << std::endl;
  return OkStatus();
}

Status PrintDescription(const std::string& world_file) {
  const auto loaded = LoadWorld(world_file);
  if (!loaded.ok()) return loaded.error();
  const World& world = loaded.value();
  const Intrinsics& lens = world.camera.intrinsics;
  const nlohmann::json camera = {{"width_px", lens.width_px},    {"height_px", lens.height_px},
                                 {"fx_px", lens.fx_px},          {"fy_px", lens.fy_px},
                                 {"cx_px", lens.cx_px},          {"cy_px", lens.cy_px},
                                 {"distortion", lens.distortion}};
  const nlohmann::json vehicle = {{"radius_m", world.vehicle.radius_m},
                                  {"height_m", world.vehicle.height_m},
                                  {"safety_margin_m", world.vehicle.safety_margin_m}};
  const nlohmann::json pose_noise = {{"position_std_m", world.pose_noise.position_std_m},
                                     {"orientation_std_rad", world.pose_noise.orientation_std_rad}};
  const nlohmann::json mission = {
      {"wanted", world.mission.wanted},
      {"area_center", {world.mission.area_center_m.x(), world.mission.area_center_m.y()}},
      {"overview_altitude_m", world.mission.overview_altitude_m}};
  const nlohmann::json description = {{"name", world.name}, {"title", world.title},     {"camera", camera},
                                      {"vehicle", vehicle}, {"pose_noise", pose_noise}, {"mission", mission}};
  std::cout << description.dump(1) << std::endl;
  return OkStatus();
}

Status WriteReference(const std::string& world_file, const std::string& png_file) {
  const auto world = LoadWorld(world_file);
  if (!world.ok()) return world.error();
  std::vector<std::uint8_t> png;
  cv::imencode(".png", DrawReference(world.value()), png);
  std::ofstream stream(png_file, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  stream.close();
  if (!stream) return InvalidInput("reference '" + png_file + "' cannot be written");
  return OkStatus();
}

Status WriteSurveyOf(const std::string& world_file, std::uint64_t seed, const std::string& folder) {
  constexpr int kThreads = 2;
  const auto world = LoadWorld(world_file);
  if (!world.ok()) return world.error();
  return WriteSurvey(world.value(), seed, folder, kThreads);
}

Status WriteRandomWorld(std::uint64_t seed, const std::string& file) {
  std::ofstream stream(file);
  stream << FormatWorld(DrawWorld(seed));
  stream.close();
  if (!stream) return InvalidInput("world file '" + file + "' cannot be written");
  return OkStatus();
}

}  // namespace soffit::sim
