#pragma once

#include <map>
#include <optional>
#include <string>

#include "vehicle_agent/mavlink/codec.h"

namespace soffit::sim {

/// The parameters of an autopilot, by name.
class Parameters {
 public:
  explicit Parameters(std::map<std::string, double> values) : values_(std::move(values)) {}

  double operator[](const std::string& name) const { return values_.at(name); }

  /// The answer to a request by name, or by index when that is not negative; none for what does not exist.
  std::optional<mavlink::ParamValue> Read(const mavlink::ParamRequestRead& request) const;
  /// Takes the new value and gives the answer; none for what does not exist or is not finite.
  std::optional<mavlink::ParamValue> Write(const mavlink::ParamSet& request);

 private:
  mavlink::ParamValue Describe(std::map<std::string, double>::const_iterator found) const;

  std::map<std::string, double> values_;
};

}  // namespace soffit::sim
