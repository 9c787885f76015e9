#include "vehicle_agent/autopilot/parameter_watch.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

#include "vehicle_agent/mavlink/codec.h"
#include "vehicle_agent/mavlink/constants.h"

namespace soffit {
namespace {

constexpr double kAskEvery_s = 0.2;
constexpr int kMostAsks = 5;

struct Rule {
  const char* name;
  bool (*is_safe)(int value, const ParameterValues& all);
  const char* advice;
  const char* helper = nullptr;  ///< Another parameter that is looked at; it may be missing.
};

template <int... kValues>
bool IsOneOf(int value, const ParameterValues&) {
  return ((value == kValues) || ...);
}

bool HasBit(const ParameterValues& all, const char* name, int bit) {
  const auto found = all.find(name);
  return found != all.end() && (static_cast<int>(std::lround(found->second)) >> bit & 1) != 0;
}

constexpr Rule kArduPilotRules[] = {
    {"FS_EKF_ACTION", IsOneOf<1, 3>, "position lost: set 1 (land)"},
    {"FS_THR_ENABLE",
     [](int value, const ParameterValues& all) {
       return value == 0 || value == 3 || HasBit(all, "FS_OPTIONS", 2);
     },
     "the pilot's radio lost: it climbs to return; set 3 (land), or bit 2 of FS_OPTIONS (go on in GUIDED)",
     "FS_OPTIONS"},
    {"FS_GCS_ENABLE", IsOneOf<0, 5>, "ground station lost: it climbs to return; set 0 (off) or 5 (land)"},
    {"BATT_FS_LOW_ACT", IsOneOf<1>,
     "battery low: set 1 (land); the agent returns earlier, at min_battery_ratio"},
    {"FENCE_ACTION",
     [](int value, const ParameterValues& all) {
       const auto is_on = all.find("FENCE_ENABLE");
       return is_on == all.end() || is_on->second == 0.0 || value == 0 || value == 2 || value == 4;
     },
     "fence left: it climbs to return; set 2 (land) or 4 (brake)", "FENCE_ENABLE"},
};

constexpr Rule kPx4Rules[] = {
    {"COM_OBL_RC_ACT", IsOneOf<4, 5>, "the agent died: set 5 (hold) or 4 (land)"},
    {"COM_OF_LOSS_T", [](int value, const ParameterValues&) { return value >= 0 && value <= 2; },
     "the agent died: noticed too late; set 1 s"},
    {"NAV_RCL_ACT",
     [](int value, const ParameterValues& all) {
       return value == 1 || value == 3 || HasBit(all, "COM_RCL_EXCEPT", 2);
     },
     "the pilot's radio lost: set 1 (hold) or 3 (land), or bit 2 of COM_RCL_EXCEPT (go on in OFFBOARD)",
     "COM_RCL_EXCEPT"},
    {"NAV_DLL_ACT", IsOneOf<0, 1, 3>, "ground station lost: set 0 (off), 1 (hold) or 3 (land)"},
    {"COM_LOW_BAT_ACT", IsOneOf<2>,
     "battery low: set 2 (land); the agent returns earlier, at min_battery_ratio"},
};

std::span<const Rule> RulesOf(Dialect dialect) {
  if (dialect == Dialect::kArduPilot) return kArduPilotRules;
  if (dialect == Dialect::kPx4) return kPx4Rules;
  return {};
}

/// ArduPilot sends all as numbers; PX4 sends the bits of a whole number in the place of the fraction.
double ValueOf(const mavlink::ParamValue& message, Dialect dialect) {
  if (dialect == Dialect::kPx4 && message.param_type == mavlink::kParamInt32) {
    return std::bit_cast<std::int32_t>(message.param_value);
  }
  return static_cast<double>(message.param_value);
}

}  // namespace

std::vector<std::string> FindUnsafeParameters(Dialect dialect, const ParameterValues& values) {
  std::vector<std::string> unsafe;
  for (const Rule& rule : RulesOf(dialect)) {
    const auto found = values.find(rule.name);
    if (found == values.end()) {
      unsafe.push_back(std::string(rule.name) + " could not be read (" + rule.advice + ")");
    } else if (const int value = static_cast<int>(std::lround(found->second)); !rule.is_safe(value, values)) {
      unsafe.push_back(std::string(rule.name) + " is " + std::to_string(value) + ": " + rule.advice);
    }
  }
  return unsafe;
}

void ParameterWatch::Begin(Dialect dialect) {
  *this = {};
  dialect_ = dialect;
  for (const Rule& rule : RulesOf(dialect)) {
    pending_[rule.name] = 0;
    if (rule.helper != nullptr) pending_[rule.helper] = 0;
  }
}

std::optional<std::string> ParameterWatch::FindNextToAsk(Instant now) {
  if (pending_.empty() || (asked_.steady_ns != 0 && SecondsBetween(asked_, now) < kAskEvery_s)) {
    return std::nullopt;
  }
  asked_ = now;
  const auto next = std::ranges::min_element(pending_, {}, [](const auto& entry) { return entry.second; });
  const std::string name = next->first;
  if (++next->second > kMostAsks) {
    pending_.erase(next);
    return std::nullopt;
  }
  return name;
}

void ParameterWatch::Take(const mavlink::ParamValue& message) {
  const std::string name = mavlink::TextOf(message.param_id);
  const double value = ValueOf(message, dialect_);
  if (pending_.erase(name) > 0 && std::isfinite(value)) values_[name] = value;
}

}  // namespace soffit
