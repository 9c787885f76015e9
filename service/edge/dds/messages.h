#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "service/clearance/clearance.h"
#include "service/mission/mission.h"
#include "service/query/occupancy.h"
#include "service/scene/scene.h"

namespace soffit {

/// Tells requests apart, over all clients and for ever. A resent request keeps its id; the reply carries it.
struct RequestId {
  std::array<std::uint8_t, 16> client{};  ///< Drawn at random by every client when it starts.
  std::uint32_t sequence = 0;

  friend bool operator==(const RequestId&, const RequestId&) = default;
};

enum class MissionRequestKind { kNone, kStart, kPause, kResume, kAbort };

struct MissionRequest {
  RequestId id;
  MissionRequestKind kind = MissionRequestKind::kNone;
  std::uint32_t vehicle_id = 0;
  std::uint64_t mission_id = 0;  ///< 0: the one that the vehicle flies now.
  std::string reference_name;
  std::vector<std::uint8_t> reference;  ///< kStart: a PNG or JPEG.
  Eigen::Vector2d area_center_in_map_m = Eigen::Vector2d::Zero();
  double area_radius_m = 0.0;
};

struct MissionReply {
  RequestId id;
  bool is_accepted = false;
  std::uint64_t mission_id = 0;
  std::string message;
};

/// Whose, and of what state of the scene, something is that the service publishes.
struct Origin {
  std::uint32_t vehicle_id = 0;
  std::uint64_t mission_id = 0;
  std::uint64_t scene_revision = 0;
};

struct MissionReport {
  std::uint32_t vehicle_id = 0;
  std::uint64_t mission_id = 0;
  std::uint32_t revision = 0;  ///< Counts the reports of this mission.
  std::int64_t started_utc_ns = 0;
  std::int64_t stamp_utc_ns = 0;
  MissionStatus status;
  std::uint32_t pictures_received = 0;
  std::uint32_t pictures_used = 0;
  double picture_to_decision_s =
      0.0;  ///< From the arrival of the newest picture to what it allowed; 0: none yet.
  double picture_to_decision_max_s = 0.0;
};

struct SceneObjectReport {
  Origin origin;
  SceneObject object;
};

struct BuildingModelReport {
  Origin origin;
  std::uint32_t object_id = 0;
  Mesh mesh;
  double volume_m3 = 0.0;
  std::vector<SolidOpening> openings;
};

struct DecisionReport {
  std::uint64_t mission_id = 0;
  std::int64_t decided_utc_ns = 0;
  std::int64_t valid_until_utc_ns = 0;
  ClearanceDecision decision;
};

enum class SceneQueryKind {
  kNone,
  kPoint,
  kBox,
  kRay,
  kNearest,
  kColumn,
  kObjects,
  kClearance,
  kWay,
  kPath,
  kChanges,
  kRevisions,
};

/// See idl/soffit.idl for which fields count for which kind.
struct SceneQuery {
  RequestId id;
  SceneQueryKind kind = SceneQueryKind::kNone;
  std::uint32_t vehicle_id = 0;
  std::uint64_t scene_revision = 0;
  double timeout_s = 0.0;
  Eigen::Vector3d from_in_map_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d to_in_map_m = Eigen::Vector3d::Zero();
  double range_m = 0.0;
  double resolution_m = 0.0;
  std::uint32_t object_id = 0;
  std::string reference_name;
  VehicleEnvelope vehicle;
  std::uint64_t since_revision = 0;

  /// Not empty: what is wrong with the message; then only `id` is to be trusted. So that it can be answered.
  std::string problem;
};

enum class AnswerStatus {
  kNone,
  kOk,
  kBadRequest,
  kNoScene,
  kNoRevision,
  kNotFound,
  kTooLarge,
  kTooLate,
  kFailed,
};
const char* ToString(AnswerStatus status);

struct Nearest {
  bool is_found = false;
  double distance_m = 0.0;
  Eigen::Vector3d point_in_map_m = Eigen::Vector3d::Zero();
  std::uint32_t object_id = 0;
};

enum class ChangeKind { kNone, kAdded, kChanged, kRemoved };
enum class ChangedThing { kObject, kModel, kDecision };
const char* ToString(ChangeKind kind);
const char* ToString(ChangedThing thing);

struct Change {
  ChangeKind kind = ChangeKind::kNone;
  ChangedThing thing = ChangedThing::kObject;
  std::uint32_t object_id = 0;
  int side = -1;

  friend bool operator==(const Change&, const Change&) = default;
};

struct Revision {
  std::uint64_t mission_id = 0;
  std::uint64_t scene_revision = 0;
  std::int64_t stamp_utc_ns = 0;
  std::uint32_t objects = 0;
  std::uint32_t models = 0;
  std::uint32_t decisions = 0;
  std::uint64_t octree_nodes = 0;
  bool is_kept = false;
};

/// As idl/soffit.idl bounds a reply.
inline constexpr std::size_t kMaxReplyGridCells = 262'144;
inline constexpr std::size_t kMaxReplyCells = 4096;
inline constexpr std::size_t kMaxReplyObjects = 64;
inline constexpr std::size_t kMaxReplyPoints = 1024;
inline constexpr std::size_t kMaxReplyChanges = 1024;

/// See idl/soffit.idl for which fields answer which kind.
struct SceneReply {
  RequestId id;
  AnswerStatus status = AnswerStatus::kNone;
  std::string message;
  Origin origin;
  std::int64_t stamp_utc_ns = 0;
  double resolution_m = 0.0;

  Occupancy occupancy = Occupancy::kUnknown;
  Shares shares;
  CellGrid grid;
  std::vector<Cell> cells;
  bool has_more = false;

  RayEnd ray = RayEnd::kUnknown;
  double distance_m = 0.0;
  Eigen::Vector3d point_in_map_m = Eigen::Vector3d::Zero();

  Nearest nearest_occupied;
  Nearest nearest_unknown;
  Nearest surface;

  std::vector<Layer> layers;
  std::optional<double> height_m;

  std::vector<SceneObjectReport> objects;
  std::vector<double> distances_m;
  std::optional<BuildingModelReport> model;

  std::vector<DecisionReport> decisions;
  Verdict verdict = Verdict::kInsufficientData;
  std::vector<Eigen::Vector3d> path_in_map_m;

  std::vector<Change> changes;
  std::uint64_t changed_cells = 0;
  Eigen::AlignedBox3d changed_in_map_m;  ///< Empty when no cell changed.

  std::vector<Revision> revisions;
};

}  // namespace soffit
