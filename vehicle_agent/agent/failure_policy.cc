#include "vehicle_agent/agent/failure_policy.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "shared/result/say.h"

namespace soffit {
namespace {

struct ReactionName {
  const char* word;
  const char* doing;
};
constexpr ReactionName kReactionNames[] = {{"go_on", "going on"},
                                           {"wait", "waiting"},
                                           {"hold", "stopping here"},
                                           {"back_out", "backing out"},
                                           {"return", "returning home"},
                                           {"land", "landing here"},
                                           {"release", "leaving it to the autopilot"}};

std::optional<Reaction> FindReaction(const std::string& word) {
  const auto* const found =
      std::ranges::find_if(kReactionNames, [&](const ReactionName& name) { return word == name.word; });
  if (found == std::end(kReactionNames)) return std::nullopt;
  return static_cast<Reaction>(found - std::begin(kReactionNames));
}

/// Visits the rows of a policy in the order of Failure, and the cells of a row in the order of Situation.
template <class Visit>
void ForEachCell(const FailurePolicy& policy, const Visit& visit) {
  std::size_t row = 0;
  FailurePolicy::Visit(policy, [&](const char* row_name, const FailureRow& cells) {
    std::size_t column = 0;
    FailureRow::Visit(cells, [&](const char* cell_name, const std::string& word, const OptionInfo&) {
      visit(row, column++, std::string(row_name) + "." + cell_name, word);
    });
    ++row;
  });
}

bool IsBlind(std::size_t row) {
  return row == static_cast<std::size_t>(Failure::kPositionLost) ||
         row == static_cast<std::size_t>(Failure::kAutopilotSilent);
}

}  // namespace

std::string FindPolicyProblem(const FailurePolicy& policy) {
  std::string problem;
  ForEachCell(policy, [&](std::size_t row, std::size_t, const std::string& name, const std::string& word) {
    if (!problem.empty()) return;
    const std::optional<Reaction> reaction = FindReaction(word);
    if (!reaction) {
      problem = Say(name, ": '", word,
                    "' is no reaction; must be go_on, wait, hold, back_out, return, land or release");
    } else if (IsBlind(row) && reaction != Reaction::kHold && *reaction < Reaction::kLand) {
      problem = Say(name, ": '", word, "' cannot be carried out then; must be hold, land or release");
    }
  });
  return problem;
}

ReactionTable::ReactionTable(const FailurePolicy& policy) {
  ForEachCell(policy, [&](std::size_t row, std::size_t column, const std::string&, const std::string& word) {
    reactions_.at(row).at(column) = FindReaction(word).value_or(Reaction::kHold);
  });
}

std::optional<Trouble> ReactionTable::FindGravest(const FailureSigns& signs, Situation situation) const {
  std::optional<Trouble> gravest;
  for (const auto& [failure, words] : signs) {
    const Reaction reaction =
        reactions_.at(static_cast<std::size_t>(failure)).at(static_cast<std::size_t>(situation));
    if (reaction <= (gravest ? gravest->reaction : Reaction::kGoOn)) continue;
    gravest = Trouble{failure, reaction,
                      Say(words, ": ", kReactionNames[static_cast<std::size_t>(reaction)].doing)};
  }
  return gravest;
}

}  // namespace soffit
