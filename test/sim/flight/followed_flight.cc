#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>

#include "shared/frames/frames.h"
#include "test/sim/autopilot/ned.h"
#include "test/sim/flight/flight.h"
#include "vehicle_agent/mavlink/arrivals.h"
#include "vehicle_agent/mavlink/constants.h"
#include "vehicle_agent/pose/clock_offset.h"

namespace soffit::sim {
namespace {

using namespace mavlink;

constexpr std::int64_t kAskAgain_ns = 2'000'000'000;
constexpr std::int64_t kHeartbeatPeriod_ns = 1'000'000'000;
constexpr std::uint8_t kCameraComponent = 100;
constexpr std::uint8_t kOwnSystem = 1;  ///< Until the autopilot tells its own.
constexpr double kStep_m = 0.01;

struct Wish {
  std::uint32_t message_id;
  double rate_hz;  ///< 0: once.
};
constexpr Wish kWishes[] = {{LocalPositionNed::kId, 50.0}, {AttitudeQuaternion::kId, 50.0},
                            {ExtendedSysState::kId, 4.0},  {GimbalDeviceAttitudeStatus::kId, 20.0},
                            {HomePosition::kId, 0.0},      {GpsGlobalOrigin::kId, 0.0}};

template <class Message>
GeodeticOrigin PlaceOf(const Message& m) {
  return {m.latitude * 1e-7, m.longitude * 1e-7, m.altitude * 1e-3};
}

class FollowedFlight : public Flight {
 public:
  FollowedFlight(const World& world, const Space& space, const Truth& truth) : Flight(world, space, truth) {
    pose_.map_from_body = Eigen::AngleAxisd(world.home_yaw_rad, Eigen::Vector3d::UnitZ());
  }

  void Receive(const Frame& frame, std::int64_t utc_ns, std::size_t) override {
    if (frame.component_id != kComponentAutopilot) return;
    arrivals_[frame.message_id].Add(utc_ns);
    if (const auto m = Decode<Heartbeat>(frame)) {
      system_id_ = frame.system_id;
      is_armed_ = (m->base_mode & kModeFlagSafetyArmed) != 0;
      custom_mode_ = m->custom_mode;
    } else if (const auto home = Decode<HomePosition>(frame)) {
      if (!home_) home_ = PlaceOf(*home);
    } else if (const auto origin = Decode<GpsGlobalOrigin>(frame)) {
      local_origin_ = PlaceOf(*origin);
    } else if (const auto state = Decode<ExtendedSysState>(frame)) {
      is_on_ground_ = state->landed_state == kLandedOnGround;
    } else if (const auto position = Decode<LocalPositionNed>(frame)) {
      TakePosition(*position, utc_ns);
    } else if (const auto attitude = Decode<AttitudeQuaternion>(frame)) {
      const Eigen::Quaterniond q(static_cast<double>(attitude->q1), static_cast<double>(attitude->q2),
                                 static_cast<double>(attitude->q3), static_cast<double>(attitude->q4));
      if (q.norm() > 0.5) pose_.map_from_body = NedFrame::SwapAttitude(q.normalized());
    } else if (const auto gimbal = Decode<GimbalDeviceAttitudeStatus>(frame)) {
      TakeGimbal(*gimbal);
    }
  }

  void Advance(std::int64_t utc_ns) override {
    Encoder& encoder = EncoderFor(system_id_);
    if (utc_ns - said_utc_ns_ >= kHeartbeatPeriod_ns) {  // Where the other side waits to be spoken to.
      said_utc_ns_ = utc_ns;
      packets_.push_back(encoder.Encode(
          Heartbeat{.type = kTypeCamera, .autopilot = kAutopilotInvalid, .mavlink_version = 3}));
    }
    if (system_id_ == 0 || utc_ns - asked_utc_ns_ < kAskAgain_ns) return;
    asked_utc_ns_ = utc_ns;
    for (const Wish& wish : kWishes) {
      if (!IsGranted(wish, utc_ns)) packets_.push_back(encoder.Encode(AskFor(wish)));
    }
  }

  std::vector<std::vector<std::uint8_t>> TakePackets(std::size_t) override {
    return std::exchange(packets_, {});
  }

  Status Disturb(const std::string& words) override {
    return Error{Error::Code::kUnsupported, "'" + words + "': the autopilot is not simulated here"};
  }

  nlohmann::json State() const override {
    return {{"mode", std::to_string(custom_mode_)}, {"armed", is_armed_}, {"landed", is_on_ground_}};
  }

  std::string TrackLine() const override {
    const Eigen::Vector3d& p = pose_.position_m;
    const Eigen::Quaterniond& q = pose_.map_from_body;
    std::ostringstream line;
    line.precision(10);
    line << pose_.utc_ns << ',' << p.x() << ',' << p.y() << ',' << p.z() << ',' << q.x() << ',' << q.y()
         << ',' << q.z() << ',' << q.w() << ',' << p.x() << ',' << p.y() << ',' << p.z() << ','
         << (is_armed_ ? 1 : 0) << ',' << custom_mode_;
    return line.str();
  }

