#include "service/edge/files/survey.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "service/edge/files/bitmap.h"
#include "service/edge/files/file.h"

namespace soffit {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::json;

constexpr char kFormat[] = "soffit-survey/1";
constexpr std::uintmax_t kMaxSurveyBytes = 64U << 20U;

/// What is wrong with a document, and where; made into an `Error` at the border of this file.
struct Malformed {
  std::string message;
};

/// One value of the document and its place, for messages: "frames[3].position".
struct Node {
  const Json& json;
  std::string place;

  [[noreturn]] void Fail(const std::string& problem) const { throw Malformed{place + ": " + problem}; }

  Node At(const char* key) const {
    if (!json.is_object()) Fail("must be an object");
    const auto found = json.find(key);
    const std::string inner = place.empty() ? key : place + "." + key;
    if (found == json.end()) throw Malformed{inner + ": is missing"};
    return {*found, inner};
  }
  bool Has(const char* key) const { return json.is_object() && json.contains(key); }

  std::vector<Node> List(std::size_t least, std::size_t most) const {
    if (!json.is_array() || json.size() < least || json.size() > most) {
      Fail("must be a list of " +
           (least == most ? std::to_string(least) : std::to_string(least) + " to " + std::to_string(most)) +
           " values");
    }
    std::vector<Node> nodes;
    for (std::size_t i = 0; i < json.size(); ++i)
      nodes.push_back({json[i], place + "[" + std::to_string(i) + "]"});
    return nodes;
  }

  double Number(double low, double high) const {
    const double value = json.is_number() ? json.get<double>() : std::numeric_limits<double>::quiet_NaN();
    if (!(value >= low && value <= high)) {
      std::ostringstream text;
      text << "is " << json.dump().substr(0, 40) << ", must be a number from " << low << " to " << high;
      Fail(text.str());
    }
    return value;
  }

  int Integer(int low, int high) const {
    const double value = Number(low, high);
    if (value != std::floor(value)) Fail("must be a whole number");
    return static_cast<int>(value);
  }

  std::string Text() const {
    if (!json.is_string() || json.get<std::string>().empty()) Fail("must be a text");
    return json.get<std::string>();
  }

  bool Flag() const {
    if (!json.is_boolean()) Fail("must be true or false");
    return json.get<bool>();
  }

  /// A file below the survey's folder.
  std::string FileName() const {
    std::string name = Text();
    const fs::path path(name);
    const bool climbs =
        std::any_of(path.begin(), path.end(), [](const fs::path& part) { return part == ".."; });
    if (path.is_absolute() || climbs) Fail("\"" + name + "\" must lie inside the survey's folder");
    return name;
  }

