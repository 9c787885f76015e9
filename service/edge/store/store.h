#pragma once

#include <string>
#include <vector>

#include "service/edge/files/gis_dataset.h"
#include "service/edge/store/kept.h"

namespace soffit {

/// One line of a mission's journal.
struct JournalEntry {
  std::int64_t utc_ns = 0;
  std::string kind;  ///< "command", "answer", "step", "problem", "scene", "end".
  std::string text;
};

/// A mission as it was found again, with its scenes.
struct KeptRun {
  KeptMission mission;
  std::vector<Revision> revisions;                           ///< All, oldest first.
  std::vector<std::shared_ptr<const SceneSnapshot>> scenes;  ///< The newest of them, oldest first.
};

/// Where missions are kept: a GeoPackage that opens in QGIS as it is, or a PostGIS database.
///
/// For people and other programs it has the layers `footprints`, `openings`, `corridors` (each mission's
/// newest scene), `viewpoints` and `tracks`, in WGS 84 with heights above the sea; of a mission whose origin
/// is not known, the same layers in the map's own metres (`footprints_local`, ...). The tables `missions`,
/// `scenes` and `decisions` (every revision) and `journal` tell the rest; their columns `record` are what
/// this class reads again.
///
/// All functions but Open() throw std::runtime_error when the store cannot be written or read; what was not
/// committed then is not there. Not thread-safe.
class Store {
 public:
  /// Opens the store, which is made where there is none. An error, that says which, when `place` is something
  /// else, is damaged, is of another version, or cannot be written (and `is_read_only` is not asked for).
  static Result<Store> Open(const std::string& place, bool is_read_only);

  void Begin() { dataset_.Begin(); }
  void Commit() { dataset_.Commit(); }
  void Rollback() noexcept { dataset_.Rollback(); }

  /// Replaces what was kept of the mission.
  void PutMission(const MissionRecord& mission);
  void AddToJournal(std::uint64_t mission_id, const std::vector<JournalEntry>& entries);
  void AddCapture(const Capture& capture, const std::optional<GeodeticOrigin>& origin);
  /// One more revision; it is the newest, and what the layers show.
  void AddScene(const SceneSnapshot& snapshot, const std::optional<GeodeticOrigin>& origin);
  void AddTrack(std::uint64_t mission_id, const std::vector<TrackPoint>& points,
                const std::optional<GeodeticOrigin>& origin);

  /// Changes nothing, but has to be able to.
  void Touch();

  /// The newest mission of each vehicle.
  std::vector<KeptRun> ReadNewest();

 private:
  explicit Store(GisDataset dataset) : dataset_(std::move(dataset)) {}
  void AddLayer(GisLayer layer, std::uint64_t mission_id, const std::optional<GeodeticOrigin>& origin);
  KeptRun ReadRun(const std::string& record);

  GisDataset dataset_;
};

}  // namespace soffit
