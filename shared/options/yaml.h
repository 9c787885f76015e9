#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "shared/options/options.h"
#include "shared/result/result.h"

namespace YAML {
class Node;
}

namespace soffit {
namespace options_internal {

/// One mapping of a YAML document, and the first thing that is wrong in it. Every key that is asked for is
/// known; `Finish` refuses the others.
class YamlMapping {
 public:
  /// The whole document; an empty text is an empty mapping.
  static YamlMapping Parse(const std::string& text, const std::string& source);

  template <class T>
  void operator()(const char* name, T& value, const OptionInfo& info) {
    Read(name, value, info);
  }

  template <class T>
  void operator()(const char* name, T& nested) {
    if constexpr (IsVector<T>::value) {
      if (!Has(name)) return;
      nested.clear();
      for (YamlMapping& element : EnterList(name)) {
        typename T::value_type value;
        VisitNested(element, value);
        nested.push_back(std::move(value));
      }
    } else {
      YamlMapping inner = Enter(name);
      VisitNested(inner, nested);
    }
  }

  void Finish();
  const std::string& problem() const { return problem_; }

 private:
  template <class T>
  void VisitNested(YamlMapping& mapping, T& nested) {
    T::Visit(nested, mapping);
    mapping.Finish();
    Fail(mapping.problem());
  }

  bool Has(const char* name);
  YamlMapping Enter(const char* name);
  std::vector<YamlMapping> EnterList(const char* name);
  void Read(const char* name, double& value, const OptionInfo& info);
  void Read(const char* name, int& value, const OptionInfo& info);
  void Read(const char* name, bool& value, const OptionInfo& info);
  void Read(const char* name, std::string& value, const OptionInfo& info);
  void Read(const char* name, std::vector<double>& value, const OptionInfo& info);
  void Read(const char* name, std::vector<int>& value, const OptionInfo& info);
  void Read(const char* name, std::vector<bool>& value, const OptionInfo& info);
  void Read(const char* name, std::vector<std::string>& value, const OptionInfo& info);

  template <class T>
  void ReadScalar(const char* name, T& value, const OptionInfo& info);
  template <class T>
  void ReadList(const char* name, std::vector<T>& value, const OptionInfo& info);
  std::string Where(const YAML::Node& node, const std::string& name) const;
  void Fail(const std::string& problem);

  std::string source_;
  std::string path_;
  std::shared_ptr<const YAML::Node>
      node_;  ///< Null: the mapping is not there, every field keeps its default.
  std::vector<std::string> known_;
  std::string problem_;
};

/// Writes a mapping in YAML, one commented line per field.
class YamlWriter {
 public:
  explicit YamlWriter(int indent) : indent_(indent) {}

  template <class T>
  void operator()(const char* name, const T& value, const OptionInfo& info) {
    if constexpr (IsVector<T>::value) {
      std::string list;
      for (const auto& element : value) list += (list.empty() ? "" : ", ") + Format(element);
      WriteLine(name, "[" + list + "]", HasBounds<typename T::value_type>() ? info : WithoutBounds(info));
    } else {
      WriteLine(name, Format(value), HasBounds<T>() ? info : WithoutBounds(info));
    }
  }

  template <class T>
  void operator()(const char* name, const T& nested) {
    if constexpr (IsVector<T>::value) {
      OpenBlock(name, nested.empty() ? " []" : "");
      for (const auto& element : nested) {
        YamlWriter inner(indent_ + 2);
        T::value_type::Visit(element, inner);
        AppendElement(inner.text());
      }
    } else {
      OpenBlock(name, "");
      YamlWriter inner(indent_ + 1);
      T::Visit(nested, inner);
      text_ += inner.text();
    }
  }

  const std::string& text() const { return text_; }

 private:
  template <class T>
  static constexpr bool HasBounds() {
    return std::is_arithmetic_v<T> && !std::is_same_v<T, bool>;
  }
  static OptionInfo WithoutBounds(OptionInfo info) {
    info.low = -std::numeric_limits<double>::infinity();
    info.high = std::numeric_limits<double>::infinity();
    return info;
  }
  static std::string Format(double value);
  static std::string Format(int value);
  static std::string Format(bool value);
  static std::string Format(const std::string& value);
  void WriteLine(const char* name, const std::string& value, const OptionInfo& info);
  void OpenBlock(const char* name, const std::string& rest);
  void AppendElement(const std::string& block);

  int indent_;
  std::string text_;
};

/// The whole file as text, or why it cannot be read.
Result<std::string> ReadTextFile(const std::string& path);

}  // namespace options_internal

/// Reads options from YAML text. A field that is not named keeps its default; an unknown or repeated key, a
/// value of another kind, a NaN and a number out of its bounds are errors that name source, line and key, and
/// what is allowed.
///
/// @param source  Name of the text in errors, as a rule the file's path.
template <class Options>
Result<Options> ReadOptions(const std::string& text, const std::string& source) {
  Options options;
  auto mapping = options_internal::YamlMapping::Parse(text, source);
  Options::Visit(options, mapping);
  mapping.Finish();
  if (!mapping.problem().empty()) return InvalidInput(mapping.problem());
  return options;
}

template <class Options>
Result<Options> ReadOptionsFile(const std::string& path) {
  const Result<std::string> text = options_internal::ReadTextFile(path);
  if (!text.ok()) return text.error();
  return ReadOptions<Options>(text.value(), path);
}

/// The options as YAML that `ReadOptions` takes, each field with its unit, bounds and help as a comment.
template <class Options>
std::string DescribeOptions(const Options& options = {}) {
  options_internal::YamlWriter writer(0);
  Options::Visit(options, writer);
  return writer.text();
}

}  // namespace soffit
