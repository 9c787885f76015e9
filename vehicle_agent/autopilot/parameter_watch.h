#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "vehicle_agent/autopilot/dialect.h"
#include "vehicle_agent/mavlink/messages.h"
#include "vehicle_agent/vehicle/vehicle.h"

namespace soffit {

/// Values of an autopilot's parameters, as far as they are known.
using ParameterValues = std::map<std::string, double>;

/// How the autopilot's own failsafes would endanger a vehicle inside a corridor when agent, radio, battery or
/// position fail there: one line for each parameter, with what to set. A return climbs first: under a soffit,
/// into it. The list is in vehicle_agent/README.md.
std::vector<std::string> FindUnsafeParameters(Dialect dialect, const ParameterValues& values);

/// Reads the parameters that this takes, one after another, when an autopilot is first heard and after a
/// reboot.
class ParameterWatch {
 public:
  void Begin(Dialect dialect);

  /// The name of the next one to be asked for, not too often; none: not now.
  std::optional<std::string> FindNextToAsk(Instant now);
  void Take(const mavlink::ParamValue& message);

  /// Whether all were told, or asked for in vain.
  bool IsDone() const { return pending_.empty(); }
  const ParameterValues& values() const { return values_; }

 private:
  Dialect dialect_ = Dialect::kUnknown;
  std::map<std::string, int> pending_;  ///< How often each was asked for.
  ParameterValues values_;
  Instant asked_;
};

}  // namespace soffit
