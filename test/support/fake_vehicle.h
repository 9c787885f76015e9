#pragma once

#include <algorithm>
#include <cmath>

#include "vehicle_agent/vehicle/vehicle.h"

namespace soffit {

/// A vehicle that does what it is told: it follows each intent with a simple lag, without an autopilot
/// between.
class FakeVehicle {
 public:
  FakeVehicle() {
    telemetry_.is_connected = true;
    telemetry_.autopilot = "ArduPilot";
    telemetry_.mode = "GUIDED";
    telemetry_.is_in_our_mode = true;
    telemetry_.not_ready.clear();
    telemetry_.has_position = true;
    telemetry_.battery_ratio = 0.9;
  }

  void Follow(const Intent& intent, double dt_s) {
    Telemetry& t = telemetry_;
    Eigen::Vector3d target = t.position_in_map_m;
    switch (intent.kind) {
      case Intent::Kind::kNone:
        break;
      case Intent::Kind::kTakeOff:
        t.is_armed = t.is_in_air = true;
        target.z() = intent.position_in_map_m.z();
        break;
      case Intent::Kind::kFlyTo:
        if (!t.is_in_air || !t.is_in_our_mode) break;
        target = intent.position_in_map_m;
        t.yaw_rad +=
            std::clamp(std::remainder(intent.yaw_rad - t.yaw_rad, 2.0 * M_PI), -1.5 * dt_s, 1.5 * dt_s);
        break;
      case Intent::Kind::kLand:
        target.z() = std::max(0.0, t.position_in_map_m.z() - 1.0);
        if (t.position_in_map_m.z() < 0.05) t.is_armed = t.is_in_air = false;
        break;
    }
    Eigen::Vector3d wanted = 2.0 * (target - t.position_in_map_m);
    if (wanted.norm() > 5.0) wanted *= 5.0 / wanted.norm();
    const Eigen::Vector3d change = wanted - t.velocity_in_map_mps;
    t.velocity_in_map_mps += change * std::min(1.0, dt_s / 0.15);
    t.position_in_map_m += t.velocity_in_map_mps * dt_s;
  }

  Telemetry& telemetry() { return telemetry_; }

 private:
  Telemetry telemetry_;
};

}  // namespace soffit
