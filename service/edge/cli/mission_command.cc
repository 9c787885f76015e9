#include <unistd.h>

#include <atomic>
#include <cmath>
#include <condition_variable>
#include <csignal>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <mutex>

#include "service/edge/cli/commands.h"
#include "service/edge/cli/request_client.h"
#include "service/edge/files/file.h"

namespace soffit {
namespace {

using namespace std::chrono_literals;

constexpr std::uintmax_t kMaxReferenceBytes = 16U << 20U;
constexpr int kBarWidth = 30;

struct MissionArguments {
  LocalDomain place;
  std::uint32_t vehicle_id = 1;
  std::uint64_t mission_id = 0;
  std::string reference;
  std::vector<double> area;
  double radius_m = 0.0;
  bool watches = false;
  bool draws_bar = false;
  int timeout_s = 10;
};

[[noreturn]] void Fail(const std::string& message) {
  std::cerr << "soffit mission: " << message << '\n';
  throw CLI::RuntimeError(1);
}

template <class T>
T Take(Result<T> result) {
  if (!result.ok()) Fail(result.error().message);
  return std::move(result).value();
}

/// The newest report of each mission, as they come in.
class ReportWatch {
 public:
  explicit ReportWatch(const Participant& participant)
      : reader_(participant, [this](MissionReport report) { Take(std::move(report)); }) {}

  /// All reports that are known once no new one has come for `quiet`.
  std::vector<MissionReport> Collect(std::chrono::milliseconds quiet) {
    reader_.WaitForWriter(std::chrono::seconds(5));
    std::unique_lock lock(mutex_);
    while (changed_.wait_for(lock, quiet, [this] { return std::exchange(is_news_, false); })) continue;
    std::vector<MissionReport> reports;
    for (const auto& [id, report] : reports_) reports.push_back(report);
    return reports;
  }

  /// The next report of a mission that is newer than `revision`; none when none came in a second.
  std::optional<MissionReport> Next(std::uint64_t mission_id, std::uint32_t revision) {
    std::unique_lock lock(mutex_);
    const auto is_there = [&] {
      return reports_.contains(mission_id) && reports_[mission_id].revision > revision;
    };
    if (!changed_.wait_for(lock, 1s, is_there)) return std::nullopt;
    return reports_[mission_id];
  }

