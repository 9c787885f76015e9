#include "service/edge/export/meshes.h"

#include <bit>
#include <cstdint>
#include <cstring>
#include <iomanip>
#include <locale>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

namespace soffit {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY and glTF are written as they lie in memory");

using Json = nlohmann::ordered_json;

std::ostringstream NumberStream() {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << std::setprecision(12);
  return text;
}

template <class T>
void Append(std::string& bytes, const T& value) {
  const auto* raw = reinterpret_cast<const char*>(&value);
  bytes.append(raw, sizeof(value));
}

std::string NameOf(const Solid& solid) { return "building_" + std::to_string(solid.footprint.object_id); }

Json ColorOf(const std::string& name) {
  static const std::map<std::string, Json> colors = {
      {"red", {0.75, 0.15, 0.12, 1.0}}, {"blue", {0.15, 0.3, 0.75, 1.0}}, {"yellow", {0.9, 0.75, 0.15, 1.0}}};
  const auto found = colors.find(name);
  return found != colors.end() ? found->second : Json({0.6, 0.6, 0.6, 1.0});
}

constexpr int kFloat = 5126;  // As glTF numbers them.
constexpr int kUnsignedInt = 5125;
constexpr int kArrayBuffer = 34962;
constexpr int kElementArrayBuffer = 34963;

/// One glTF asset with one buffer.
class Gltf {
 public:
  void Add(const Solid& solid) {
    const Eigen::Vector3d center = Eigen::Vector3d(solid.mesh.vertices_in_map_m.front());
    const int positions = AddPositions(solid.mesh, center);
    const int indices = AddIndices(solid.mesh);
    const auto number = static_cast<int>(json_["meshes"].size());
    json_["materials"].push_back({{"name", NameOf(solid)},
                                  {"pbrMetallicRoughness",
                                   {{"baseColorFactor", ColorOf(solid.footprint.color)},
                                    {"metallicFactor", 0.0},
                                    {"roughnessFactor", 0.9}}}});
    json_["meshes"].push_back({{"name", NameOf(solid)},
                               {"primitives", Json::array({{{"attributes", {{"POSITION", positions}}},
                                                            {"indices", indices},
                                                            {"material", number}}})}});
    json_["nodes"].push_back(
        {{"name", NameOf(solid)}, {"mesh", number}, {"translation", {center.x(), center.y(), center.z()}}});
  }

  std::string Finish() {
    Json children = Json::array();
    for (std::size_t i = 0; i < json_["nodes"].size(); ++i) children.push_back(i);
    // From z up to y up.
    json_["nodes"].push_back(
        {{"name", "map"}, {"rotation", {-std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5)}}, {"children", children}});
    json_["scene"] = 0;
    json_["scenes"] = Json::array({{{"name", "Soffit"}, {"nodes", {children.size()}}}});
    json_["buffers"] = Json::array({{{"byteLength", bytes_.size()}}});
    std::string text = json_.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string glb;
    Append(glb, std::uint32_t{0x46546C67});  // "glTF"
    Append(glb, std::uint32_t{2});
    Append(glb, static_cast<std::uint32_t>(12 + 8 + text.size() + 8 + bytes_.size()));
    AddChunk(glb, 0x4E4F534A, text);    // "JSON"
    AddChunk(glb, 0x004E4942, bytes_);  // "BIN"
    return glb;
  }

 private:
  int AddPositions(const Mesh& mesh, const Eigen::Vector3d& center) {
    const std::size_t begin = bytes_.size();
    Eigen::Vector3f low = Eigen::Vector3f::Constant(std::numeric_limits<float>::max());
    Eigen::Vector3f high = -low;
    for (const Eigen::Vector3d& vertex : mesh.vertices_in_map_m) {
      const Eigen::Vector3f p = (vertex - center).cast<float>();
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
      for (const float value : p) Append(bytes_, value);
    }
    Json accessor = {{"componentType", kFloat}, {"count", mesh.vertices_in_map_m.size()}, {"type", "VEC3"}};
    accessor["min"] = {low.x(), low.y(), low.z()};
    accessor["max"] = {high.x(), high.y(), high.z()};
    return AddAccessor(begin, kArrayBuffer, std::move(accessor));
  }

  int AddIndices(const Mesh& mesh) {
    const std::size_t begin = bytes_.size();
    for (const auto& triangle : mesh.triangles) {
      for (const int corner : triangle) Append(bytes_, static_cast<std::uint32_t>(corner));
    }
    return AddAccessor(
        begin, kElementArrayBuffer,
        {{"componentType", kUnsignedInt}, {"count", 3 * mesh.triangles.size()}, {"type", "SCALAR"}});
  }

  int AddAccessor(std::size_t begin, int target, Json accessor) {
    accessor["bufferView"] = json_["bufferViews"].size();
    json_["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", bytes_.size() - begin}, {"target", target}});
    json_["accessors"].push_back(std::move(accessor));
    return static_cast<int>(json_["accessors"].size()) - 1;
  }

  static void AddChunk(std::string& glb, std::uint32_t type, const std::string& content) {
    Append(glb, static_cast<std::uint32_t>(content.size()));
    Append(glb, type);
    glb += content;
  }

  Json json_ = {{"asset", {{"version", "2.0"}, {"generator", "Soffit"}}}};
  std::string bytes_;  ///< A whole number of words.
};

}  // namespace

std::string ToObj(const std::vector<Solid>& solids) {
  std::ostringstream text = NumberStream();
  text << "# ENU metres, closed 2-manifolds\n";
  std::size_t before = 1;
  for (const Solid& solid : solids) {
    text << "o " << NameOf(solid) << '\n';
    for (const Eigen::Vector3d& p : solid.mesh.vertices_in_map_m)
      text << "v " << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
    for (const auto& triangle : solid.mesh.triangles) {
      text << 'f';
      for (const int corner : triangle) text << ' ' << before + static_cast<std::size_t>(corner);
      text << '\n';
    }
    before += solid.mesh.vertices_in_map_m.size();
  }
  return text.str();
}

std::string ToPly(const std::vector<Solid>& solids) {
  std::string vertices;
  std::string faces;
  std::size_t vertex_count = 0;
  std::size_t face_count = 0;
  for (const Solid& solid : solids) {
    for (const Eigen::Vector3d& p : solid.mesh.vertices_in_map_m) {
      for (const double value : p) Append(vertices, value);
    }
    for (const auto& triangle : solid.mesh.triangles) {
      Append(faces, std::uint8_t{3});
      for (const int corner : triangle)
        Append(faces, static_cast<std::int32_t>(vertex_count + static_cast<std::size_t>(corner)));
      Append(faces, static_cast<std::int32_t>(solid.footprint.object_id));
    }
    vertex_count += solid.mesh.vertices_in_map_m.size();
    face_count += solid.mesh.triangles.size();
  }
  std::ostringstream header = NumberStream();
  header << "ply\nformat binary_little_endian 1.0\ncomment ENU metres\nelement vertex " << vertex_count
         << "\nproperty double x\nproperty double y\nproperty double z\nelement face " << face_count
         << "\nproperty list uchar int vertex_indices\nproperty int object_id\nend_header\n";
  return header.str() + vertices + faces;
}

Result<std::string> ToGlb(const std::vector<Solid>& solids) {
  if (solids.empty()) return Error{Error::Code::kNotFound, "the scene has no model yet"};
  Gltf gltf;
  for (const Solid& solid : solids) gltf.Add(solid);
  return gltf.Finish();
}

}  // namespace soffit
