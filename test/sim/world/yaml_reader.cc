#include "test/sim/world/yaml_reader.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

namespace soffit::sim {

YamlReader::YamlReader(const YAML::Node& node, std::string path) : node_(node), path_(std::move(path)) {}

void YamlReader::Refuse(const std::string& why) const {
  std::ostringstream text;
  if (node_.Mark().line >= 0) text << "line " << node_.Mark().line + 1 << ": ";
  text << (path_.empty() ? "the file" : path_) << ": " << why;
  throw YamlProblem(text.str());
}

void YamlReader::AllowKeys(std::initializer_list<const char*> keys) const {
  if (!node_.IsMap()) Refuse("must be a mapping (key: value)");
  std::vector<std::string> seen;
  for (const auto& entry : node_) {
    const YamlReader item(entry.first, path_);
    const std::string key = item.Text();
    if (std::find(seen.begin(), seen.end(), key) != seen.end())
      item.Refuse("key '" + key + "' is given twice");
    seen.push_back(key);
    if (std::any_of(keys.begin(), keys.end(), [&](const char* known) { return key == known; })) continue;
    std::string known_keys;
    for (const char* known : keys) known_keys += (known_keys.empty() ? "" : ", ") + std::string(known);
    item.Refuse("unknown key '" + key + "'; known are: " + known_keys);
  }
}

bool YamlReader::Has(const char* key) const { return node_.IsMap() && node_[key].IsDefined(); }
bool YamlReader::IsSequence() const { return node_.IsSequence(); }
bool YamlReader::IsMap() const { return node_.IsMap(); }

YamlReader YamlReader::At(const char* key) const {
  if (!Has(key)) Refuse(std::string("needs the key '") + key + "'");
  return {node_[key], path_.empty() ? key : path_ + "." + key};
}

std::vector<YamlReader> YamlReader::Items() const {
  if (!node_.IsSequence()) Refuse("must be a list");
  std::vector<YamlReader> items;
  for (std::size_t i = 0; i < node_.size(); ++i)
    items.emplace_back(node_[i], path_ + "[" + std::to_string(i) + "]");
  return items;
}

std::vector<YamlReader> YamlReader::Items(const char* key) const {
  return Has(key) ? At(key).Items() : std::vector<YamlReader>{};
}

double YamlReader::Number(Bounds bounds) const {
  double value = 0.0;
  if (!node_.IsScalar() || !YAML::convert<double>::decode(node_, value)) Refuse("must be a number");
  if (!(value >= bounds.low && value <= bounds.high)) {
    std::ostringstream text;
    text << "is " << value << ", must be from " << bounds.low << " to " << bounds.high;
    Refuse(text.str());
  }
  return value;
}

std::string YamlReader::Text() const {
  if (!node_.IsScalar()) Refuse("must be a word");
  return node_.Scalar();
}

bool YamlReader::Flag() const {
  bool value = false;
  if (!node_.IsScalar() || !YAML::convert<bool>::decode(node_, value)) Refuse("must be true or false");
  return value;
}

Eigen::Vector2d YamlReader::Vector2(Bounds bounds) const {
  const auto items = Items();
  if (items.size() != 2) Refuse("must be two numbers, [x, y]");
  return {items[0].Number(bounds), items[1].Number(bounds)};
}

Eigen::Vector3d YamlReader::Vector3(Bounds bounds) const {
  const auto items = Items();
  if (items.size() != 3) Refuse("must be three numbers");
  return {items[0].Number(bounds), items[1].Number(bounds), items[2].Number(bounds)};
}

double YamlReader::Number(const char* key, double otherwise, Bounds bounds) const {
  return Has(key) ? At(key).Number(bounds) : otherwise;
}
std::string YamlReader::Text(const char* key, const std::string& otherwise) const {
  return Has(key) ? At(key).Text() : otherwise;
}
bool YamlReader::Flag(const char* key, bool otherwise) const { return Has(key) ? At(key).Flag() : otherwise; }
Eigen::Vector2d YamlReader::Vector2(const char* key, const Eigen::Vector2d& otherwise, Bounds bounds) const {
  return Has(key) ? At(key).Vector2(bounds) : otherwise;
}

}  // namespace soffit::sim
