#pragma once

#include <string>
#include <vector>

#include "service/mission/mission.h"
#include "service/mission/views.h"

namespace soffit {

/// One command at a time: makes it, sends it, sends it again while it is not answered, and watches over it.
/// Works on the mission of `update` and adds to its commands. The vehicle has to be known, but for a hold.
class Errands {
 public:
  Errands(MissionUpdate& update, std::int64_t now_utc_ns, const ViewPlanner& views,
          const MissionOptions& options)
      : update_(update), m_(update.mission), now_(now_utc_ns), views_(views), options_(options) {}

  // Each becomes the errand, in place of any other.
  void Hold() { Send(Command(CommandKind::kHold)); }
  void Abort() { Send(Command(CommandKind::kAbort)); }
  void Land() { Send(Command(CommandKind::kLand)); }
  void TakeOff();
  void Look(const Viewpoint& view);
  void GoHome();
  void GoToEntry(const Corridor& corridor);  ///< By the place from where it was looked along.
  void FlyThrough(const ClearanceDecision& leave, std::int64_t valid_until_utc_ns);

  struct Watched {
    bool is_viewed = false;  ///< The picture of a look has arrived and can be used.
    std::string failure;     ///< Empty: it is still under way.
  };
  /// There has to be an errand.
  Watched Watch();

 private:
  FlightCommand Command(CommandKind kind) const;
  FlightCommand FlyTo(CommandKind kind, std::vector<Eigen::Vector3d> path, double yaw_rad,
                      double speed_mps) const;
  double TransitAltitude_m(const Eigen::Vector2d& to) const;
  std::vector<Eigen::Vector3d> WayTo(const Eigen::Vector3d& place) const;
  void Send(FlightCommand command);
  void SendAgain();
  Watched Overrun(const std::string& why);
  Watched WatchPicture(double waited_s) const;
  double LongestTime_s(const FlightCommand& command) const;

  MissionUpdate& update_;
  Mission& m_;
  std::int64_t now_;
  const ViewPlanner& views_;
  const MissionOptions& options_;
};

}  // namespace soffit
