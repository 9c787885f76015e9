#include "shared/options/yaml.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>

namespace soffit::options_internal {
namespace {

template <class T>
std::string FormatNumber(T value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), end.ptr};
}

std::string DescribeBounds(const OptionInfo& info) {
  const bool has_low = std::isfinite(info.low);
  const bool has_high = std::isfinite(info.high);
  std::string text;
  if (has_low && has_high) {
    text = FormatNumber(info.low) + " to " + FormatNumber(info.high);
  } else if (has_low) {
    text = "at least " + FormatNumber(info.low);
  } else if (has_high) {
    text = "at most " + FormatNumber(info.high);
  }
  if (!text.empty() && !info.unit.empty()) text += " ";
  return text.empty() ? info.unit : text + info.unit;
}

template <class T>
const char* KindOf() {
  if constexpr (std::is_same_v<T, double>) return "a number";
  if constexpr (std::is_same_v<T, int>) return "a whole number";
  if constexpr (std::is_same_v<T, bool>) return "true or false";
  return "a text";
}

/// What is wrong with a scalar, in words; empty when it was taken into `value`.
template <class T>
std::string TakeScalar(const YAML::Node& node, T& value, const OptionInfo& info) {
  const std::string bounds = DescribeBounds(info);
  const std::string allowed = std::string(KindOf<T>()) + (bounds.empty() ? "" : ", " + bounds);
  T read{};
  if (!node.IsScalar()) return std::string("must be ") + allowed;
  if (!YAML::convert<T>::decode(node, read)) return "is '" + node.Scalar() + "', must be " + allowed;
  if constexpr (std::is_same_v<T, double> || std::is_same_v<T, int>) {
    const double number = static_cast<double>(read);
    if (!std::isfinite(number) || number < info.low || number > info.high) {
      return "is " + node.Scalar() + ", must be " + allowed;
    }
  }
  value = std::move(read);
  return {};
}

}  // namespace

YamlMapping YamlMapping::Parse(const std::string& text, const std::string& source) {
  YamlMapping mapping;
  mapping.source_ = source;
  try {
    const YAML::Node document = YAML::Load(text);
    if (document.IsNull()) return mapping;
    if (!document.IsMap()) {
      mapping.Fail(source + ": must be a list of 'key: value' lines");
      return mapping;
    }
    mapping.node_ = std::make_shared<const YAML::Node>(document);
  } catch (const YAML::Exception& broken) {
    mapping.Fail(source + ":" + std::to_string(broken.mark.line + 1) + ": not YAML: " + broken.msg);
  }
  return mapping;
}

void YamlMapping::Finish() {
  if (!node_) return;
  std::vector<std::string> seen;
  for (const auto& entry : *node_) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "?";
    if (std::find(known_.begin(), known_.end(), key) == known_.end()) {
      std::string names;
      for (const std::string& name : known_) names += (names.empty() ? "" : ", ") + name;
      Fail(Where(entry.first, key) + ": unknown key; known here: " + names);
    }
    if (std::find(seen.begin(), seen.end(), key) != seen.end()) {
      Fail(Where(entry.first, key) + ": given twice");
    }
    seen.push_back(key);
  }
}

bool YamlMapping::Has(const char* name) {
  known_.emplace_back(name);
  return node_ && (*node_)[name].IsDefined() && !(*node_)[name].IsNull();
}

YamlMapping YamlMapping::Enter(const char* name) {
  YamlMapping inner;
  inner.source_ = source_;
  inner.path_ = path_ + name + ".";
  if (!Has(name)) return inner;
  const YAML::Node node = (*node_)[name];
  if (node.IsMap()) {
    inner.node_ = std::make_shared<const YAML::Node>(node);
  } else {
    Fail(Where(node, name) + ": must be a block of 'key: value' lines");
  }
  return inner;
}

std::vector<YamlMapping> YamlMapping::EnterList(const char* name) {
  std::vector<YamlMapping> elements;
  const YAML::Node node = (*node_)[name];
  if (!node.IsSequence()) {
    Fail(Where(node, name) + ": must be a list");
    return elements;
  }
  for (std::size_t i = 0; i < node.size(); ++i) {
    const std::string element_name = std::string(name) + "[" + std::to_string(i) + "]";
    if (!node[i].IsMap()) {
      Fail(Where(node[i], element_name) + ": must be a block of 'key: value' lines");
      continue;
    }
    YamlMapping inner;
    inner.source_ = source_;
    inner.path_ = path_ + element_name + ".";
    inner.node_ = std::make_shared<const YAML::Node>(node[i]);
    elements.push_back(std::move(inner));
  }
  return elements;
}

