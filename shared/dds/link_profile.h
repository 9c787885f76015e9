#pragma once

#include <string>

#include "shared/result/result.h"

namespace soffit {

struct DdsOptions;

/// What a link between vehicle and ground bears, and what is therefore sent over it.
struct LinkProfile {
  /// All large data may use so many bytes in each period, about 80 % of the link. A fragment is not larger,
  /// so that few IP packets have to arrive for it to be whole. 0: no limit.
  int flow_bytes = 0;
  int flow_period_ms = 1;
  double heartbeat_s = 0.0;        ///< Of commands and answers: how soon a lost one is noticed.
  double large_heartbeat_s = 0.0;  ///< The same for pictures and other large data.
  double picture_time_s = 0.0;     ///< A picture that would take longer is sent smaller,
  int picture_quality = 0;         ///< as a JPEG of this quality.

  /// What the flow allows; infinite without a limit.
  double Rate_Bps() const;
};

/// The profile that `options` name, with their own flow where they set one. An error when there is no such
/// profile.
Result<LinkProfile> FindLinkProfile(const DdsOptions& options);

}  // namespace soffit
