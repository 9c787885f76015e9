#include <algorithm>
#include <cmath>
#include <sstream>

#include "test/sim/flight/flight.h"
#include "test/sim/vehicle/estimator.h"
#include "test/sim/vehicle/multicopter.h"
#include "test/sim/vehicle/noise.h"

namespace soffit::sim {
namespace {

constexpr std::int64_t kStep_ns = 5'000'000;
constexpr double kStep_s = 0.005;

BodyState StartOf(const World& world) {
  BodyState state;
  state.map_from_body = Eigen::AngleAxisd(world.home_yaw_rad, Eigen::Vector3d::UnitZ());
  return state;
}

class SimulatedFlight : public Flight {
 public:
  SimulatedFlight(const World& world, const Space& space, const Truth& truth,
                  const SimulatedFlightOptions& options)
      : Flight(world, space, truth),
        start_utc_ns_(options.start_utc_ns),
        utc_ns_(options.start_utc_ns),
        air_(world.wind, options.seed + 101),
        estimator_(world.pose_noise, options.seed + 201),
        vehicle_(StartOf(world)),
        autopilot_((options.autopilot == AutopilotKind::kPx4 ? MakePx4 : MakeArduPilot)(
            {.map_origin = world.origin,
             .is_quick_start = options.is_quick_start,
             .link_count = options.link_count})) {}

  void Receive(const mavlink::Frame& frame, std::int64_t, std::size_t link) override {
    autopilot_->Receive(frame, link);
  }

  void Advance(std::int64_t utc_ns) override {
    while (utc_ns_ + kStep_ns <= utc_ns) Step();
  }

  std::vector<std::vector<std::uint8_t>> TakePackets(std::size_t link) override {
    return autopilot_->TakePackets(link);
  }

  Status Disturb(const std::string& words) override {
    std::istringstream stream(words);
    std::string what;
    std::string how;
    stream >> what >> how;
    if (what == "pilot" && autopilot_->PilotSelects(how)) return OkStatus();
    if (what == "gps" && (how == "on" || how == "off")) return autopilot_->SetGps(how == "on"), OkStatus();
    if (what == "radio" && (how == "on" || how == "off"))
      return autopilot_->SetRadio(how == "on"), OkStatus();
    if (what == "reboot" && how.empty()) return autopilot_->Reboot(), OkStatus();
    if (what == "break" && how.empty()) return vehicle_.Break(), OkStatus();
    if (what == "battery") {
      std::istringstream number(how);
      if (double ratio = 0.0; number >> ratio && ratio >= 0.0 && ratio <= 1.0) {
        return vehicle_.SetBattery(ratio), OkStatus();
      }
    }
    return InvalidInput("'" + words +
                        "' is none of: pilot MODE, gps on|off, radio on|off, battery 0..1, reboot, break");
  }

  nlohmann::json State() const override {
    return {{"mode", autopilot_->ModeName()},
            {"armed", autopilot_->is_armed()},
            {"landed", autopilot_->is_landed()},
            {"battery_ratio", vehicle_.state().battery_ratio},
            {"flight_s", static_cast<double>(utc_ns_ - start_utc_ns_) * 1e-9}};
  }

  std::string TrackLine() const override {
    const BodyState& state = vehicle_.state();
    const Eigen::Quaterniond& q = state.map_from_body;
    const Eigen::Vector3d& believed_m = estimate_.position_m;
    std::ostringstream line;
    line.precision(10);
    line << utc_ns_ << ',' << state.position_m.x() << ',' << state.position_m.y() << ','
         << state.position_m.z() << ',' << q.x() << ',' << q.y() << ',' << q.z() << ',' << q.w() << ','
         << believed_m.x() << ',' << believed_m.y() << ',' << believed_m.z() << ','
         << (autopilot_->is_armed() ? 1 : 0) << ',' << autopilot_->ModeName();
    return line.str();
  }

 private:
  void Step() {
    utc_ns_ += kStep_ns;
    const BodyState& state = vehicle_.state();
    estimate_ = estimator_.Step(state, kStep_s);
    MotorCommand command =
        autopilot_->Step({estimate_, state.is_on_ground, state.battery_ratio, utc_ns_}, kStep_s);
    command.map_from_body = estimator_.ToTruth(command.map_from_body);
    vehicle_.Step(command, air_.Step(kStep_s), kStep_s);
    poses_.Add({utc_ns_, state.position_m, state.map_from_body,
                estimator_.ToTruth(autopilot_->gimbal().MapFromCamera())});
    const double time_s = static_cast<double>(utc_ns_ - start_utc_ns_) * 1e-9;
    if (!recorder_.Add({time_s, state.position_m, state.is_on_ground, state.touchdown_speed_mps})) {
      vehicle_.Break();
      autopilot_->Crash();
    }
  }

  std::int64_t start_utc_ns_;
  std::int64_t utc_ns_;
  MovingAir air_;
  Estimator estimator_;
  Multicopter vehicle_;
  std::unique_ptr<Autopilot> autopilot_;
  Estimate estimate_;
};

}  // namespace

const char* Flight::TrackHeader() {
  return "utc_ns,x_m,y_m,z_m,qx,qy,qz,qw,believed_x_m,believed_y_m,believed_z_m,armed,mode";
}

std::unique_ptr<Flight> SimulateFlight(const World& world, const Space& space, const Truth& truth,
                                       const SimulatedFlightOptions& options) {
  return std::make_unique<SimulatedFlight>(world, space, truth, options);
}

}  // namespace soffit::sim
