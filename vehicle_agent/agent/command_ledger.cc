#include "vehicle_agent/agent/command_ledger.h"

#include <algorithm>

namespace soffit {
namespace {

constexpr std::size_t kMaxAnswers = 256;
constexpr std::size_t kMaxOldMissions = 256;

}  // namespace

bool CommandLedger::IsOver(std::uint64_t mission_id) const {
  return std::ranges::find(old_missions_, mission_id) != old_missions_.end();
}

CommandAck* CommandLedger::FindAnswer(const FlightCommand& command) {
  if (mission_id_ == 0 || command.mission_id != mission_id_) return nullptr;
  const auto known = answers_.find(command.sequence);
  return known == answers_.end() ? nullptr : &known->second;
}

void CommandLedger::Begin(const FlightCommand& command) {
  if (command.mission_id != mission_id_) {
    if (mission_id_ != 0) old_missions_.push_back(mission_id_);
    if (old_missions_.size() > kMaxOldMissions) old_missions_.erase(old_missions_.begin());
    mission_id_ = command.mission_id;
    newest_scene_revision_ = 0;
    answers_.clear();
  }
  last_sequence_ = command.sequence;
}

void CommandLedger::NoteSceneRevision(std::uint64_t revision) {
  newest_scene_revision_ = std::max(newest_scene_revision_, revision);
}

void CommandLedger::Keep(const CommandAck& answer) {
  if (answer.mission_id != mission_id_ || answer.sequence > last_sequence_) return;
  answers_[answer.sequence] = answer;
  if (answers_.size() > kMaxAnswers) answers_.erase(answers_.begin());
}

}  // namespace soffit
