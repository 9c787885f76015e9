#include "service/mission/errands.h"

#include <algorithm>
#include <cmath>

#include "service/mission/course.h"
#include "service/mission/transit.h"
#include "shared/result/say.h"

namespace soffit {
namespace {

constexpr double kCommandGrace_s = 60.0;
constexpr double kSamePlace_m = 0.6;

double HeadingOf(const Corridor& corridor) {
  const Eigen::Vector3d way = corridor.exit_in_map_m - corridor.entry_in_map_m;
  return std::atan2(way.y(), way.x());
}

}  // namespace

void Errands::TakeOff() {
  FlightCommand command = Command(CommandKind::kTakeOff);
  const Eigen::Vector3d& home = m_.vehicle->position_in_map_m;
  command.path_in_map_m = {{home.x(), home.y(), views_.Overview().position_in_map_m.z()}};
  Send(std::move(command));
}

void Errands::Look(const Viewpoint& view) {
  FlightCommand command =
      FlyTo(CommandKind::kLook, WayTo(view.position_in_map_m), view.yaw_rad, options_.transit_speed_mps);
  command.camera_pitch_rad = view.pitch_rad;
  command.purpose = view.purpose;
  command.capture_id = ++m_.last_capture_id;
  Send(std::move(command));
}

void Errands::GoHome() {
  const Eigen::Vector3d home(0.0, 0.0, TransitAltitude_m(Eigen::Vector2d::Zero()));
  Send(FlyTo(CommandKind::kGoTo, WayTo(home), m_.vehicle->yaw_rad, options_.transit_speed_mps));
}

void Errands::GoToEntry(const Corridor& corridor) {
  const Eigen::Vector3d place = PlaceOfLookAlong(corridor, m_).value_or(corridor.entry_in_map_m);
  const bool is_there = (m_.vehicle->position_in_map_m - place).norm() < kSamePlace_m;
  std::vector<Eigen::Vector3d> path;
  if (!is_there) path = WayTo(place);
  path.push_back(corridor.entry_in_map_m);
  Send(FlyTo(CommandKind::kGoTo, std::move(path), HeadingOf(corridor),
             is_there ? options_.corridor_speed_mps : options_.transit_speed_mps));
}

void Errands::FlyThrough(const ClearanceDecision& leave, std::int64_t valid_until_utc_ns) {
  const Corridor& corridor = *leave.corridor;
  FlightCommand command = FlyTo(CommandKind::kFlyCorridor, {corridor.entry_in_map_m, corridor.exit_in_map_m},
                                HeadingOf(corridor), options_.corridor_speed_mps);
  command.permit =
      CorridorPermit{leave.decision_id, leave.object_id,       leave.scene_revision,  valid_until_utc_ns,
                     leave.vehicle,     corridor.free_width_m, corridor.free_height_m};
  Send(std::move(command));
}

FlightCommand Errands::Command(CommandKind kind) const {
  FlightCommand command;
  command.vehicle_id = m_.order.vehicle_id;
  command.mission_id = m_.order.mission_id;
  command.kind = kind;
  command.yaw_rad = m_.vehicle ? m_.vehicle->yaw_rad : 0.0;
  return command;
}

FlightCommand Errands::FlyTo(CommandKind kind, std::vector<Eigen::Vector3d> path, double yaw_rad,
                             double speed_mps) const {
  FlightCommand command = Command(kind);
  command.path_in_map_m = std::move(path);
  command.yaw_rad = yaw_rad;
  const double limit_mps = m_.vehicle->max_speed_mps;
  command.speed_mps = limit_mps > 0.0 ? std::min(speed_mps, limit_mps) : speed_mps;
  return command;
}

double Errands::TransitAltitude_m(const Eigen::Vector2d& to) const {
  static const std::vector<Footprint> kNothing;
  return TransitAltitude(m_.findings ? m_.findings->map : kNothing, m_.vehicle->position_in_map_m.head<2>(),
                         to, m_.vehicle->envelope, options_.transit_clearance_m,
                         views_.Overview().position_in_map_m.z());
}

std::vector<Eigen::Vector3d> Errands::WayTo(const Eigen::Vector3d& place) const {
  return FlyOver(m_.vehicle->position_in_map_m, place, TransitAltitude_m(place.head<2>()));
}

void Errands::Send(FlightCommand command) {
  command.sequence = ++m_.last_sequence;
  Errand errand;
  errand.since_utc_ns = now_;
  if (!command.path_in_map_m.empty() && m_.vehicle) {
    errand.start_distance_m = (command.path_in_map_m.back() - m_.vehicle->position_in_map_m).norm();
  }
  errand.longest_s = m_.vehicle ? LongestTime_s(command) : kCommandGrace_s;
  errand.command = std::move(command);
  m_.errand = std::move(errand);
  SendAgain();
}

void Errands::SendAgain() {
  m_.errand->command.issued_utc_ns = now_;
  m_.errand->command.valid_until_utc_ns = now_ + ToNanoseconds(options_.answer_timeout_s);
  m_.errand->sent_utc_ns = now_;
  update_.commands.push_back(m_.errand->command);
}

Errands::Watched Errands::Watch() {
  const Errand& errand = *m_.errand;
  const double waited_s = ToSeconds(now_ - errand.since_utc_ns);
  if (errand.is_ended) return WatchPicture(waited_s);
  if (errand.is_answered) {
    if (waited_s <= errand.longest_s) return {};
    return Overrun(Say("'", ToString(errand.command.kind), "' is not done after ", waited_s, " s"));
  }
  if (waited_s > options_.answer_timeout_s) {
    return Overrun(Say("no answer to '", ToString(errand.command.kind), "' for ", waited_s, " s"));
  }
  if (now_ - errand.sent_utc_ns >= ToNanoseconds(options_.resend_s)) SendAgain();
  return {};
}

Errands::Watched Errands::Overrun(const std::string& why) {
  m_.has_overrun = true;
  return {false, why};
}

Errands::Watched Errands::WatchPicture(double waited_s) const {
  const std::uint32_t id = m_.errand->command.capture_id;
  const auto picture = std::find_if(m_.pictures.begin(), m_.pictures.end(),
                                    [&](const PictureResult& p) { return p.capture_id == id; });
  if (picture != m_.pictures.end()) {
    if (picture->problem.empty()) return {true, ""};
    return {false, Say("picture ", id, ": ", picture->problem)};
  }
  if (waited_s <= options_.picture_timeout_s) return {};
  return {false, Say("picture ", id, " did not arrive within ", options_.picture_timeout_s, " s")};
}

double Errands::LongestTime_s(const FlightCommand& command) const {
  double length_m = 0.0;
  Eigen::Vector3d from = m_.vehicle->position_in_map_m;
  for (const Eigen::Vector3d& to : command.path_in_map_m) {
    length_m += (to - from).norm();
    from = to;
  }
  const double height_m = m_.vehicle->position_in_map_m.z();
  const double speed_mps = command.speed_mps > 0.0 ? command.speed_mps : 0.5;
  return kCommandGrace_s + 3.0 * (length_m + height_m) / speed_mps;
}

}  // namespace soffit
