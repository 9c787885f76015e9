#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "shared/frames/frames.h"
#include "test/sim/autopilot/ned.h"
#include "test/sim/flight/flight.h"
#include "vehicle_agent/mavlink/constants.h"

namespace soffit::sim {
namespace {

using namespace mavlink;

constexpr std::int64_t kSilence_ns = 1'500'000'000;
constexpr std::int64_t kAskAgain_ns = 2'000'000'000;
constexpr std::uint8_t kCameraComponent = 100;
constexpr double kStep_m = 0.01;

struct Wish {
  std::uint32_t message_id;
  float interval_us;
};
constexpr Wish kWishes[] = {{LocalPositionNed::kId, 20'000},
                            {AttitudeQuaternion::kId, 20'000},
                            {HomePosition::kId, 1'000'000},
                            {ExtendedSysState::kId, 500'000},
                            {GimbalDeviceAttitudeStatus::kId, 50'000}};

class FollowedFlight : public Flight {
 public:
  FollowedFlight(const World& world, const Space& space, const Truth& truth) : Flight(world, space, truth) {
    pose_.map_from_body = Eigen::AngleAxisd(world.home_yaw_rad, Eigen::Vector3d::UnitZ());
  }

  void Receive(const Frame& frame, std::int64_t utc_ns) override {
    if (frame.component_id != kComponentAutopilot) return;
    if (const auto m = Decode<Heartbeat>(frame)) {
      system_id_ = frame.system_id;
      is_armed_ = (m->base_mode & kModeFlagSafetyArmed) != 0;
      custom_mode_ = m->custom_mode;
    } else if (const auto home = Decode<HomePosition>(frame); home && !home_in_ned_m_) {
      home_in_ned_m_ = Eigen::Vector3d(home->x, home->y, home->z);  // The first one is the origin of the map.
    } else if (const auto state = Decode<ExtendedSysState>(frame)) {
      is_on_ground_ = state->landed_state == kLandedOnGround;
    } else if (const auto position = Decode<LocalPositionNed>(frame)) {
      last_position_utc_ns_ = utc_ns;
      TakePosition(*position, utc_ns);
    } else if (const auto attitude = Decode<AttitudeQuaternion>(frame)) {
      pose_.map_from_body = NedFrame::SwapAttitude(
          Eigen::Quaterniond(static_cast<double>(attitude->q1), static_cast<double>(attitude->q2),
                             static_cast<double>(attitude->q3), static_cast<double>(attitude->q4))
              .normalized());
    } else if (const auto gimbal = Decode<GimbalDeviceAttitudeStatus>(frame)) {
      TakeGimbal(*gimbal);
    }
  }

  void Advance(std::int64_t utc_ns) override {
    const bool is_silent = utc_ns - last_position_utc_ns_ > kSilence_ns;
    if (system_id_ == 0 || !is_silent || utc_ns - asked_utc_ns_ < kAskAgain_ns) return;
    asked_utc_ns_ = utc_ns;
    Encoder& encoder = EncoderFor(system_id_);
    for (const Wish& wish : kWishes) {
      CommandLong request;
      request.target_system = system_id_;
      request.target_component = kComponentAutopilot;
      request.command = kCmdSetMessageInterval;
      request.param1 = static_cast<float>(wish.message_id);
      request.param2 = wish.interval_us;
      packets_.push_back(encoder.Encode(request));
    }
  }

  std::vector<std::vector<std::uint8_t>> TakePackets() override { return std::exchange(packets_, {}); }

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
  Encoder& EncoderFor(std::uint8_t system_id) {
    if (!encoder_) encoder_.emplace(system_id, kCameraComponent);
    return *encoder_;
  }

  void TakePosition(const LocalPositionNed& m, std::int64_t utc_ns) {
    if (!home_in_ned_m_ || !std::isfinite(m.x + m.y + m.z)) return;
    // The packet that was least late tells how the autopilot's clock stands to ours.
    const std::int64_t boot_ns = std::int64_t{m.time_boot_ms} * 1'000'000;
    if (boot_ns < last_boot_ns_)
      boot_utc_ns_ = std::numeric_limits<std::int64_t>::max();  // It was started again.
    last_boot_ns_ = boot_ns;
    boot_utc_ns_ = std::min(boot_utc_ns_, utc_ns - boot_ns);

    const Eigen::Vector3d in_ned_m(m.x, m.y, m.z);
    const Eigen::Vector3d before_m = pose_.position_m;
    pose_.utc_ns = boot_utc_ns_ + boot_ns;
    pose_.position_m = NedFrame::SwapVector(in_ned_m - *home_in_ned_m_);
    if (!has_gimbal_) pose_.map_from_gimbal = pose_.map_from_body * CameraAttitude(0.0, 0.0);
    if (start_utc_ns_ == 0) start_utc_ns_ = pose_.utc_ns;
    poses_.Add(pose_);
    Record(before_m);
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
  std::optional<Encoder> encoder_;
  std::optional<Eigen::Vector3d> home_in_ned_m_;
  std::vector<std::vector<std::uint8_t>> packets_;
  std::int64_t start_utc_ns_ = 0;
  std::int64_t boot_utc_ns_ = std::numeric_limits<std::int64_t>::max();
  std::int64_t last_boot_ns_ = 0;
  std::int64_t last_position_utc_ns_ = 0;
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
