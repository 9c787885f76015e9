#include "test/sim/world/city_gml.h"

#include <cpl_error.h>
#include <cpl_minixml.h>

#include <algorithm>
#include <memory>
#include <sstream>
#include <string_view>

namespace soffit::sim {
namespace {

struct FreeTree {
  void operator()(CPLXMLNode* node) const { CPLDestroyXMLNode(node); }
};
using Tree = std::unique_ptr<CPLXMLNode, FreeTree>;

/// GDAL's words about the last error, instead of a line on the terminal.
class QuietGdal {
 public:
  QuietGdal() {
    CPLErrorReset();
    CPLPushErrorHandler(CPLQuietErrorHandler);
  }
  ~QuietGdal() { CPLPopErrorHandler(); }
  QuietGdal(const QuietGdal&) = delete;
  QuietGdal& operator=(const QuietGdal&) = delete;
};

bool IsElement(const CPLXMLNode* node) { return node->eType == CXT_Element; }
std::string_view NameOf(const CPLXMLNode* node) { return node->pszValue; }

/// 1 to 3 for the elements that hold geometry of that level ("lod3MultiSurface"), else 0.
int LevelOf(const CPLXMLNode* node) {
  const std::string_view name = NameOf(node);
  return name.size() > 4 && name.starts_with("lod") && name[3] >= '1' && name[3] <= '3' ? name[3] - '0' : 0;
}

int FindFinestLevel(const CPLXMLNode* siblings) {
  int finest = 0;
  for (const CPLXMLNode* node = siblings; node; node = node->psNext) {
    if (IsElement(node)) finest = std::max({finest, LevelOf(node), FindFinestLevel(node->psChild)});
  }
  return finest;
}

/// Adds all numbers in the text beneath a node; false when something in it is none.
bool AddNumbers(const CPLXMLNode* parent, std::vector<double>& numbers) {
  for (const CPLXMLNode* node = parent->psChild; node; node = node->psNext) {
    if (IsElement(node) && !AddNumbers(node, numbers)) return false;
    if (node->eType != CXT_Text) continue;
    std::istringstream words(node->pszValue);
    for (double number = 0.0; words >> number;) numbers.push_back(number);
    if (!words.eof()) return false;
  }
  return true;
}

/// The corners of a gml:LinearRing, from gml:posList or gml:pos; none when it is not understood.
std::vector<Eigen::Vector3d> ReadRing(const CPLXMLNode* ring) {
  std::vector<double> numbers;
  if (!AddNumbers(ring, numbers) || numbers.size() < 12 || numbers.size() % 3 != 0) return {};
  std::vector<Eigen::Vector3d> corners;
  for (std::size_t i = 0; i < numbers.size(); i += 3)
    corners.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
  if (corners.front() != corners.back()) return {};
  corners.pop_back();
  return corners;
}

class Reader {
 public:
  explicit Reader(int level) : level_(level) {}

  /// Everything beneath `parent`, which is what its geometry belongs to.
  void ReadObject(CPLXMLNode* parent) {
    for (CPLXMLNode* node = parent->psChild; node && problem_.empty(); node = node->psNext) {
      if (!IsElement(node)) continue;
      if (LevelOf(node) == 0)
        ReadObject(node);
      else if (LevelOf(node) == level_)
        ReadGeometry(node, *parent);
    }
  }

  const std::string& problem() const { return problem_; }
  std::vector<CitySurface> Take() { return std::move(surfaces_); }

 private:
  void ReadGeometry(CPLXMLNode* parent, const CPLXMLNode& object) {
    for (CPLXMLNode* node = parent->psChild; node && problem_.empty(); node = node->psNext) {
      if (!IsElement(node)) continue;
      if (NameOf(node) == "Polygon")
        ReadPolygon(node, object);
      else
        ReadGeometry(node, object);
    }
  }

  void ReadPolygon(const CPLXMLNode* polygon, const CPLXMLNode& object) {
    CitySurface surface{object.pszValue, {}, {}};
    for (const CPLXMLNode* named : {&object, polygon}) {
      if (const char* id = CPLGetXMLValue(named, "id", nullptr)) surface.ids.emplace_back(id);
    }
    for (const CPLXMLNode* side = polygon->psChild; side; side = side->psNext) {
      if (!IsElement(side) || (NameOf(side) != "exterior" && NameOf(side) != "interior")) continue;
      const CPLXMLNode* ring = CPLGetXMLNode(const_cast<CPLXMLNode*>(side), "LinearRing");
      surface.rings.push_back(ring ? ReadRing(ring) : std::vector<Eigen::Vector3d>());
    }
    const bool is_understood =
        !surface.rings.empty() && std::none_of(surface.rings.begin(), surface.rings.end(),
                                               [](const auto& ring) { return ring.empty(); });
    if (!is_understood) {
      problem_ = "polygon " + (surface.ids.empty() ? "without id" : "'" + surface.ids.back() + "'") +
                 " of a " + surface.kind + " has an outline that is no closed ring of corners x y z";
    }
    surfaces_.push_back(std::move(surface));
  }

  int level_;
  std::vector<CitySurface> surfaces_;
  std::string problem_;
};

}  // namespace

Result<std::vector<CitySurface>> ReadCityGml(const std::filesystem::path& file) {
  const QuietGdal quiet;
  const Tree tree(CPLParseXMLFile(file.c_str()));
  if (!tree) return InvalidInput(file.string() + ": cannot be read as XML: " + CPLGetLastErrorMsg());
  CPLStripXMLNamespace(tree.get(), nullptr, TRUE);
  CPLXMLNode* model = CPLSearchXMLNode(tree.get(), "=CityModel");
  if (!model) return InvalidInput(file.string() + ": is no CityGML: it has no CityModel");
  const int level = FindFinestLevel(model->psChild);
  if (level == 0) return InvalidInput(file.string() + ": has no geometry in level of detail 1, 2 or 3");
  Reader reader(level);
  reader.ReadObject(model);
  if (!reader.problem().empty()) return InvalidInput(file.string() + ": " + reader.problem());
  std::vector<CitySurface> surfaces = reader.Take();
  if (surfaces.empty())
    return InvalidInput(file.string() + ": has no polygons in level of detail " + std::to_string(level));
  return surfaces;
}

}  // namespace soffit::sim
