#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <set>
#include <sstream>

#include "test/sim/world/mesh_file.h"
#include "test/sim/world/world.h"
#include "test/sim/world/yaml_reader.h"

namespace soffit::sim {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;
constexpr double kMaxReach_m = 2000.0;

Eigen::Vector3d ReadColor(const YamlReader& in) {
  static const std::map<std::string, Eigen::Vector3d> kNamed = {
      {"red", {0.72, 0.07, 0.06}},   {"blue", {0.09, 0.17, 0.62}},  {"yellow", {0.90, 0.72, 0.08}},
      {"grey", {0.52, 0.51, 0.49}},  {"white", {0.88, 0.88, 0.86}}, {"black", {0.07, 0.07, 0.07}},
      {"brown", {0.40, 0.28, 0.18}}, {"green", {0.24, 0.36, 0.13}}};
  if (in.IsSequence()) return in.Vector3({0.0, 255.0}) / 255.0;
  const auto found = kNamed.find(in.Text());
  if (found == kNamed.end()) {
    in.Refuse("unknown colour '" + in.Text() +
              "'; known are red, blue, yellow, grey, white, black, brown, green, or [r, g, b] from 0 to 255");
  }
  return found->second;
}

Pattern ReadPattern(const YamlReader& in) {
  static const std::map<std::string, Pattern> kNamed = {
      {"plain", Pattern::kPlain},   {"mottled", Pattern::kMottled}, {"panels", Pattern::kPanels},
      {"bricks", Pattern::kBricks}, {"slabs", Pattern::kSlabs},     {"grass", Pattern::kGrass}};
  const auto found = kNamed.find(in.Text());
  if (found == kNamed.end()) {
    in.Refuse("unknown pattern '" + in.Text() + "'; known are plain, mottled, panels, bricks, slabs, grass");
  }
  return found->second;
}

/// The keys color, pattern, grain_m, contrast of `in`.
Finish ReadFinish(const YamlReader& in, Finish finish) {
  if (in.Has("color")) finish.color_srgb = ReadColor(in.At("color"));
  if (in.Has("pattern")) finish.pattern = ReadPattern(in.At("pattern"));
  finish.grain_m = in.Number("grain_m", finish.grain_m, {0.01, 100.0});
  finish.contrast = in.Number("contrast", finish.contrast, {0.0, 1.0});
  return finish;
}

Ring ReadRing(const YamlReader& in, bool counter_clockwise) {
  Ring ring;
  for (const YamlReader& corner : in.Items()) ring.push_back(corner.Vector2({-kMaxReach_m, kMaxReach_m}));
  if (ring.size() < 3) in.Refuse("a polygon needs at least 3 corners");
  if (!IsSimple(ring)) in.Refuse("the polygon's sides cross or touch each other");
  if ((SignedArea(ring) > 0.0) != counter_clockwise) std::reverse(ring.begin(), ring.end());
  return ring;
}

Polygon ReadPolygon(const YamlReader& in, const char* key) {
  Polygon polygon{ReadRing(in.At(key), true), {}};
  for (const YamlReader& hole : in.Items("holes")) polygon.holes.push_back(ReadRing(hole, false));
  return polygon;
}

Ring ReadTop(const YamlReader& in, const Polygon& section) {
  if (!section.holes.empty()) in.Refuse("a polygon with holes keeps its outline");
  Ring top = ReadRing(in, true);
  if (top.size() != section.outer.size()) in.Refuse("must have as many corners as the polygon");
  return top;
}

void ReadSpan(const YamlReader& in, Prism& prism) {
  const Eigen::Vector2d span = in.Vector2({-kMaxReach_m, kMaxReach_m});
  if (!(span.x() < span.y())) in.Refuse("the first number must be smaller than the second");
  prism.low_m = span.x();
  prism.high_m = span.y();
}

Ring RingOfCylinder(const Eigen::Vector2d& center, double radius_m) {
  constexpr int kSides = 24;
  Ring ring;
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kSides;
    ring.push_back(center + radius_m * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return ring;
}

Ring RingOfBox(const YamlReader& in) {
  const Eigen::Vector2d center = in.At("center").Vector2({-kMaxReach_m, kMaxReach_m});
  const Eigen::Vector2d half = 0.5 * in.At("size").Vector2({0.001, kMaxReach_m});
  return {center + Eigen::Vector2d(-half.x(), -half.y()), center + Eigen::Vector2d(half.x(), -half.y()),
          center + half, center + Eigen::Vector2d(-half.x(), half.y())};
}

Prism ReadLyingPrism(const YamlReader& in) {
  Prism prism;
  prism.section = ReadPolygon(in, "profile");
  const Eigen::Vector2d axis = in.At("axis").Vector2();
  if (!(axis.norm() > 1e-6)) in.At("axis").Refuse("must not be zero");
  prism.is_lying = true;
  prism.axis = axis.normalized();
  prism.at = in.Vector2("at", Eigen::Vector2d::Zero());
  ReadSpan(in.At("depth"), prism);
  return prism;
}

/// A prism of any of its forms, or nothing when `in` has none of their keys.
std::optional<Prism> ReadPrism(const YamlReader& in) {
  if (in.Has("profile")) return ReadLyingPrism(in);
  Prism prism;
  if (in.Has("polygon")) {
    prism.section = ReadPolygon(in, "polygon");
    if (in.Has("top")) prism.top = ReadTop(in.At("top"), prism.section);
  } else if (in.Has("cylinder")) {
    const YamlReader cylinder = in.At("cylinder");
    cylinder.AllowKeys({"center", "radius"});
    prism.section.outer = RingOfCylinder(cylinder.Vector2("center", Eigen::Vector2d::Zero()),
                                         cylinder.At("radius").Number({0.001, kMaxReach_m}));
  } else if (in.Has("box")) {
    in.At("box").AllowKeys({"center", "size"});
    prism.section.outer = RingOfBox(in.At("box"));
  } else {
    return std::nullopt;
  }
  ReadSpan(in.At("z"), prism);
  return prism;
}

std::vector<std::string> ReadNames(const YamlReader& in, const char* key) {
  std::vector<std::string> names;
  for (const YamlReader& name : in.Items(key)) names.push_back(name.Text());
  return names;
}

/// `file.obj`, or a mapping that says more about it.
MeshFile ReadMeshFile(const YamlReader& in, const std::filesystem::path& folder) {
  constexpr double kFarFromOrigin_m = 1e8;  // Projected coordinates of any kind.
  MeshFile mesh;
  if (in.IsMap()) {
    in.AllowKeys({"file", "origin", "only", "without", "cut"});
    mesh.file = in.At("file").Text();
    if (in.Has("origin")) mesh.origin = in.At("origin").Vector3({-kFarFromOrigin_m, kFarFromOrigin_m});
    mesh.only = ReadNames(in, "only");
    mesh.without = ReadNames(in, "without");
    for (const YamlReader& cut : in.Items("cut")) {
      cut.AllowKeys({"polygon", "holes", "z", "profile", "axis", "at", "depth", "cylinder", "box"});
      const std::optional<Prism> prism = ReadPrism(cut);
      if (!prism) cut.Refuse("needs one of polygon, profile, cylinder, box");
      mesh.cuts.push_back(*prism);
    }
  } else {
    mesh.file = in.Text();
  }
  const Result<Mesh> read = ReadMesh(mesh, folder);
  if (!read.ok()) in.Refuse(read.error().message);
  mesh.mesh = read.value();
  return mesh;
}

std::variant<Prism, MeshFile> ReadShape(const YamlReader& in, const std::filesystem::path& folder) {
  if (in.Has("mesh")) return ReadMeshFile(in.At("mesh"), folder);
  const std::optional<Prism> prism = ReadPrism(in);
  if (!prism) in.Refuse("needs one of polygon, profile, cylinder, box, mesh");
  return *prism;
}

Part ReadPart(const YamlReader& in, const Finish& finish, const std::filesystem::path& folder) {
  in.AllowKeys({"polygon", "top", "holes", "z", "profile", "axis", "at", "depth", "cylinder", "box", "mesh",
                "color", "pattern", "grain_m", "contrast"});
  Part part{ReadShape(in, folder), {}};
  if (in.Has("color") || in.Has("pattern") || in.Has("grain_m") || in.Has("contrast")) {
    part.finish = ReadFinish(in, finish);
  }
  return part;
}

Structure ReadStructure(const YamlReader& in, const std::filesystem::path& folder) {
  in.AllowKeys({"id", "position", "yaw_deg", "absent", "color", "pattern", "grain_m", "contrast", "parts"});
  Structure structure;
  structure.id = in.At("id").Text();
  structure.position_m = in.Vector2("position", structure.position_m, {-kMaxReach_m, kMaxReach_m});
  structure.yaw_rad = in.Number("yaw_deg", 0.0, {-360.0, 360.0}) * kDeg;
  structure.is_absent = in.Flag("absent", false);
  structure.finish = ReadFinish(in, structure.finish);
  for (const YamlReader& part : in.At("parts").Items()) {
    structure.parts.push_back(ReadPart(part, structure.finish, folder));
  }
  if (structure.parts.empty()) in.At("parts").Refuse("must not be empty");
  return structure;
}

std::vector<Structure> ReadStructures(const YamlReader& in, const char* key,
                                      const std::filesystem::path& folder, std::set<std::string>& ids) {
  std::vector<Structure> structures;
  for (const YamlReader& item : in.Items(key)) {
    structures.push_back(ReadStructure(item, folder));
    if (!ids.insert(structures.back().id).second)
      item.At("id").Refuse("is given twice: " + structures.back().id);
  }
  return structures;
}

CameraModel ReadCamera(const YamlReader& in) {
  in.AllowKeys({"width_px", "height_px", "fx_px", "fy_px", "cx_px", "cy_px", "distortion", "exposure_s",
                "exposure_ev", "noise_levels", "blur_px", "vignetting", "jpeg_quality"});
  CameraModel camera;
  Intrinsics& lens = camera.intrinsics;
  lens.width_px = static_cast<int>(in.At("width_px").Number({16, 8192}));
  lens.height_px = static_cast<int>(in.At("height_px").Number({16, 8192}));
  lens.fx_px = in.At("fx_px").Number({1.0, 1e5});
  lens.fy_px = in.Number("fy_px", lens.fx_px, {1.0, 1e5});
  lens.cx_px = in.Number("cx_px", 0.5 * (lens.width_px - 1), {0.0, 8192.0});
  lens.cy_px = in.Number("cy_px", 0.5 * (lens.height_px - 1), {0.0, 8192.0});
  const auto distortion = in.Items("distortion");
  if (!distortion.empty() && distortion.size() != 5)
    in.At("distortion").Refuse("must be [k1, k2, p1, p2, k3]");
  for (std::size_t i = 0; i < distortion.size(); ++i) lens.distortion[i] = distortion[i].Number({-5.0, 5.0});
  camera.exposure_s = in.Number("exposure_s", camera.exposure_s, {0.0, 0.5});
  camera.exposure_ev = in.Number("exposure_ev", camera.exposure_ev, {-4.0, 4.0});
  camera.noise_levels = in.Number("noise_levels", camera.noise_levels, {0.0, 50.0});
  camera.blur_px = in.Number("blur_px", camera.blur_px, {0.0, 10.0});
  camera.vignetting = in.Number("vignetting", camera.vignetting, {0.0, 0.9});
  camera.jpeg_quality = static_cast<int>(in.Number("jpeg_quality", camera.jpeg_quality, {10, 100}));
  return camera;
}

VehicleEnvelope ReadVehicle(const YamlReader& in) {
  in.AllowKeys({"radius_m", "height_m", "safety_margin_m"});
  return {in.At("radius_m").Number({0.01, 20.0}), in.At("height_m").Number({0.01, 20.0}),
          in.At("safety_margin_m").Number({0.0, 20.0})};
}

MissionPlan ReadMission(const YamlReader& in, const std::vector<Structure>& buildings) {
  in.AllowKeys(
      {"wanted", "reference_m_per_px", "reference_rotation_cw_deg", "area_center", "overview_altitude_m"});
  MissionPlan mission;
  for (const YamlReader& id : in.At("wanted").Items()) {
    mission.wanted.push_back(id.Text());
    const bool known = std::any_of(buildings.begin(), buildings.end(),
                                   [&](const Structure& b) { return b.id == id.Text(); });
    if (!known) id.Refuse("there is no building '" + id.Text() + "'");
  }
  if (mission.wanted.empty()) in.At("wanted").Refuse("must not be empty");
  mission.reference_m_per_px = in.Number("reference_m_per_px", mission.reference_m_per_px, {1e-4, 100.0});
  mission.reference_rotation_cw_rad = in.Number("reference_rotation_cw_deg", 0.0, {-360.0, 360.0}) * kDeg;
  mission.area_center_m = in.Vector2("area_center", mission.area_center_m);
  mission.overview_altitude_m = in.Number("overview_altitude_m", mission.overview_altitude_m, {1.0, 500.0});
  return mission;
}

void ReadWeather(const YamlReader& in, World& world) {
  if (in.Has("sun")) {
    const YamlReader sun = in.At("sun");
    sun.AllowKeys({"yaw_deg", "elevation_deg", "strength"});
    world.sun.yaw_rad = sun.Number("yaw_deg", world.sun.yaw_rad / kDeg, {-360, 360}) * kDeg;
    world.sun.elevation_rad = sun.Number("elevation_deg", world.sun.elevation_rad / kDeg, {3, 90}) * kDeg;
    world.sun.strength = sun.Number("strength", world.sun.strength, {0.0, 2.0});
  }
  if (in.Has("sky")) {
    const YamlReader sky = in.At("sky");
    sky.AllowKeys({"cloud_ratio", "haze_m"});
    world.sky.cloud_ratio = sky.Number("cloud_ratio", world.sky.cloud_ratio, {0.0, 1.0});
    world.sky.haze_m = sky.Number("haze_m", world.sky.haze_m, {10.0, 1e6});
  }
  if (in.Has("wind")) {
    const YamlReader wind = in.At("wind");
    wind.AllowKeys({"mean_mps", "gust_std_mps"});
    world.wind.mean_mps = wind.Vector2("mean_mps", world.wind.mean_mps, {-30, 30});
    world.wind.gust_std_mps = wind.Number("gust_std_mps", 0.0, {0.0, 15.0});
  }
  if (in.Has("pose_noise")) {
    const YamlReader noise = in.At("pose_noise");
    noise.AllowKeys({"position_std_m", "orientation_std_deg"});
    world.pose_noise.position_std_m = noise.Number("position_std_m", 0.0, {0.0, 5.0});
    world.pose_noise.orientation_std_rad = noise.Number("orientation_std_deg", 0.0, {0.0, 20.0}) * kDeg;
  }
}

World ReadWorld(const YamlReader& in, const std::string& name, const std::filesystem::path& folder) {
  in.AllowKeys({"title", "geodetic_origin", "home", "sun", "sky", "ground", "wind", "pose_noise", "camera",
                "vehicle", "mission", "buildings", "obstacles", "scenery", "bushes"});
  World world;
  world.name = name;
  world.title = in.Text("title", name);
  if (in.Has("geodetic_origin")) {
    const YamlReader origin = in.At("geodetic_origin");
    origin.AllowKeys({"latitude_deg", "longitude_deg", "altitude_amsl_m"});
    world.origin = {origin.At("latitude_deg").Number({-89.0, 89.0}),
                    origin.At("longitude_deg").Number({-180.0, 180.0}),
                    origin.Number("altitude_amsl_m", 0.0, {-500.0, 9000.0})};
  }
  if (in.Has("home")) {
    in.At("home").AllowKeys({"yaw_deg"});
    world.home_yaw_rad = in.At("home").Number("yaw_deg", 0.0, {-360, 360}) * kDeg;
  }
  ReadWeather(in, world);
  if (in.Has("ground")) {
    in.At("ground").AllowKeys({"color", "pattern", "grain_m", "contrast"});
    world.ground = ReadFinish(in.At("ground"), world.ground);
  }
  world.camera = ReadCamera(in.At("camera"));
  world.vehicle = ReadVehicle(in.At("vehicle"));
  std::set<std::string> ids = {"", "ground", "bush"};
  world.buildings = ReadStructures(in, "buildings", folder, ids);
  world.obstacles = ReadStructures(in, "obstacles", folder, ids);
  world.scenery = ReadStructures(in, "scenery", folder, ids);
  for (const YamlReader& bush : in.Items("bushes")) {
    bush.AllowKeys({"position", "radius"});
    world.bushes.push_back(
        {bush.At("position").Vector2({-kMaxReach_m, kMaxReach_m}), bush.At("radius").Number({0.02, 50})});
  }
  world.mission = ReadMission(in.At("mission"), world.buildings);
  return world;
}

}  // namespace

Result<World> ParseWorld(const std::string& yaml, const std::string& name,
                         const std::filesystem::path& folder) {
  try {
    return ReadWorld(YamlReader(YAML::Load(yaml), ""), name, folder);
  } catch (const YamlProblem& problem) {
    return InvalidInput(name + ": " + problem.what());
  } catch (const YAML::Exception& problem) {
    return InvalidInput(name + ": not YAML: " + problem.what());
  }
}

Result<World> LoadWorld(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::ostringstream text;
  if (!(in && text << in.rdbuf())) return Error{Error::Code::kNotFound, file.string() + ": cannot be read"};
  Result<World> world = ParseWorld(text.str(), file.string(), file.parent_path());
  if (world.ok()) {
    if (world.value().title == file.string()) world.value().title = file.stem().string();
    world.value().name = file.stem().string();
  }
  return world;
}

}  // namespace soffit::sim
