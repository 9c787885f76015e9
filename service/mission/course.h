#pragma once

#include <optional>
#include <string>
#include <vector>

#include "service/mission/mission.h"

namespace soffit {

/// What the decisions about the building that is looked at come to.
struct Course {
  std::optional<ClearanceDecision> leave;  ///< To enter: the corridor that was looked along, else the widest.
  bool was_looked_along = false;           ///< The corridor of `leave`.
  std::vector<Viewpoint> wanted;           ///< What would settle open decisions.
  bool is_blocked = false;                 ///< Every way through is.
  std::string reasons;                     ///< Of all decisions, for people.
};

/// From where this corridor was looked along: a place before its entry and on its axis, from which the entry
/// is reached in a straight line. None: it was not. Corridors are told apart by where they are: the walls of
/// a building may be numbered anew with each picture.
std::optional<Eigen::Vector3d> PlaceOfLookAlong(const Corridor& corridor, const Mission& mission);

/// Leave to enter gives a CLEAR of the newest scene revision, for the dimensions that the vehicle states now.
/// The mission's vehicle and findings have to be known.
Course ChooseCourse(const Mission& mission);

}  // namespace soffit
