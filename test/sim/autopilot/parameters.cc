#include "test/sim/autopilot/parameters.h"

#include <cmath>
#include <iterator>

#include "vehicle_agent/mavlink/constants.h"

namespace soffit::sim {

std::optional<mavlink::ParamValue> Parameters::Read(const mavlink::ParamRequestRead& request) const {
  auto found = values_.end();
  if (request.param_index < 0) {
    found = values_.find(mavlink::TextOf(request.param_id));
  } else if (static_cast<std::size_t>(request.param_index) < values_.size()) {
    found = std::next(values_.begin(), request.param_index);
  }
  if (found == values_.end()) return std::nullopt;
  return Describe(found);
}

std::optional<mavlink::ParamValue> Parameters::Write(const mavlink::ParamSet& request) {
  const auto found = values_.find(mavlink::TextOf(request.param_id));
  if (found == values_.end() || !std::isfinite(request.param_value)) return std::nullopt;
  found->second = static_cast<double>(request.param_value);
  return Describe(found);
}

mavlink::ParamValue Parameters::Describe(std::map<std::string, double>::const_iterator found) const {
  mavlink::ParamValue value;
  value.param_id = mavlink::ToTextField<16>(found->first);
  value.param_value = static_cast<float>(found->second);
  value.param_type = mavlink::kParamReal32;
  value.param_count = static_cast<std::uint16_t>(values_.size());
  value.param_index = static_cast<std::uint16_t>(std::distance(values_.begin(), found));
  return value;
}

}  // namespace soffit::sim
