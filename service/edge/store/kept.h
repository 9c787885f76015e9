#pragma once

#include <memory>
#include <string>
#include <vector>

#include "service/edge/dds/messages.h"
#include "service/edge/store/mission_folder.h"
#include "service/pipeline/pipeline.h"

namespace soffit {

/// What one mission knows at one time. Never modified, shared freely between threads.
struct SceneSnapshot {
  Origin origin;
  std::int64_t stamp_utc_ns = 0;
  std::shared_ptr<const Understanding> understanding;  ///< Null: nothing was understood yet.
  std::vector<DecisionReport> decisions;
  VehicleEnvelope vehicle;     ///< The mission's.
  std::string reference_name;  ///< What it looks for.
};

/// How many of a mission's newest revisions are kept whole, with their map. Of the others it is known that
/// there were such.
inline constexpr std::size_t kKeptRevisions = 8;

Revision DescribeRevision(const SceneSnapshot& snapshot);

/// Of a mission, what has to be there after a restart for it to go on, beside its pictures and scenes.
struct KeptMission {
  Mission mission;
  std::uint64_t findings_revision = 0;  ///< Of the mission's findings; 0: it has none.
  RequestId request_id;                 ///< That it was begun with.
  std::string reference_name;
  std::string reference_file;
  std::int64_t started_utc_ns = 0;
  std::vector<Capture> captures;  ///< As they arrived; those that are on disk without their bytes.
  MissionLog log;
};

// As text. What changes all the time and is heard anew after a restart is left out: of the vehicle where it
// is and what it does; of a mission its progress and its findings, which are made again from the scene that
// `findings_revision` names; of a scene its octree, its facades and its views; of footprints their
// silhouettes.
struct MissionRecord {
  std::uint64_t mission_id = 0;
  std::uint32_t vehicle_id = 0;
  std::int64_t started_utc_ns = 0;
  std::string reference_name;
  std::string state;
  std::string step;
  std::string outcome;
  std::string message;
  std::string text;  ///< All of it; the fields above are for people.

  friend bool operator==(const MissionRecord&, const MissionRecord&) = default;
};
MissionRecord WriteMission(const KeptMission& kept);
std::string WriteScene(const SceneSnapshot& snapshot);  ///< Its understanding is not null.
std::string WriteCapture(const Capture& capture);
Result<KeptMission> ReadMission(const std::string& text);  ///< Without captures.
Result<SceneSnapshot> ReadScene(const std::string& text, std::shared_ptr<const octomap::OcTree> octree);
Result<Capture> ReadCapture(const std::string& text);

}  // namespace soffit
