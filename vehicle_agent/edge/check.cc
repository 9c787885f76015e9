#include "vehicle_agent/edge/check.h"

#include <cstdio>

#include "vehicle_agent/edge/station.h"

namespace soffit {
namespace {

void Print(bool is_good, const std::string& what, const std::string& how) {
  std::printf("%s %-16s %s\n", is_good ? "ok     " : "PROBLEM", what.c_str(), how.c_str());
  std::fflush(stdout);
}

std::string Number(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

bool CheckAutopilot(const AgentConfig& config, double timeout_s, const std::atomic<bool>& stop) {
  Result<AutopilotLine> opened = AutopilotLine::Open(config.mavlink, config.mavlink_key_file);
  if (!opened.ok()) {
    Print(false, "autopilot", opened.error().message);
    return false;
  }
  AutopilotLine& line = opened.value();
  AutopilotClient autopilot(config.autopilot);
  const Instant began = ReadClocks();
  Telemetry telemetry;
  while (!stop && SecondsBetween(began, ReadClocks()) < timeout_s) {
    for (const mavlink::Frame& frame : line.Receive(std::chrono::milliseconds(20))) {
      autopilot.Receive(frame, ReadClocks());
    }
    for (auto& packet : autopilot.Pursue({}, ReadClocks())) line.Send(std::move(packet));
    telemetry = autopilot.Report(ReadClocks());
    if (telemetry.is_connected && telemetry.not_ready.empty() && autopilot.ClockUncertainty_s() &&
        autopilot.KnowsParameters()) {
      break;
    }
  }
  if (!telemetry.is_connected) {
    Print(false, "autopilot",
          telemetry.not_ready + " on " + line.Url() + " within " + Number(timeout_s, 0) + " s" +
              (line.refused_packet_count() > 0 ? ": its packets are not signed with our key" : ""));
    return false;
  }
  Print(true, "autopilot", telemetry.autopilot + ", mode " + telemetry.mode);
  Print(telemetry.not_ready.empty(), "ready to fly",
        telemetry.not_ready.empty() ? "it would arm" : telemetry.not_ready);
  const auto clock_s = autopilot.ClockUncertainty_s();
  Print(clock_s.has_value(), "clock",
        clock_s ? "known to " + Number(*clock_s * 1e3, 1) + " ms" : "TIMESYNC is not answered");
  if (telemetry.battery_ratio >= 0.0) {
    Print(telemetry.battery_ratio >= config.guard.min_battery_ratio, "battery",
          Number(100.0 * telemetry.battery_ratio, 0) + " %");
  }
  for (const std::string& problem : autopilot.ListUnsafeParameters()) Print(false, "failsafe", problem);
  return telemetry.not_ready.empty() && clock_s.has_value();
}

bool CheckCamera(CameraId id, const CameraOptions& options) {
  const std::string name = std::string(ToString(id)) + " camera";
  Result<std::unique_ptr<CameraDevice>> camera = OpenCamera(options);
  if (!camera.ok()) {
    Print(false, name, camera.error().message);
    return false;
  }
  const Instant asked = ReadClocks();
  const Result<Picture> picture = camera.value()->Take();
  const Instant got = ReadClocks();
  if (!picture.ok()) {
    Print(false, name, picture.error().message);
    return false;
  }
  const double age_s = ToSeconds(got.utc_ns - picture.value().exposure_utc_ns);
  const bool is_timely = picture.value().has_trusted_time && age_s >= -0.05 &&
                         age_s <= SecondsBetween(asked, got) + options.latency_s + 0.05;
  Print(is_timely || !options.folder.empty(), name,
        std::to_string(picture.value().bytes.size() / 1024) + " KiB, exposed " + Number(age_s, 3) +
            " s before it arrived" + (is_timely ? "" : ": its clock or latency_s is wrong"));
  return is_timely || !options.folder.empty();
}

}  // namespace

bool CheckVehicle(const AgentConfig& config, double timeout_s, const std::atomic<bool>& stop) {
  bool is_good = CheckAutopilot(config, timeout_s, stop);
  const auto cameras = ListCameras(config);
  if (cameras.empty()) {
    Print(false, "cameras", "none is configured");
    is_good = false;
  }
  for (const auto& [id, options] : cameras) is_good = CheckCamera(id, *options) && is_good;
  return is_good;
}

}  // namespace soffit
