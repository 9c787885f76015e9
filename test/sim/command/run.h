#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/result/result.h"

namespace soffit::sim {

struct RunOptions {
  std::string world_file;
  std::vector<std::string> mavlink_urls = {"udpout:127.0.0.1:14550"};
  std::string autopilot = "ardupilot";  ///< ardupilot, px4, none (follow one that flies elsewhere).
  std::string out_folder = "soffit-sim";
  int camera_port = 0;
  int control_port = 0;
  std::uint64_t seed = 0;
  bool is_quick_start = false;
  double broken_picture_ratio = 0.0;
  double late_picture_ratio = 0.0;
};

/// Flies in the world in real time until SIGINT or SIGTERM: autopilot on MAVLink links, cameras and control
/// by HTTP.
///
/// When ready it prints one line of JSON: {"mavlink": [URL, ...], "camera_port", "control_port", "out"}.
/// Writes OUT/truth.json (whole, every second and at the end) and OUT/track.csv (20 times a second). A line
/// POSTed to http://127.0.0.1:CONTROL/disturb makes something go wrong: what Flight::Disturb knows, and "link
/// off SECONDS" or "camera BROKEN_RATIO LATE_RATIO". GET /truth gives what truth.json would say now.
Status Run(const RunOptions& options);

}  // namespace soffit::sim
