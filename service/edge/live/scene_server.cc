#include "service/edge/live/scene_server.h"

namespace soffit {
namespace {

constexpr int kAnswerers = 2;
constexpr double kDefaultTimeout_s = 10.0;
constexpr std::size_t kMaxWaitingOfAClient = 64;
constexpr std::size_t kMaxClients = 1024;
constexpr std::size_t kMaxVehicles = 1024;

std::vector<ClearanceDecision> DecisionsOf(const SceneSnapshot& snapshot) {
  std::vector<ClearanceDecision> decisions;
  for (const DecisionReport& report : snapshot.decisions) decisions.push_back(report.decision);
  return decisions;
}

}  // namespace

SceneServer::SceneServer(const Participant& local, const PipelineOptions& options)
    : options_(options),
      objects_(local),
      models_(local),
      decisions_(local),
      replies_(local),
      ros_(local),
      sender_(1, kMaxVehicles),
      answerers_(kAnswerers, kMaxWaitingOfAClient, kMaxClients),
      queries_(local, [this](const SceneQuery& query) { OnQuery(query); }) {}

void SceneServer::Publish(std::shared_ptr<const SceneSnapshot> snapshot) {
  const std::uint32_t vehicle_id = snapshot->origin.vehicle_id;
  const std::lock_guard lock(mutex_);
  const auto& before = histories_[vehicle_id];
  auto history = std::make_shared<SceneHistory>(Extend(before ? *before : SceneHistory(), snapshot));
  Schedule(vehicle_id, std::move(snapshot), std::move(history));
}

void SceneServer::Restore(SceneHistory history) {
  std::shared_ptr<const SceneSnapshot> newest = history.kept.back();
  const std::lock_guard lock(mutex_);
  Schedule(newest->origin.vehicle_id, newest, std::make_shared<SceneHistory>(std::move(history)));
}

/// With the lock.
void SceneServer::Schedule(std::uint32_t vehicle_id, std::shared_ptr<const SceneSnapshot> newest,
                           std::shared_ptr<const SceneHistory> history) {
  histories_[vehicle_id] = std::move(history);
  newest_[vehicle_id] = std::move(newest);
  if (unsent_.contains(vehicle_id)) return;
  if (sender_.TrySubmit([this, vehicle_id] { SendNewest(vehicle_id); })) unsent_.insert(vehicle_id);
}

/// A question for which there is no room is dropped: whoever asks a few at a time, and again after a second
/// without an answer, is always answered.
void SceneServer::OnQuery(const SceneQuery& query) {
  const auto asked = std::chrono::steady_clock::now();
  answerers_.TrySubmit(query.id.client, [this, query, asked] { replies_.Write(Answer(query, asked)); });
}

SceneReply SceneServer::Answer(const SceneQuery& query, std::chrono::steady_clock::time_point asked) const
    try {
  std::shared_ptr<const SceneHistory> history;
  {
    const std::lock_guard lock(mutex_);
    const auto found = histories_.find(query.vehicle_id);
    if (found != histories_.end()) history = found->second;
  }
  const std::chrono::duration<double> timeout(query.timeout_s > 0.0 ? query.timeout_s : kDefaultTimeout_s);
  const auto is_late = [&] { return std::chrono::steady_clock::now() - asked > timeout; };
  return AnswerQuery(query, history ? *history : SceneHistory(), options_, is_late);
} catch (const std::exception& defect) {
  SceneReply reply;
  reply.id = query.id;
  reply.status = AnswerStatus::kFailed;
  reply.message = defect.what();
  return reply;
}

void SceneServer::SendNewest(std::uint32_t vehicle_id) {
  std::shared_ptr<const SceneSnapshot> snapshot;
  {
    const std::lock_guard lock(mutex_);
    unsent_.erase(vehicle_id);
    snapshot = newest_[vehicle_id];
  }
  SendTopics(*snapshot);
  ros_.PublishScene(vehicle_id, snapshot->stamp_utc_ns,
                    snapshot->understanding ? snapshot->understanding->scene : Scene{},
                    DecisionsOf(*snapshot));
}

void SceneServer::SendTopics(const SceneSnapshot& snapshot) {
  const Origin& origin = snapshot.origin;
  Sent now;
  if (snapshot.understanding) {
    for (const SceneObject& object : snapshot.understanding->scene.objects) {
      now.objects.insert(object.footprint.object_id);
      objects_.Write({origin, object});
    }
    for (const Solid& solid : snapshot.understanding->scene.solids) {
      now.models.insert(solid.footprint.object_id);
      models_.Write(ReportModel(origin, solid));
    }
  }
  for (const DecisionReport& report : snapshot.decisions) {
    now.decisions.insert({report.decision.object_id, report.decision.side});
    decisions_.Write(report);
  }
  Sent& before = sent_[origin.vehicle_id];
  for (const std::uint32_t id : before.objects) {
    if (now.objects.contains(id)) continue;
    SceneObjectReport gone{origin, {}};
    gone.object.footprint.object_id = id;
    objects_.Dispose(gone);
  }
  for (const std::uint32_t id : before.models) {
    if (!now.models.contains(id)) models_.Dispose({origin, id, {}, 0.0, {}});
  }
  for (const auto& [id, side] : before.decisions) {
    if (now.decisions.contains({id, side})) continue;
    DecisionReport gone;
    gone.decision.vehicle_id = origin.vehicle_id;
    gone.decision.object_id = id;
    gone.decision.side = side;
    decisions_.Dispose(gone);
  }
  before = std::move(now);
}

}  // namespace soffit
