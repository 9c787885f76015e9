#pragma once

// How values become messages and messages become values. Each message names in one function, Fields(), which
// of its fields carries which field of the value, and what that has to keep to; a MessageWriter or a
// MessageReader is led through it:
//
//   template <class Io>
//   void Fields(Io& io, MessageOf<Io, wire::CommandAck>& m, ValueOf<Io, CommandAck>& v) {
//     io("sequence_number", m.sequence_number(), v.sequence);
//     io("status", m.status(), v.status, Last{wire::ACK_FAILED});
//   }
//
// Structures and sequences are followed into their parts.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "shared/flight/flight.h"
#include "shared/geometry/polygon.h"
#include "shared/result/result.h"
#include "soffit.h"

namespace soffit {

// ---- What a field has to keep to, beside being finite ----

struct AtLeast {
  double low;
};
struct AtMost {
  double high;
};
/// Enumerators count from zero to `value`. Every enumeration needs it.
template <class Enum>
struct Last {
  Enum value;
};
template <class Enum>
Last(Enum) -> Last<Enum>;
/// Of a sequence; more are not written.
struct MaxItems {
  std::size_t count;
};
/// The same of one that has the newest last: the oldest are not written.
struct NewestItems : MaxItems {};

template <class T>
concept Sequence = requires(const T& t) {
  typename T::value_type;
  t.begin();
  t.size();
}
&&!std::same_as<T, std::string>;

/// Puts a value into a message.
class MessageWriter {
 public:
  static constexpr bool kReads = false;
  template <class T>
  using Message = T;
  template <class T>
  using Value = const T;

  template <class F, class V, class... Rules>
  void operator()(const char*, F& field, const V& value, const Rules&... rules) {
    Put(field, value);
    (Keep(field, rules), ...);
  }
  template <class F, class V>
  void Optional(const char*, bool& has_value, F& field, const std::optional<V>& value) {
    has_value = value.has_value();
    if (value) Put(field, *value);
  }
  template <Sequence F, class V>
  void Optional(const char*, F& field, const std::optional<V>& value) {
    field.resize(value ? 1 : 0);
    if (value) Put(field[0], *value);
  }
  void Require(bool, const char*) {}

 private:
  template <class F, class V>
  void Put(F& field, const V& value) {
    if constexpr (std::is_enum_v<F>) {
      field = static_cast<F>(static_cast<int>(value));
    } else if constexpr (std::is_arithmetic_v<F>) {
      field = static_cast<F>(value);
    } else if constexpr (std::is_assignable_v<F&, const V&>) {
      field = value;
    } else if constexpr (Sequence<F>) {
      field.resize(value.size());
      for (std::size_t i = 0; i < value.size(); ++i) Put(field[i], value[i]);
    } else {
      Fields(*this, field, value);
    }
  }

  template <class F, class Rule>
  void Keep(F&, const Rule&) {}
  template <class F>
  void Keep(F& field, const MaxItems& most) {
    field.resize(std::min(field.size(), most.count));
  }
  template <class F>
  void Keep(F& field, const NewestItems& most) {
    const std::size_t kept = std::min(field.size(), most.count);
    field.erase(field.begin(), field.end() - static_cast<std::ptrdiff_t>(kept));
  }
};

/// Takes a value out of a message, and the first thing that is wrong with it.
class MessageReader {
 public:
  static constexpr bool kReads = true;
  template <class T>
  using Message = const T;
  template <class T>
  using Value = T;

  template <class F, class V, class... Rules>
  void operator()(const char* name, const F& field, V& value, const Rules&... rules) {
    static_assert(!std::is_enum_v<F> || sizeof...(rules) == 1, "an enumeration needs its last enumerator");
    path_.push_back(name);
    (Keep(field, rules), ...);
    Take(field, value);
    path_.pop_back();
  }
  template <class F, class V>
  void Optional(const char* name, bool has_value, const F& field, std::optional<V>& value) {
    if (has_value) (*this)(name, field, value.emplace());
  }
  template <Sequence F, class V>
  void Optional(const char* name, const F& field, std::optional<V>& value) {
    path_.push_back(name);
    Keep(field, MaxItems{1});
    if (!field.empty()) Take(field[0], value.emplace());
    path_.pop_back();
  }
  /// `what` is said of the structure that is read.
  void Require(bool condition, const char* what) {
    if (condition || !problem_.empty()) return;
    for (const char* name : path_) problem_ += (problem_.empty() ? "" : ".") + std::string(name);
    problem_ += (problem_.empty() ? "" : " ") + std::string(what);
  }

