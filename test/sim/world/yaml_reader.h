#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace soffit::sim {

/// Something in a YAML file that cannot be used: "line 12: buildings[0].color: ...".
class YamlProblem : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Bounds {
  double low = -1e6;
  double high = 1e6;
};

/// One node of a YAML file that knows where it stands. Everything throws YamlProblem.
class YamlReader {
 public:
  YamlReader(const YAML::Node& node, std::string path);

  void AllowKeys(
      std::initializer_list<const char*> keys) const;  ///< A mapping with no other keys than these.
  bool Has(const char* key) const;
  bool IsSequence() const;
  bool IsMap() const;
  YamlReader At(const char* key) const;                  ///< Must be there.
  std::vector<YamlReader> Items() const;                 ///< Of a sequence.
  std::vector<YamlReader> Items(const char* key) const;  ///< Of a sequence that may be missing.

  double Number(Bounds bounds = {}) const;
  std::string Text() const;
  bool Flag() const;
  Eigen::Vector2d Vector2(Bounds bounds = {}) const;
  Eigen::Vector3d Vector3(Bounds bounds = {}) const;

  double Number(const char* key, double otherwise, Bounds bounds = {}) const;
  std::string Text(const char* key, const std::string& otherwise) const;
  bool Flag(const char* key, bool otherwise) const;
  Eigen::Vector2d Vector2(const char* key, const Eigen::Vector2d& otherwise, Bounds bounds = {}) const;

  [[noreturn]] void Refuse(const std::string& why) const;

 private:
  YAML::Node node_;
  std::string path_;
};

}  // namespace soffit::sim