 private:
  /// Speaks for the vehicle that it sits on, under the autopilot's own system id.
  Encoder& EncoderFor(std::uint8_t system_id) {
    if (system_id != 0 && system_id != encoder_system_id_) {
      encoder_system_id_ = system_id;
      encoder_ = Encoder(system_id, kCameraComponent);
    }
    return encoder_;
  }

  bool IsGranted(const Wish& wish, std::int64_t utc_ns) const {
    const auto arrivals = arrivals_.find(wish.message_id);
    if (arrivals == arrivals_.end()) return false;
    return wish.rate_hz == 0.0 || arrivals->second.KeepUpWith(wish.rate_hz, utc_ns);
  }

  CommandLong AskFor(const Wish& wish) const {
    CommandLong request;
    request.target_system = system_id_;
    request.target_component = kComponentAutopilot;
    request.command = wish.rate_hz == 0.0 ? kCmdRequestMessage : kCmdSetMessageInterval;
    request.param1 = static_cast<float>(wish.message_id);
    if (wish.rate_hz > 0.0) request.param2 = static_cast<float>(1e6 / wish.rate_hz);
    return request;
  }

  void TakePosition(const LocalPositionNed& m, std::int64_t utc_ns) {
    const std::int64_t boot_ns = std::int64_t{m.time_boot_ms} * 1'000'000;
    if (boot_ns < last_boot_ns_) ForgetAfterRestart();
    last_boot_ns_ = boot_ns;
    clock_.AddArrival(boot_ns, utc_ns);
    if (!home_ || !local_origin_ || !std::isfinite(m.x + m.y + m.z)) return;

    const NedFrame at_home(*home_, Eigen::Vector3d::Zero());
    const NedFrame local(*home_, at_home.MapOf(*local_origin_));
    const Eigen::Vector3d before_m = pose_.position_m;
    pose_.utc_ns = clock_.ToUtc(boot_ns).value();
    pose_.position_m = local.ToMap(Eigen::Vector3d(m.x, m.y, m.z));
    if (!has_gimbal_) pose_.map_from_gimbal = pose_.map_from_body * CameraAttitude(0.0, 0.0);
    if (start_utc_ns_ == 0) start_utc_ns_ = pose_.utc_ns;
    poses_.Add(pose_);
    Record(before_m);
  }

  /// Its local frame begins anew; the map stays where it was.
  void ForgetAfterRestart() {
    clock_.Reset();
    arrivals_.clear();
    local_origin_.reset();
  }

  /// The way from the last position in small steps, so that no thin thing is jumped over.
  void Record(const Eigen::Vector3d& before_m) {
    const Eigen::Vector3d way_m = pose_.position_m - before_m;
    const int steps = has_recorded_ ? std::clamp(static_cast<int>(way_m.norm() / kStep_m), 1, 200) : 1;
    has_recorded_ = true;
    const double time_s = static_cast<double>(pose_.utc_ns - start_utc_ns_) * 1e-9;
    for (int i = 1; i <= steps; ++i) {
      recorder_.Add({time_s, before_m + way_m * (static_cast<double>(i) / steps), is_on_ground_, 0.0});
    }
  }

  void TakeGimbal(const GimbalDeviceAttitudeStatus& m) {
    const Eigen::Quaterniond q(static_cast<double>(m.q[0]), static_cast<double>(m.q[1]),
                               static_cast<double>(m.q[2]), static_cast<double>(m.q[3]));
    if (!(q.norm() > 0.5)) return;
    const EulerAngles angles = EulerOf(q.normalized());
    const bool is_north = (m.flags & kGimbalYawLock) != 0;
    const double nose_rad = NedFrame::SwapYaw(YawOf(pose_.map_from_body));
    const double heading_rad = is_north ? angles.yaw_rad : nose_rad + angles.yaw_rad;
    pose_.map_from_gimbal = CameraAttitude(NedFrame::SwapYaw(heading_rad), angles.pitch_rad);
    has_gimbal_ = true;
  }

  FlightPose pose_;
  Encoder encoder_{kOwnSystem, kCameraComponent};
  std::uint8_t encoder_system_id_ = kOwnSystem;
  std::optional<GeodeticOrigin> home_;  ///< The first one is the origin of the map.
  std::optional<GeodeticOrigin> local_origin_;
  std::map<std::uint32_t, Arrivals> arrivals_;  ///< By message.
  ClockOffset clock_;
  std::vector<std::vector<std::uint8_t>> packets_;
  std::int64_t start_utc_ns_ = 0;
  std::int64_t last_boot_ns_ = 0;
  std::int64_t said_utc_ns_ = 0;
  std::int64_t asked_utc_ns_ = 0;
  std::uint32_t custom_mode_ = 0;
  std::uint8_t system_id_ = 0;
  bool is_armed_ = false;
  bool is_on_ground_ = true;
  bool has_gimbal_ = false;
  bool has_recorded_ = false;
};

}  // namespace

std::unique_ptr<Flight> FollowFlight(const World& world, const Space& space, const Truth& truth) {
  return std::make_unique<FollowedFlight>(world, space, truth);
}

}  // namespace soffit::sim
