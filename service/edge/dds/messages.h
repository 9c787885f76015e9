#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "service/clearance/clearance.h"
#include "service/mission/mission.h"
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

enum class SceneQueryKind { kNone, kPoint, kBox, kObject, kClearance };
enum class Occupancy { kUnknown, kFree, kOccupied };
const char* ToString(Occupancy occupancy);

struct SceneQuery {
  RequestId id;
  SceneQueryKind kind = SceneQueryKind::kNone;
  std::uint32_t vehicle_id = 0;                            ///< Whose mission's scene.
  std::uint32_t object_id = 0;                             ///< kObject, kClearance.
  Eigen::Vector3d min_in_map_m = Eigen::Vector3d::Zero();  ///< kPoint: the point. kBox: its lowest corner.
  Eigen::Vector3d max_in_map_m = Eigen::Vector3d::Zero();  ///< kBox.
};

struct SceneReply {
  RequestId id;
  bool is_answered = false;  ///< False: `message` says why, the rest means nothing.
  std::string message;
  std::uint64_t scene_revision = 0;
  Occupancy occupancy =
      Occupancy::kUnknown;  ///< Of a box: occupied if any of it is, else unknown if any of it is.
  double free_ratio = 0.0;
  double occupied_ratio = 0.0;
  double unknown_ratio = 0.0;
  std::optional<SceneObjectReport> object;
  std::optional<BuildingModelReport> model;
  std::vector<DecisionReport> decisions;
};

}  // namespace soffit
