#pragma once

// What all conversions share: geometry, text, and the checks of what came from outside.

#include <Eigen/Core>
#include <cmath>
#include <string>
#include <vector>

#include "shared/flight/flight.h"
#include "shared/frames/frames.h"
#include "shared/geometry/polygon.h"
#include "soffit.h"

namespace soffit {

wire::Vector2 ToWire(const Eigen::Vector2d& v);
wire::Vector3 ToWire(const Eigen::Vector3d& v);
wire::Quaternion ToWire(const Eigen::Quaterniond& q);
wire::Ring ToWire(const Ring& ring);
wire::Polygon ToWire(const Polygon& polygon);
wire::VehicleEnvelope ToWire(const VehicleEnvelope& envelope);
wire::Purpose ToWire(Purpose purpose);
std::vector<wire::Vector3> ToWire(const std::vector<Eigen::Vector3d>& points);

Eigen::Vector2d FromWire(const wire::Vector2& v);
Eigen::Vector3d FromWire(const wire::Vector3& v);
Ring FromWire(const wire::Ring& ring);
Polygon FromWire(const wire::Polygon& polygon);
VehicleEnvelope FromWire(const wire::VehicleEnvelope& envelope);
std::vector<Eigen::Vector3d> FromWire(const std::vector<wire::Vector3>& points);

/// Collects the first thing that is wrong with a message, in words.
class Check {
 public:
  void Require(bool condition, const char* what) {
    if (!condition && problem_.empty()) problem_ = what;
  }
  void Finite(double value, const char* field) {
    Require(std::isfinite(value), field, " is not a finite number");
  }
  void Finite(const wire::Vector3& v, const char* field) {
    Require(std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z()), field, " is not finite");
  }
  void AtLeast(double low, double value, const char* field) {
    Require(std::isfinite(value) && value >= low, field, " is out of range");
  }
  /// Enumerators count from zero to `last`.
  template <class Enum>
  void Known(Enum value, Enum last, const char* field) {
    Require(static_cast<std::uint32_t>(value) <= static_cast<std::uint32_t>(last), field,
            " has an unknown value");
  }

  const std::string& problem() const { return problem_; }

 private:
  void Require(bool condition, const char* field, const char* what) {
    if (!condition && problem_.empty()) problem_ = std::string(field) + what;
  }
  std::string problem_;
};

}  // namespace soffit
