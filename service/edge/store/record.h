#pragma once

// How values become JSON text and text becomes values. Each type names its fields once, in Record(), and a
// RecordWriter or a RecordReader is led through it:
//
//   template <class Io>
//   void Record(Io& io, RecordOf<Io, PictureResult>& v) {
//     io("capture_id", v.capture_id);
//     io("problem", v.problem);
//   }

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "shared/result/result.h"

namespace soffit {

/// Every enumeration needs its last enumerator; they count from zero.
template <class Enum>
struct UpTo {
  Enum last;
};
template <class Enum>
UpTo(Enum) -> UpTo<Enum>;

namespace record_internal {

template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};
template <class T>
struct IsArray : std::false_type {};
template <class T, std::size_t n>
struct IsArray<std::array<T, n>> : std::true_type {};
template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};
template <class T>
concept FixedVector = requires {
  requires T::SizeAtCompileTime >
  0;
  requires std::is_base_of_v<Eigen::MatrixBase<T>, T>;
};

}  // namespace record_internal

class RecordWriter {
 public:
  static constexpr bool kReads = false;
  template <class T>
  using Value = const T;

  template <class V, class... Rules>
  void operator()(const char* name, const V& value, const Rules&...) {
    static_assert(!std::is_enum_v<V> || sizeof...(Rules) == 1, "an enumeration needs its last enumerator");
    json_[name] = ToJson(value);
  }
  nlohmann::json TakeJson() { return std::move(json_); }

 private:
  template <class V>
  static nlohmann::json ToJson(const V& value) {
    using namespace record_internal;
    if constexpr (std::is_enum_v<V>) {
      return static_cast<int>(value);
    } else if constexpr (std::is_floating_point_v<V>) {
      if (std::isfinite(value)) return value;
      return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
    } else if constexpr (std::is_arithmetic_v<V> || std::is_same_v<V, std::string>) {
      return value;
    } else if constexpr (IsOptional<V>::value) {
      return value ? ToJson(*value) : nlohmann::json();
    } else if constexpr (std::is_same_v<V, Eigen::Quaterniond>) {
      return ToJson(Eigen::Vector4d(value.coeffs()));
    } else if constexpr (FixedVector<V> || IsVector<V>::value || IsArray<V>::value) {
      nlohmann::json list = nlohmann::json::array();
      for (const auto& item : value) list.push_back(ToJson(item));
      return list;
    } else {
      RecordWriter io;
      Record(io, value);
      return io.TakeJson();
    }
  }

  nlohmann::json json_ = nlohmann::json::object();
};

/// Takes a value out of JSON. Throws Malformed at the first thing that is missing or is not what it must be.
class RecordReader {
 public:
  static constexpr bool kReads = true;
  template <class T>
  using Value = T;

  struct Malformed {
    std::string message;
  };

  RecordReader(const nlohmann::json& json, std::string place) : json_(json), place_(std::move(place)) {
    Require(json_.is_object(), "an object of JSON", place_.empty() ? "it" : place_);
  }

  template <class V, class... Rules>
  void operator()(const char* name, V& value, const Rules&... rules) {
    const auto found = json_.find(name);
    const std::string place = place_.empty() ? name : place_ + "." + name;
    Require(found != json_.end(), "there", place);
    Take(*found, value, place);
    (Keep(value, rules, place), ...);
  }

 private:
  static void Require(bool condition, const char* what, const std::string& place) {
    if (!condition) throw Malformed{place + " must be " + what};
  }
  template <class Enum>
  static void Keep(Enum value, const UpTo<Enum>& rule, const std::string& place) {
    Require(value >= Enum{} && value <= rule.last, "a known value", place);
  }

  template <class V>
  static void Take(const nlohmann::json& json, V& value, const std::string& place) {
    using namespace record_internal;
    if constexpr (std::is_enum_v<V>) {
      Require(json.is_number_integer(), "a whole number", place);
      value = static_cast<V>(json.get<int>());
    } else if constexpr (std::is_same_v<V, bool>) {
      Require(json.is_boolean(), "true or false", place);
      value = json.get<bool>();
    } else if constexpr (std::is_floating_point_v<V>) {
      value = Number(json, place);
    } else if constexpr (std::is_integral_v<V>) {
      Require(json.is_number_integer(), "a whole number", place);
      value = json.get<V>();
    } else if constexpr (std::is_same_v<V, std::string>) {
      Require(json.is_string(), "a text", place);
      value = json.get<std::string>();
    } else if constexpr (IsOptional<V>::value) {
      value.reset();
      if (!json.is_null()) Take(json, value.emplace(), place);
    } else if constexpr (std::is_same_v<V, Eigen::Quaterniond>) {
      Eigen::Vector4d xyzw;
      Take(json, xyzw, place);
      value = Eigen::Quaterniond(xyzw.w(), xyzw.x(), xyzw.y(), xyzw.z());
    } else if constexpr (FixedVector<V> || IsVector<V>::value || IsArray<V>::value) {
      Require(json.is_array(), "a list", place);
      if constexpr (IsVector<V>::value) value.resize(json.size());
      Require(json.size() == static_cast<std::size_t>(value.size()), "as long as it was written", place);
      std::size_t i = 0;
      for (auto& item : value) {
        Take(json[i], item, place + "[" + std::to_string(i) + "]");
        ++i;
      }
    } else {
      RecordReader io(json, place);
      Record(io, value);
    }
  }

  static double Number(const nlohmann::json& json, const std::string& place) {
    if (json == "nan") return std::numeric_limits<double>::quiet_NaN();
    if (json == "inf") return std::numeric_limits<double>::infinity();
    if (json == "-inf") return -std::numeric_limits<double>::infinity();
    Require(json.is_number(), "a number", place);
    return json.get<double>();
  }

  const nlohmann::json& json_;
  std::string place_;
};

template <class Io, class T>
using RecordOf = typename Io::template Value<T>;

template <class V>
std::string WriteRecord(const V& value) {
  RecordWriter io;
  Record(io, value);
  return io.TakeJson().dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// @param value  What Record() takes; half filled when there is an error.
template <class V>
Status ReadRecordInto(const std::string& text, V&& value) try {
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  RecordReader io(json, "");
  Record(io, value);
  return OkStatus();
} catch (const RecordReader::Malformed& problem) {
  return InvalidInput(problem.message);
}

template <class V>
Result<V> ReadRecord(const std::string& text) {
  V value;
  if (Status status = ReadRecordInto(text, value); !status.ok()) return status.error();
  return value;
}

}  // namespace soffit
