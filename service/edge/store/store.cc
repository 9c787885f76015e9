#include "service/edge/store/store.h"

#include <filesystem>
#include <set>
#include <stdexcept>

#include "service/edge/files/map_file.h"
#include "shared/result/say.h"

namespace soffit {
namespace {

namespace fs = std::filesystem;

constexpr char kVersion[] = "soffit-store/2";
constexpr char kLocal[] = "_local";  ///< Ends the names of layers in the map's own metres.

bool IsDatabase(const std::string& place) { return place.starts_with("PG:"); }

/// A connection string may hold a password.
std::string NameOf(const std::string& place) { return IsDatabase(place) ? "the PostGIS store" : place; }

std::int64_t Id(std::uint64_t id) { return static_cast<std::int64_t>(id); }

std::string Where(std::uint64_t mission_id) { return Say(" WHERE mission_id = ", mission_id); }

/// As tables without rows, so that every store has all that is read.
std::vector<GisLayer> Tables() {
  return {{"missions",
           GisShape::kNone,
           {{"mission_id", GisType::kInteger},
            {"vehicle_id", GisType::kInteger},
            {"started_utc_ns", GisType::kInteger},
            {"reference", GisType::kText},
            {"state", GisType::kText},
            {"step", GisType::kText},
            {"outcome", GisType::kText},
            {"message", GisType::kText},
            {"record", GisType::kText}},
           {}},
          {"scenes",
           GisShape::kNone,
           {{"mission_id", GisType::kInteger},
            {"scene_revision", GisType::kInteger},
            {"stamp_utc_ns", GisType::kInteger},
            {"objects", GisType::kInteger},
            {"models", GisType::kInteger},
            {"decisions", GisType::kInteger},
            {"octree_nodes", GisType::kInteger},
            {"record", GisType::kText},
            {"octree", GisType::kBytes}},
           {}},
          {"captures",
           GisShape::kNone,
           {{"mission_id", GisType::kInteger}, {"capture_id", GisType::kInteger}, {"record", GisType::kText}},
           {}},
          {"journal",
           GisShape::kNone,
           {{"mission_id", GisType::kInteger},
            {"utc_ns", GisType::kInteger},
            {"kind", GisType::kText},
            {"text", GisType::kText}},
           {}}};
}
enum Table { kMissions, kScenes, kCaptures, kJournal };

GisLayer TableWith(Table table, std::vector<GisValue> values) {
  GisLayer layer = Tables().at(table);
  layer.features = {{{}, std::move(values)}};
  return layer;
}

GisLayer VersionRow() {
  return {"soffit_store", GisShape::kNone, {{"version", GisType::kText}}, {{{}, {std::string(kVersion)}}}};
}

template <class T>
T Take(const GisValue& value) {
  if (const T* taken = std::get_if<T>(&value)) return *taken;
  throw std::runtime_error("the store is damaged: a value is missing");
}

template <class T>
T Take(Result<T> result) {
  if (!result.ok()) throw std::runtime_error("the store is damaged: " + result.error().message);
  return std::move(result).value();
}

/// The layer with one more column in front, that is the same in all its rows.
GisLayer WithColumn(const char* name, std::uint64_t id, GisLayer layer) {
  layer.columns.insert(layer.columns.begin(), {name, GisType::kInteger});
  for (GisFeature& feature : layer.features) {
    std::vector<GisValue> values = {Id(id)};
    for (GisValue& value : feature.values) values.push_back(std::move(value));
    feature.values = std::move(values);
  }
  return layer;
}

void Prepare(GisDataset& dataset) {
  dataset.Begin();
  for (const GisLayer& table : Tables()) dataset.Add(table);
  dataset.Add(VersionRow());
  dataset.Commit();
}

/// Of a place that has something in it.
void CheckVersion(GisDataset& dataset) {
  if (!dataset.Has("soffit_store")) {
    throw std::runtime_error(
        "it belongs to something else (it has no table soffit_store): name another place for the store");
  }
  const auto rows = dataset.Select("SELECT version FROM soffit_store");
  const auto version = rows.empty() ? std::string("nothing") : Take<std::string>(rows.front().front());
  if (version != kVersion)
    throw std::runtime_error("it is of version " + version + ", this program keeps " + kVersion);
}

GisDataset OpenDataset(const std::string& place, bool is_read_only) {
  if (IsDatabase(place)) {
    GisDataset dataset = GisDataset::Open(place, is_read_only);
    if (!dataset.Has("soffit_store") && !is_read_only) {
      dataset.Execute("CREATE EXTENSION IF NOT EXISTS postgis");
      // GDAL learns at its start what the database can do.
      dataset = GisDataset::Open(place, is_read_only);
      Prepare(dataset);
    }
    return dataset;
  }
  if (is_read_only || fs::exists(place)) return GisDataset::Open(place, is_read_only);
  // Made aside: a process that is killed meanwhile leaves no half-made store.
  const std::string part = place + ".new.gpkg";
  fs::remove(part);
  {
    GisDataset dataset = GisDataset::CreateFile(part);
    Prepare(dataset);
  }
  fs::rename(part, place);
  return GisDataset::Open(place, is_read_only);
}

}  // namespace

Result<Store> Store::Open(const std::string& place, bool is_read_only) try {
  GisDataset dataset = OpenDataset(place, is_read_only);
  CheckVersion(dataset);
  return Store(std::move(dataset));
} catch (const std::exception& problem) {
  return Error{Error::Code::kUnavailable, NameOf(place) + ": " + problem.what()};
}

// ---- Writing ----

/// A layer's features as those of one mission.
void Store::AddLayer(GisLayer layer, std::uint64_t mission_id, const std::optional<GeodeticOrigin>& origin) {
  if (layer.shape != GisShape::kNone && !origin) layer.name += kLocal;
  dataset_.Add(WithColumn("mission_id", mission_id, std::move(layer)),
               origin ? GisFrame::InDegrees(*origin) : GisFrame::InMetres(std::nullopt));
}

void Store::PutMission(const MissionRecord& mission) {
  dataset_.Execute("DELETE FROM missions" + Where(mission.mission_id));
  dataset_.Add(TableWith(kMissions, {Id(mission.mission_id), std::int64_t{mission.vehicle_id},
                                     mission.started_utc_ns, mission.reference_name, mission.state,
                                     mission.step, mission.outcome, mission.message, mission.text}));
}

void Store::Touch() { dataset_.Execute("UPDATE soffit_store SET version = version"); }

void Store::AddToJournal(std::uint64_t mission_id, const std::vector<JournalEntry>& entries) {
  GisLayer journal = Tables().at(kJournal);
  for (const JournalEntry& entry : entries)
    journal.features.push_back({{}, {Id(mission_id), entry.utc_ns, entry.kind, entry.text}});
  dataset_.Add(journal);
}

void Store::AddCapture(const Capture& capture, const std::optional<GeodeticOrigin>& origin) {
  dataset_.Add(TableWith(kCaptures,
                         {Id(capture.mission_id), std::int64_t{capture.capture_id}, WriteCapture(capture)}));
  AddLayer(DescribeViewpoints({{capture.capture_id, capture.name, capture.purpose, capture.map_from_camera,
                                capture.position_std_m, capture.has_trusted_pose}}),
           capture.mission_id, origin);
}

void Store::AddScene(const SceneSnapshot& snapshot, const std::optional<GeodeticOrigin>& origin) {
  const std::uint64_t mission_id = snapshot.origin.mission_id;
  const Revision revision = DescribeRevision(snapshot);
  const std::string octree = EncodeMap(*snapshot.understanding->scene.octree, MapFormat::kBinary);
  dataset_.Add(TableWith(
      kScenes,
      {Id(mission_id), Id(revision.scene_revision), revision.stamp_utc_ns, std::int64_t{revision.objects},
       std::int64_t{revision.models}, std::int64_t{revision.decisions}, Id(revision.octree_nodes),
       WriteScene(snapshot), std::vector<std::uint8_t>(octree.begin(), octree.end())}));
  if (revision.scene_revision > kKeptRevisions) {
    dataset_.Execute(Say("UPDATE scenes SET octree = NULL", Where(mission_id),
                         " AND scene_revision <= ", revision.scene_revision - kKeptRevisions));
  }

  std::vector<ClearanceDecision> decisions;
  for (const DecisionReport& report : snapshot.decisions) decisions.push_back(report.decision);
  for (GisLayer layer : {DescribeFootprints(snapshot.understanding->scene),
                         DescribeOpenings(snapshot.understanding->scene), DescribeCorridors(decisions)}) {
    for (const std::string& name : {layer.name, layer.name + kLocal}) {
      if (dataset_.Has(name)) dataset_.Execute("DELETE FROM " + name + Where(mission_id));
    }
    AddLayer(std::move(layer), mission_id, origin);
  }
  AddLayer(WithColumn("scene_revision", revision.scene_revision, DescribeDecisions(decisions)), mission_id,
           origin);
}

void Store::AddTrack(std::uint64_t mission_id, const std::vector<TrackPoint>& points,
                     const std::optional<GeodeticOrigin>& origin) {
  GisLayer layer{"tracks",
                 GisShape::kPoint,
                 {{"time_s", GisType::kReal},
                  {"x_m", GisType::kReal},
                  {"y_m", GisType::kReal},
                  {"z_m", GisType::kReal},
                  {"yaw_rad", GisType::kReal}},
                 {}};
  for (const TrackPoint& point : points) {
    const Eigen::Vector3d& p = point.position_in_map_m;
    layer.features.push_back({{{p}}, {point.time_s, p.x(), p.y(), p.z(), point.yaw_rad}});
  }
  AddLayer(std::move(layer), mission_id, origin);
}

// ---- Reading ----

std::vector<KeptRun> Store::ReadNewest() {
  std::vector<KeptRun> runs;
  const auto rows = dataset_.Select(
      "SELECT record FROM missions WHERE mission_id IN (SELECT MAX(mission_id) FROM missions GROUP BY "
      "vehicle_id)");
  for (const auto& row : rows) runs.push_back(ReadRun(Take<std::string>(row.front())));
  return runs;
}

KeptRun Store::ReadRun(const std::string& record) {
  KeptRun run{Take(soffit::ReadMission(record)), {}, {}};
  const std::string where = Where(run.mission.mission.order.mission_id);
  for (const auto& row : dataset_.Select("SELECT record FROM captures" + where + " ORDER BY capture_id"))
    run.mission.captures.push_back(Take(ReadCapture(Take<std::string>(row[0]))));
  for (const std::string& track : {std::string("tracks"), std::string("tracks") + kLocal}) {
    if (!dataset_.Has(track)) continue;
    const std::string select =
        Say("SELECT time_s, x_m, y_m, z_m, yaw_rad FROM ", track, where, " ORDER BY time_s");
    for (const auto& row : dataset_.Select(select)) {
      run.mission.log.track.push_back({Take<double>(row[0]),
                                       {Take<double>(row[1]), Take<double>(row[2]), Take<double>(row[3])},
                                       Take<double>(row[4])});
    }
  }
  const std::string numbers =
      "SELECT scene_revision, stamp_utc_ns, objects, models, decisions, octree_nodes FROM scenes";
  const auto number = [](const GisValue& value) { return Take<std::int64_t>(value); };
  for (const auto& row : dataset_.Select(Say(numbers, where, " ORDER BY scene_revision"))) {
    run.revisions.push_back(
        {run.mission.mission.order.mission_id, static_cast<std::uint64_t>(number(row[0])), number(row[1]),
         static_cast<std::uint32_t>(number(row[2])), static_cast<std::uint32_t>(number(row[3])),
         static_cast<std::uint32_t>(number(row[4])), static_cast<std::uint64_t>(number(row[5])), false});
  }
  const std::string select =
      Say("SELECT record, octree FROM scenes", where, " AND octree IS NOT NULL ORDER BY scene_revision");
  for (const auto& row : dataset_.Select(select)) {
    auto octree = Take(DecodeMap(Take<std::vector<std::uint8_t>>(row[1])));
    run.scenes.push_back(
        std::make_shared<SceneSnapshot>(Take(ReadScene(Take<std::string>(row[0]), std::move(octree)))));
  }
  return run;
}

}  // namespace soffit