  Eigen::VectorXd Vector(std::size_t size, double limit) const {
    Eigen::VectorXd vector(size);
    const std::vector<Node> numbers = List(size, size);
    for (std::size_t i = 0; i < size; ++i)
      vector[static_cast<Eigen::Index>(i)] = numbers[i].Number(-limit, limit);
    return vector;
  }
};

Intrinsics ReadCamera(const Node& camera) {
  Intrinsics k;
  k.width_px = camera.At("width").Integer(1, 100000);
  k.height_px = camera.At("height").Integer(1, 100000);
  k.fx_px = camera.At("fx").Number(1e-3, 1e7);
  k.fy_px = camera.At("fy").Number(1e-3, 1e7);
  k.cx_px = camera.At("cx").Number(-1e6, 1e6);
  k.cy_px = camera.At("cy").Number(-1e6, 1e6);
  if (camera.Has("distortion_model") && camera.At("distortion_model").Text() != "plumb_bob") {
    camera.At("distortion_model").Fail("only \"plumb_bob\" is known");
  }
  if (camera.Has("d")) {
    const std::vector<Node> d = camera.At("d").List(0, 5);
    for (std::size_t i = 0; i < d.size(); ++i) k.distortion[i] = d[i].Number(-1e3, 1e3);
  }
  return k;
}

VehicleEnvelope ReadVehicle(const Node& vehicle) {
  return {vehicle.At("radius_m").Number(0.01, 100.0), vehicle.At("height_m").Number(0.01, 100.0),
          vehicle.At("safety_margin_m").Number(0.0, 100.0)};
}

Capture ReadFrame(const Node& frame) {
  Capture capture;
  capture.name = frame.At("file").FileName();
  const std::string purpose = frame.At("purpose").Text();
  if (!PurposeFromString(purpose)) {
    frame.At("purpose").Fail("\"" + purpose + "\" is none of overview, top, wall, corridor");
  }
  capture.purpose = *PurposeFromString(purpose);
  if (frame.Has("stamp_s")) {
    capture.exposure_utc_ns = std::llround(frame.At("stamp_s").Number(-9e9, 9e9) * 1e9);
  }
  capture.map_from_camera.translation_m = frame.At("position").Vector(3, 1e7);
  const Eigen::Vector4d xyzw = frame.At("orientation").Vector(4, 2.0);
  if (!(std::abs(xyzw.norm() - 1.0) < 0.01)) {
    frame.At("orientation").Fail("must be a unit quaternion x, y, z, w");
  }
  capture.map_from_camera.rotation = Eigen::Quaterniond(xyzw[3], xyzw[0], xyzw[1], xyzw[2]).normalized();
  if (frame.Has("position_std_m")) capture.position_std_m = frame.At("position_std_m").Number(0.0, 1e4);
  if (frame.Has("orientation_std_rad"))
    capture.orientation_std_rad = frame.At("orientation_std_rad").Number(0.0, 4.0);
  capture.has_trusted_pose = !frame.Has("has_trusted_pose") || frame.At("has_trusted_pose").Flag();
  return capture;
}

/// On the ground beneath the first picture, unless that is near the file's own origin.
Eigen::Vector3d FindMapOrigin(const std::vector<Capture>& captures) {
  constexpr double kNear_m = 500.0;
  const Eigen::Vector3d& first = captures.front().map_from_camera.translation_m;
  if (first.head<2>().norm() <= kNear_m) return Eigen::Vector3d::Zero();
  return {std::floor(first.x()), std::floor(first.y()), 0.0};
}

Survey ReadDocument(const Node& root) {
  Survey survey;
  if (const std::string format = root.At("format").Text(); format != kFormat) {
    root.At("format").Fail("\"" + format + "\" is not \"" + kFormat + "\"");
  }
  survey.vehicle = ReadVehicle(root.At("vehicle"));
  survey.reference_file = root.At("reference").At("image").FileName();
  if (root.Has("colors")) {
    for (const Node& color : root.At("colors").List(1, 16)) survey.colors.push_back(color.Text());
  }
  if (root.Has("origin")) {
    const Node origin = root.At("origin");
    survey.origin = {origin.At("latitude_deg").Number(-90, 90), origin.At("longitude_deg").Number(-180, 180),
                     origin.At("altitude_amsl_m").Number(-1000, 10000)};
  }
  const Node camera = root.At("camera");
  const Intrinsics intrinsics = ReadCamera(camera);
  std::set<fs::path> files;  // A picture taken for two would confirm itself.
  for (const Node& frame : root.At("frames").List(1, 100000)) {
    Capture capture = ReadFrame(frame);
    if (!files.insert(fs::path(capture.name).lexically_normal()).second)
      frame.At("file").Fail("\"" + capture.name + "\" is listed before");
    capture.intrinsics = frame.Has("camera") ? ReadCamera(frame.At("camera")) : intrinsics;
    capture.capture_id = static_cast<std::uint32_t>(survey.captures.size() + 1);
    survey.captures.push_back(std::move(capture));
  }
  survey.map_origin_m = FindMapOrigin(survey.captures);
  for (Capture& capture : survey.captures) capture.map_from_camera.translation_m -= survey.map_origin_m;
  return survey;
}

Json ToJson(const Intrinsics& k) {
  return {{"width", k.width_px},
          {"height", k.height_px},
          {"fx", k.fx_px},
          {"fy", k.fy_px},
          {"cx", k.cx_px},
          {"cy", k.cy_px},
          {"distortion_model", "plumb_bob"},
          {"d", k.distortion}};
}

Json ToJson(const Capture& capture, const Eigen::Vector3d& map_origin_m) {
  const Eigen::Vector3d p = capture.map_from_camera.translation_m + map_origin_m;
  const Eigen::Quaterniond& q = capture.map_from_camera.rotation;
  return {{"file", capture.name},
          {"purpose", ToString(capture.purpose)},
          {"stamp_s", static_cast<double>(capture.exposure_utc_ns) * 1e-9},
          {"position", {p.x(), p.y(), p.z()}},
          {"orientation", {q.x(), q.y(), q.z(), q.w()}},
          {"position_std_m", capture.position_std_m},
          {"orientation_std_rad", capture.orientation_std_rad},
          {"has_trusted_pose", capture.has_trusted_pose},
          {"camera", ToJson(capture.intrinsics)}};
}

}  // namespace

