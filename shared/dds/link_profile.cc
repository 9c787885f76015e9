#include "shared/dds/link_profile.h"

#include <limits>
#include <map>

#include "shared/dds/participant.h"

namespace soffit {
namespace {

// Fragments of more than one IP packet are lost more often, smaller ones carry more header than data.
const std::map<std::string, LinkProfile> kProfiles = {
    {"local", {0, 1, 0.05, 0.05, 60.0, 95}},
    {"wired", {10000, 1, 0.01, 0.05, 3.0, 95}},      // 100 Mbit/s
    {"wifi", {2000, 1, 0.01, 0.05, 3.0, 90}},        // 20 Mbit/s
    {"lte", {1200, 2, 0.02, 0.1, 3.0, 85}},          // 6 Mbit/s
    {"telemetry", {1200, 60, 0.1, 0.5, 10.0, 75}}};  // 0.2 Mbit/s

}  // namespace

double LinkProfile::Rate_Bps() const {
  if (flow_bytes == 0) return std::numeric_limits<double>::infinity();
  return 1e3 * flow_bytes / flow_period_ms;
}

Result<LinkProfile> FindLinkProfile(const DdsOptions& options) {
  const auto found = kProfiles.find(options.profile);
  if (found == kProfiles.end()) {
    return InvalidInput("profile: '" + options.profile +
                        "' is no link profile; must be local, wired, wifi, lte or telemetry");
  }
  LinkProfile profile = found->second;
  if (options.flow_bytes_per_ms > 0) {
    profile.flow_bytes = options.flow_bytes_per_ms;
    profile.flow_period_ms = 1;
  }
  return profile;
}

}  // namespace soffit
