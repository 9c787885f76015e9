#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "shared/flight/flight.h"

namespace soffit {

/// What was commanded and answered in the present mission, and which missions are over: what makes commands
/// idempotent, and keeps old ones from being done again.
class CommandLedger {
 public:
  std::uint64_t mission_id() const { return mission_id_; }        ///< 0: none yet.
  std::uint32_t last_sequence() const { return last_sequence_; }  ///< 0: none yet in this mission.
  const std::vector<std::uint64_t>& old_missions() const { return old_missions_; }
  std::uint64_t newest_scene_revision() const { return newest_scene_revision_; }

  bool IsOver(std::uint64_t mission_id) const;

  /// The latest answer to a command that is no news; null when it is.
  CommandAck* FindAnswer(const FlightCommand& command);
  CommandAck* FindNewestAnswer() { return answers_.empty() ? nullptr : &answers_.rbegin()->second; }

  /// A command is the next one, of this mission or of a new one. Its number is used up, whatever becomes of
  /// it.
  void Begin(const FlightCommand& command);

  /// The newest revision of the mission's scene that was heard of: a permit for an older one is void.
  void NoteSceneRevision(std::uint64_t revision);

  /// Keeps the answer to a command that has begun.
  void Keep(const CommandAck& answer);

 private:
  std::uint64_t mission_id_ = 0;
  std::uint32_t last_sequence_ = 0;
  std::uint64_t newest_scene_revision_ = 0;
  std::vector<std::uint64_t> old_missions_;
  std::map<std::uint32_t, CommandAck> answers_;
};

}  // namespace soffit
