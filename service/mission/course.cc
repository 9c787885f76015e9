#include "service/mission/course.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace soffit {
namespace {

constexpr double kSameDimension_m = 1e-6;
constexpr double kOffAxis_m = 0.3;  // Of a look along a corridor; the decision may have moved it since.
constexpr double kBeyondEntry_m = 0.2;

bool IsSame(const VehicleEnvelope& a, const VehicleEnvelope& b) {
  return std::abs(a.radius_m - b.radius_m) <= kSameDimension_m &&
         std::abs(a.height_m - b.height_m) <= kSameDimension_m &&
         std::abs(a.safety_margin_m - b.safety_margin_m) <= kSameDimension_m;
}

bool GivesLeave(const ClearanceDecision& decision, const Mission& mission) {
  return decision.verdict == Verdict::kClear && decision.corridor && decision.decision_id != 0 &&
         decision.scene_revision == mission.findings->scene_revision &&
         IsSame(decision.vehicle, mission.vehicle->envelope);
}

double LeastMargin_m(const ClearanceDecision& d) {
  return std::min({d.margin_left_m, d.margin_right_m, d.margin_up_m, d.margin_down_m});
}

}  // namespace

std::optional<Eigen::Vector3d> PlaceOfLookAlong(const Corridor& corridor, const Mission& mission) {
  const Eigen::Vector3d way = (corridor.exit_in_map_m - corridor.entry_in_map_m).normalized();
  for (auto place = mission.looked_along.rbegin(); place != mission.looked_along.rend(); ++place) {
    const Eigen::Vector3d from_entry = *place - corridor.entry_in_map_m;
    const double along_m = from_entry.dot(way);
    if (along_m <= kBeyondEntry_m && (from_entry - along_m * way).norm() <= kOffAxis_m) return *place;
  }
  return std::nullopt;
}

Course ChooseCourse(const Mission& mission) {
  Course course;
  bool is_any_open = false;
  for (const ClearanceDecision& decision : mission.findings->decisions) {
    if (decision.object_id != mission.status.object_id) continue;
    if (course.reasons.find(decision.reason) == std::string::npos) {
      course.reasons += (course.reasons.empty() ? "" : "; ") + decision.reason;
    }
    is_any_open = is_any_open || decision.verdict != Verdict::kBlocked;
    if (decision.verdict != Verdict::kBlocked && decision.wanted) course.wanted.push_back(*decision.wanted);
    if (!GivesLeave(decision, mission)) continue;
    const bool was_looked_along = PlaceOfLookAlong(*decision.corridor, mission).has_value();
    if (!course.leave || std::make_pair(was_looked_along, LeastMargin_m(decision)) >
                             std::make_pair(course.was_looked_along, LeastMargin_m(*course.leave))) {
      course.leave = decision;
      course.was_looked_along = was_looked_along;
    }
  }
  course.is_blocked = !is_any_open && !course.reasons.empty();
  if (course.reasons.empty()) course.reasons = "no decision could be made";
  return course;
}

}  // namespace soffit