 private:
  void Take(MissionReport report) {
    const std::lock_guard lock(mutex_);
    reports_[report.mission_id] = std::move(report);
    is_news_ = true;
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::uint64_t, MissionReport> reports_;
  bool is_news_ = false;
  Reader<MissionStatusTopic> reader_;
};

std::string ClockOf(const MissionReport& report) {
  const auto seconds = static_cast<int>((report.stamp_utc_ns - report.started_utc_ns) / 1'000'000'000);
  std::ostringstream text;
  text << std::setw(3) << seconds / 60 << ':' << std::setw(2) << std::setfill('0') << seconds % 60;
  return text.str();
}

/// On a terminal: a line for each step and a bar that is redrawn below it. Elsewhere: a line for each
/// message.
class ProgressPrinter {
 public:
  explicit ProgressPrinter(bool draws_bar) : draws_bar_(draws_bar || isatty(STDOUT_FILENO) != 0) {}

  void Show(const MissionReport& report) {
    Clear();
    for (; problems_ < report.status.problems.size(); ++problems_) {
      std::cout << "        ! " << report.status.problems[problems_] << '\n';
    }
    if (report.status.message != message_) {
      message_ = report.status.message;
      std::cout << ClockOf(report) << "  " << std::left << std::setw(16) << ToString(report.status.step)
                << ' ' << message_ << '\n';
    }
    if (draws_bar_ && report.status.state != MissionState::kEnded) DrawBar(report.status);
    std::cout << std::flush;
  }

 private:
  void Clear() {
    if (draws_bar_) std::cout << "\r\033[K";
  }
  void DrawBar(const MissionStatus& status) const {
    const int filled = static_cast<int>(std::lround(status.step_progress_ratio * kBarWidth));
    std::cout << "        [" << std::string(static_cast<std::size_t>(filled), '#')
              << std::string(static_cast<std::size_t>(kBarWidth - filled), '.') << "] "
              << std::lround(100.0 * status.progress_ratio) << " % of the mission";
  }

  bool draws_bar_;
  std::string message_;
  std::size_t problems_ = 0;
};

/// Until the mission has ended; 0 when it was flown, else 2.
int Watch(ReportWatch& reports, std::uint64_t mission_id, bool draws_bar) {
  ProgressPrinter printer(draws_bar);
  std::uint32_t revision = 0;
  while (true) {
    const std::optional<MissionReport> report = reports.Next(mission_id, revision);
    if (!report) continue;
    revision = report->revision;
    printer.Show(*report);
    if (report->status.state != MissionState::kEnded) continue;
    std::cout << "mission " << mission_id << " has ended: " << ToString(report->status.outcome) << '\n';
    if (report->picture_to_decision_max_s > 0.0) {
      std::cout << "from a picture's arrival to what it allowed: at most " << std::fixed
                << std::setprecision(2) << report->picture_to_decision_max_s << " s\n";
    }
    return report->status.outcome == MissionOutcome::kFlown ? 0 : 2;
  }
}

MissionRequest MakeStart(const MissionArguments& arguments) {
  MissionRequest request;
  request.kind = MissionRequestKind::kStart;
  request.vehicle_id = arguments.vehicle_id;
  request.reference_name = arguments.reference;
  request.reference = Take(ReadFile(arguments.reference, kMaxReferenceBytes));
  if (!arguments.area.empty()) request.area_center_in_map_m = {arguments.area[0], arguments.area[1]};
  request.area_radius_m = arguments.radius_m;
  return request;
}

MissionReply Ask(const Participant& participant, MissionRequest request, const MissionArguments& arguments) {
  MissionClient client(participant);
  MissionReply reply = Take(client.Ask(std::move(request), std::chrono::seconds(arguments.timeout_s)));
  if (!reply.is_accepted) Fail(reply.message);
  return reply;
}

void RunStart(const MissionArguments& arguments) {
  const MissionRequest request = MakeStart(arguments);
  const Participant participant = Take(JoinLocalDomain(arguments.place));
  ReportWatch reports(participant);
  const MissionReply reply = Ask(participant, request, arguments);
  std::cout << "mission " << reply.mission_id << " of vehicle " << arguments.vehicle_id << " has begun\n"
            << std::flush;
  if (!arguments.watches) return;
  const int code = Watch(reports, reply.mission_id, arguments.draws_bar);
  if (code != 0) throw CLI::RuntimeError(code);
}

void RunWish(const MissionArguments& arguments, MissionRequestKind kind) {
  const Participant participant = Take(JoinLocalDomain(arguments.place));
  MissionRequest request;
  request.kind = kind;
  request.vehicle_id = arguments.vehicle_id;
  request.mission_id = arguments.mission_id;
  Ask(participant, std::move(request), arguments);
}

void RunStatus(const MissionArguments& arguments) {
  const Participant participant = Take(JoinLocalDomain(arguments.place));
  ReportWatch watch(participant);
  const std::vector<MissionReport> reports = watch.Collect(1s);
  if (reports.empty()) std::cout << "no missions are known on the local domain\n";
  for (const MissionReport& report : reports) {
    const MissionStatus& status = report.status;
    std::cout << "mission " << report.mission_id << ", vehicle " << report.vehicle_id << ": "
              << ToString(status.state);
    if (status.state == MissionState::kEnded) std::cout << " (" << ToString(status.outcome) << ')';
    if (status.state != MissionState::kEnded) {
      std::cout << ", " << ToString(status.step) << ", " << std::lround(100.0 * status.progress_ratio)
                << " %";
    }
    std::cout << "\n  " << status.message << '\n';
    for (const std::string& problem : status.problems) std::cout << "  ! " << problem << '\n';
  }
  if (!arguments.watches || reports.empty()) return;
  const int code = Watch(watch, reports.back().mission_id, arguments.draws_bar);
  if (code != 0) throw CLI::RuntimeError(code);
}

CLI::App* AddAction(CLI::App& mission, const std::shared_ptr<MissionArguments>& arguments,
                    const std::string& name, const std::string& help) {
  CLI::App* action = mission.add_subcommand(name, help);
  AddLocalDomainOptions(*action, arguments->place);
  action->add_option("--timeout", arguments->timeout_s, "Seconds to wait for the service")
      ->check(CLI::Range(1, 3600));
  return action;
}

void AddWatch(CLI::App& action, const std::shared_ptr<MissionArguments>& arguments, const std::string& help) {
  CLI::Option* watch = action.add_flag("--watch", arguments->watches, help + " (exit code 2: not flown)");
  action.add_flag("--bar", arguments->draws_bar, "Draw a progress bar even if the output is no terminal")
      ->needs(watch);
}

void AddWish(CLI::App& mission, const std::shared_ptr<MissionArguments>& arguments, const std::string& name,
             const std::string& help, MissionRequestKind kind) {
  CLI::App* action = AddAction(mission, arguments, name, help);
  action->add_option("--vehicle", arguments->vehicle_id, "Id of the vehicle");
  action->add_option("--mission", arguments->mission_id,
                     "Id of the mission; without it the one that the vehicle flies");
  action->callback([arguments, kind] { RunWish(*arguments, kind); });
}

}  // namespace

void AddMissionCommand(CLI::App& app) {
  CLI::App* mission =
      app.add_subcommand("mission", "Starts, steers and watches missions of a running soffitd");
  mission->require_subcommand(1);
  const auto arguments = std::make_shared<MissionArguments>();

  CLI::App* start =
      AddAction(*mission, arguments, "start", "Sends a vehicle to find, model and fly through a building");
  start->add_option("--vehicle", arguments->vehicle_id, "Id of the vehicle");
  start->add_option("--reference", arguments->reference, "Small black-on-white map of the wanted building")
      ->required();
  start->add_option("--area", arguments->area, "Where to look for it: metres east and north of home")
      ->expected(2);
  start->add_option("--area-radius", arguments->radius_m,
                    "Metres around there that the overview has to show");
  AddWatch(*start, arguments, "Show the progress until the mission has ended");
  start->callback([arguments] { RunStart(*arguments); });

  AddWish(*mission, arguments, "pause", "Lets a vehicle hold where it is", MissionRequestKind::kPause);
  AddWish(*mission, arguments, "resume", "Goes on with a paused mission", MissionRequestKind::kResume);
  AddWish(*mission, arguments, "abort", "Stops a vehicle at once and brings it home",
          MissionRequestKind::kAbort);

  CLI::App* status = AddAction(*mission, arguments, "status", "Tells where all missions stand");
  AddWatch(*status, arguments, "Follow the newest one until it has ended");
  status->callback([arguments] { RunStatus(*arguments); });
}

}  // namespace soffit