  const std::string& problem() const { return problem_; }

 private:
  template <class F, class V>
  void Take(const F& field, V& value) {
    if constexpr (std::is_floating_point_v<F>) {
      Require(std::isfinite(field), "is not a finite number");
      value = field;
    } else if constexpr (std::is_enum_v<F> || std::is_arithmetic_v<F>) {
      value = static_cast<V>(field);
    } else if constexpr (requires { field.to_string(); }) {
      value = field.to_string();
    } else if constexpr (std::same_as<F, V> && !HasDoubles<F>()) {
      value = field;
    } else if constexpr (Sequence<F>) {
      if constexpr (requires { value.resize(1); }) value.resize(field.size());
      for (std::size_t i = 0; i < field.size(); ++i) Take(field[i], value[i]);
    } else {
      Fields(*this, field, value);
    }
  }
  template <class F>
  static constexpr bool HasDoubles() {
    if constexpr (Sequence<F>) return std::is_floating_point_v<typename F::value_type>;
    return false;
  }

  void Keep(double field, const AtLeast& rule) { Require(field >= rule.low, "is out of range"); }
  void Keep(double field, const AtMost& rule) { Require(field <= rule.high, "is out of range"); }
  void Keep(const std::vector<double>& fields, const AtLeast& rule) {
    for (const double field : fields) Keep(field, rule);
  }
  template <class Enum>
  void Keep(Enum field, const Last<Enum>& last) {
    Require(static_cast<std::uint32_t>(field) <= static_cast<std::uint32_t>(last.value),
            "has an unknown value");
  }
  template <Sequence F>
  void Keep(const F& field, const MaxItems& most) {
    Require(field.size() <= most.count, "has too many items");
  }

  std::vector<const char*> path_;  ///< To the field that is read.
  std::string problem_;
};

template <class Io, class T>
using MessageOf = typename Io::template Message<T>;
template <class Io, class T>
using ValueOf = typename Io::template Value<T>;

template <class Message, class Value>
Message WriteMessage(const Value& value) {
  Message message;
  MessageWriter io;
  Fields(io, message, value);
  return message;
}

/// @param whose  Said before the problem: "picture 3 of vehicle 1: ".
template <class Value, class Message>
Result<Value> ReadMessage(const Message& message, const std::string& whose = "") {
  Value value;
  MessageReader io;
  Fields(io, message, value);
  if (!io.problem().empty()) return InvalidInput(whose + io.problem());
  return value;
}

// ---- What many messages are made of ----

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::Vector2>& m, ValueOf<Io, Eigen::Vector2d>& v) {
  io("x", m.x(), v.x());
  io("y", m.y(), v.y());
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::Vector3>& m, ValueOf<Io, Eigen::Vector3d>& v) {
  io("x", m.x(), v.x());
  io("y", m.y(), v.y());
  io("z", m.z(), v.z());
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::Quaternion>& m, ValueOf<Io, Eigen::Quaterniond>& v) {
  io("x", m.x(), v.x());
  io("y", m.y(), v.y());
  io("z", m.z(), v.z());
  io("w", m.w(), v.w());
  io.Require(std::abs(v.norm() - 1.0) <= 1e-3, "is no unit quaternion");
  if constexpr (Io::kReads) v.normalize();
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::Ring>& m, ValueOf<Io, Ring>& v) {
  io("corners_m", m.corners_m(), v);
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::Polygon>& m, ValueOf<Io, Polygon>& v) {
  io("outer", m.outer(), v.outer);
  io("holes", m.holes(), v.holes);
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::VehicleEnvelope>& m, ValueOf<Io, VehicleEnvelope>& v) {
  io("radius_m", m.radius_m(), v.radius_m);
  io("height_m", m.height_m(), v.height_m);
  io("safety_margin_m", m.safety_margin_m(), v.safety_margin_m);
}

}  // namespace soffit
