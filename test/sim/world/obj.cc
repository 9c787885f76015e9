#include "test/sim/world/obj.h"

#include <fstream>
#include <sstream>

namespace soffit::sim {
namespace {

/// "12", "12/3", "12/3/4", "-1": an index from 0 into `count` vertices, or -1.
int ParseIndex(const std::string& word, std::size_t count) {
  char* end = nullptr;
  const long index = std::strtol(word.c_str(), &end, 10);
  if (end == word.c_str() || (*end != '\0' && *end != '/')) return -1;
  const long size = static_cast<long>(count);
  const long from_zero = index > 0 ? index - 1 : size + index;
  return from_zero >= 0 && from_zero < size ? static_cast<int>(from_zero) : -1;
}

bool ReadVertex(std::istringstream& words, Mesh& mesh) {
  Eigen::Vector3d vertex;
  if (!(words >> vertex.x() >> vertex.y() >> vertex.z()) || !vertex.allFinite()) return false;
  mesh.vertices_m.push_back(vertex);
  return true;
}

bool ReadFace(std::istringstream& words, Mesh& mesh) {
  std::vector<int> corners;
  for (std::string word; words >> word;) {
    corners.push_back(ParseIndex(word, mesh.vertices_m.size()));
    if (corners.back() < 0) return false;
  }
  if (corners.size() < 3) return false;
  for (std::size_t i = 2; i < corners.size(); ++i)
    mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
  return true;
}

}  // namespace

Result<Mesh> ReadObj(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) return Error{Error::Code::kNotFound, file.string() + ": cannot be read"};
  Mesh mesh;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    const bool is_well = kind == "v" ? ReadVertex(words, mesh) : kind == "f" ? ReadFace(words, mesh) : true;
    if (!is_well)
      return InvalidInput(file.string() + ": line " + std::to_string(number) + ": not understood: " + line);
  }
  if (mesh.triangles.empty()) return InvalidInput(file.string() + ": has no faces");
  return mesh;
}

}  // namespace soffit::sim