template <class T>
void YamlMapping::ReadScalar(const char* name, T& value, const OptionInfo& info) {
  if (!Has(name)) return;
  const YAML::Node node = (*node_)[name];
  const std::string problem = TakeScalar(node, value, info);
  if (!problem.empty()) Fail(Where(node, name) + ": " + problem);
}

template <class T>
void YamlMapping::ReadList(const char* name, std::vector<T>& value, const OptionInfo& info) {
  if (!Has(name)) return;
  const YAML::Node node = (*node_)[name];
  if (!node.IsSequence()) return Fail(Where(node, name) + ": must be a list, as in [1, 2]");
  std::vector<T> read;
  for (std::size_t i = 0; i < node.size(); ++i) {
    T element{};
    const std::string problem = TakeScalar(node[i], element, info);
    if (!problem.empty()) {
      return Fail(Where(node[i], std::string(name) + "[" + std::to_string(i) + "]") + ": " + problem);
    }
    read.push_back(std::move(element));
  }
  value = std::move(read);
}

void YamlMapping::Read(const char* name, double& value, const OptionInfo& info) {
  ReadScalar(name, value, info);
}
void YamlMapping::Read(const char* name, int& value, const OptionInfo& info) {
  ReadScalar(name, value, info);
}
void YamlMapping::Read(const char* name, bool& value, const OptionInfo& info) {
  ReadScalar(name, value, info);
}
void YamlMapping::Read(const char* name, std::string& value, const OptionInfo& info) {
  ReadScalar(name, value, info);
}
void YamlMapping::Read(const char* name, std::vector<double>& value, const OptionInfo& info) {
  ReadList(name, value, info);
}
void YamlMapping::Read(const char* name, std::vector<int>& value, const OptionInfo& info) {
  ReadList(name, value, info);
}
void YamlMapping::Read(const char* name, std::vector<bool>& value, const OptionInfo& info) {
  ReadList(name, value, info);
}
void YamlMapping::Read(const char* name, std::vector<std::string>& value, const OptionInfo& info) {
  ReadList(name, value, info);
}

std::string YamlMapping::Where(const YAML::Node& node, const std::string& name) const {
  return source_ + ":" + std::to_string(node.Mark().line + 1) + ": " + path_ + name;
}

void YamlMapping::Fail(const std::string& problem) {
  if (problem_.empty()) problem_ = problem;
}

std::string YamlWriter::Format(double value) {
  if (!std::isfinite(value)) return std::isnan(value) ? ".nan" : (value > 0.0 ? ".inf" : "-.inf");
  return FormatNumber(value);
}
std::string YamlWriter::Format(int value) { return FormatNumber(value); }
std::string YamlWriter::Format(bool value) { return value ? "true" : "false"; }
std::string YamlWriter::Format(const std::string& value) {
  YAML::Emitter emitter;
  emitter << YAML::DoubleQuoted << value;
  return emitter.c_str();
}

void YamlWriter::WriteLine(const char* name, const std::string& value, const OptionInfo& info) {
  const std::string indent(static_cast<std::size_t>(2 * indent_), ' ');
  std::string comment = info.help;
  const std::string bounds = DescribeBounds(info);
  if (!bounds.empty()) comment += (comment.empty() ? "" : ": ") + bounds;
  text_ += indent + name + ": " + value + (comment.empty() ? "" : "  # " + comment) + "\n";
}

void YamlWriter::OpenBlock(const char* name, const std::string& rest) {
  text_ += std::string(static_cast<std::size_t>(2 * indent_), ' ') + name + ":" + rest + "\n";
}

void YamlWriter::AppendElement(const std::string& block) {
  std::string element = block;
  if (element.empty()) element = std::string(static_cast<std::size_t>(2 * (indent_ + 1)), ' ') + "  {}\n";
  element[static_cast<std::size_t>(2 * (indent_ + 1))] = '-';
  text_ += element;
}

Result<std::string> ReadTextFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file)
    return Error{Error::Code::kNotFound, path + ": cannot be opened; does it exist, and may it be read?"};
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (file.bad()) return Error{Error::Code::kUnavailable, path + ": cannot be read"};
  return text;
}

}  // namespace soffit::options_internal