Result<Survey> ReadSurvey(const fs::path& folder) {
  const fs::path file = folder / "survey.json";
  const Result<std::vector<std::uint8_t>> text = ReadFile(file, kMaxSurveyBytes);
  if (!text.ok()) return text.error();
  Survey survey;
  try {
    const Json json = Json::parse(text.value());
    survey = ReadDocument({json, ""});
  } catch (const Json::exception& problem) {
    return InvalidInput(file.string() + ": not JSON: " + problem.what());
  } catch (const Malformed& problem) {
    return InvalidInput(file.string() + ": " + problem.message);
  }
  for (const Capture& capture : survey.captures) {
    if (const Status status = CheckFile(folder / capture.name); !status.ok()) return status.error();
  }
  return survey;
}

Status WriteSurvey(const fs::path& folder, const Survey& survey) {
  SOFFIT_EXPECT(!survey.captures.empty());
  const VehicleEnvelope& v = survey.vehicle;
  Json json = {{"format", kFormat},
               {"camera", ToJson(survey.captures.front().intrinsics)},
               {"vehicle",
                {{"radius_m", v.radius_m}, {"height_m", v.height_m}, {"safety_margin_m", v.safety_margin_m}}},
               {"reference", {{"image", survey.reference_file}}},
               {"frames", Json::array()}};
  if (!survey.colors.empty()) json["colors"] = survey.colors;
  if (survey.origin) {
    json["origin"] = {{"latitude_deg", survey.origin->latitude_deg},
                      {"longitude_deg", survey.origin->longitude_deg},
                      {"altitude_amsl_m", survey.origin->altitude_amsl_m}};
  }
  for (const Capture& capture : survey.captures) {
    json["frames"].push_back(ToJson(capture, survey.map_origin_m));
    std::error_code ignored;
    if (capture.bytes.empty() || fs::exists(folder / capture.name, ignored)) continue;
    const std::string_view bytes(reinterpret_cast<const char*>(capture.bytes.data()), capture.bytes.size());
    if (Status status = WriteFile(folder / capture.name, bytes); !status.ok()) return status;
  }
  return WriteFile(folder / "survey.json", json.dump(1) + "\n");
}

Result<Reference> ReadReferenceFile(const fs::path& file) {
  const Result<cv::Mat1b> bitmap = ReadBitmapFile(file);
  if (!bitmap.ok()) return bitmap.error();
  Result<Reference> reference = ReadReference(bitmap.value());
  if (!reference.ok()) return InvalidInput(file.string() + ": " + reference.error().message);
  return reference;
}

}  // namespace soffit
