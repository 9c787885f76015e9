#pragma once

#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>

namespace soffit {

/// Bounds of a number, both included, and what the option is for. NaN is outside every bound.
struct OptionInfo {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  std::string unit;
  std::string help;
};

/// An options struct lists its fields once, in a static `Visit(self, field)`:
///
///     template <class Self, class Visitor>
///     static void Visit(Self& self, Visitor&& field) {
///       field("min_area_m2", self.min_area_m2, OptionInfo{0.0, 1e6, "m2", "Smaller blobs are dropped"});
///       field("mask", self.mask);                      // a nested options struct
///     }
///
/// YAML, `--help`, validation and the reference page are read from it. A field is a double, int, bool,
/// std::string, a vector of these, or (given without OptionInfo) a nested options struct or a vector of such.
/// The bounds of a vector hold for each of its elements.
namespace options_internal {

template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};

struct Validator {
  std::string path;
  std::string problem;

  template <class T>
  void operator()(const std::string& name, const T& value, const OptionInfo& info) {
    if constexpr (IsVector<T>::value) {
      for (std::size_t i = 0; i < value.size(); ++i)
        (*this)(name + "[" + std::to_string(i) + "]", value[i], info);
    } else if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) {
      const double number = static_cast<double>(value);
      if (problem.empty() && !(number >= info.low && number <= info.high)) {
        std::ostringstream text;
        text << path << name << " is " << number << (info.unit.empty() ? "" : " ") << info.unit
             << ", must be from " << info.low << " to " << info.high;
        problem = text.str();
      }
    }
  }
  template <class T>
  void operator()(const std::string& name, const T& nested) {
    if constexpr (IsVector<T>::value) {
      for (std::size_t i = 0; i < nested.size(); ++i)
        (*this)(name + "[" + std::to_string(i) + "]", nested[i]);
    } else {
      Validator inner{path + name + ".", {}};
      T::Visit(nested, inner);
      if (problem.empty()) problem = inner.problem;
    }
  }
};

}  // namespace options_internal

/// The first field that is out of its bounds, in words; empty when all are well.
template <class Options>
std::string FindOptionProblem(const Options& options) {
  options_internal::Validator validator;
  Options::Visit(options, validator);
  return validator.problem;
}

template <class Options>
bool IsValidOptions(const Options& options) {
  return FindOptionProblem(options).empty();
}

}  // namespace soffit
