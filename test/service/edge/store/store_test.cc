#include "service/edge/store/store.h"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>

#include "service/edge/files/file.h"
#include "service/edge/files/map_file.h"
#include "service/edge/store/keeper.h"
#include "test/support/arch_scene.h"
#include "test/support/postgres.h"

namespace soffit {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

const std::optional<GeodeticOrigin> kOrigin = GeodeticOrigin{50.06, 19.94, 210.0};
constexpr double kInfinity = std::numeric_limits<double>::infinity();

KeptMission SomeMission(std::uint64_t mission_id, std::uint32_t vehicle_id) {
  KeptMission kept;
  kept.mission = StartMission({vehicle_id, mission_id, {1.0, 2.0}, 30.0});
  kept.mission.status.state = MissionState::kFlying;
  kept.mission.status.step = MissionStep::kWalls;
  kept.mission.status.problems = {"a \"quoted\" problem; DROP TABLE missions", "\xff is no UTF-8"};
  VehicleState vehicle;
  vehicle.vehicle_id = vehicle_id;
  vehicle.agent_epoch = std::numeric_limits<std::uint64_t>::max();
  vehicle.envelope = {0.35, 0.3, 0.25};
  vehicle.origin = kOrigin;
  kept.mission.vehicle = vehicle;
  Errand errand;
  errand.command.kind = CommandKind::kFlyCorridor;
  errand.command.sequence = 7;
  errand.command.path_in_map_m = {{1, 2, 3}, {0.1, 1e-17, kInfinity}};
  errand.command.permit = CorridorPermit{99, 1, 7, 123, {0.35, 0.3, 0.25}, 1.6, 1.4};
  kept.mission.errand = errand;
  kept.mission.pictures = {{1, ""}, {2, "too dark"}};
  kept.mission.views = {Viewpoint{Purpose::kWall, {1, 2, 3}, 0.5, 0.1, 1, 2, "the far side"}};
  kept.mission.leave = test::ArchUnderstanding().decisions.front();
  kept.findings_revision = 7;
  kept.request_id.client[15] = 0xff;
  kept.request_id.sequence = 3;
  kept.reference_name = "it's.png";
  kept.started_utc_ns = 1'700'000'000'123'456'789;
  kept.log.steps = {{MissionStep::kOverview, 1.5}};
  kept.log.pictures = {{1, "pictures/0001_overview.jpg", Purpose::kOverview, 2.0, 2.5, -1.0, ""}};
  kept.log.report.revision = 12;
  return kept;
}

Capture SomeCapture(std::uint64_t mission_id, std::uint32_t capture_id) {
  Capture capture;
  capture.vehicle_id = 1;
  capture.mission_id = mission_id;
  capture.capture_id = capture_id;
  capture.name = "pictures/" + std::to_string(capture_id) + ".jpg";
  capture.purpose = Purpose::kWall;
  capture.intrinsics = {1280, 960, 850.1, 850.2, 639.5, 479.5, {0.1, 0, 0, 0, -0.01}};
  capture.map_from_camera = {CameraAttitude(0.3, -0.2), {1.0, 2.0, 1.2}};
  capture.has_trusted_pose = true;
  capture.position_std_m = 0.02;
  return capture;
}

SceneSnapshot SomeScene(std::uint64_t mission_id, std::uint64_t revision) {
  auto all = std::make_shared<Understanding>(test::ArchUnderstanding());
  all->scene.revision = revision;
  all->scene.clutter = {{{1, 2, 0}, 0.3, 0.0, false, 0.1, {1, 2}}};
  SceneSnapshot snapshot;
  snapshot.origin = {1, mission_id, revision};
  snapshot.stamp_utc_ns = 1'700'000'000'000'000'000 + static_cast<std::int64_t>(revision);
  snapshot.decisions = {{mission_id, 1, 2, all->decisions.front()}};
  snapshot.decisions.front().decision.decision_id = 40 + revision;
  snapshot.decisions.front().decision.evidence = {1, 2};
  snapshot.vehicle = {0.35, 0.3, 0.25};
  snapshot.reference_name = "arch.png";
  snapshot.understanding = all;
  return snapshot;
}

std::string Same(const SceneSnapshot& scene) {
  return WriteScene(scene) + EncodeMap(*scene.understanding->scene.octree, MapFormat::kBinary);
}

/// A folder for a store, and the same tests for a store in a file and one in PostgreSQL.
class StoreFolder : public ::testing::Test {
 protected:
  StoreFolder() {
    char folder[] = "/tmp/soffit-store-XXXXXX";
    folder_ = mkdtemp(folder);
    place_ = folder_ / "soffit.gpkg";
  }
  ~StoreFolder() override { fs::remove_all(folder_); }

  static Store OpenOrDie(const std::string& place) {
    Result<Store> store = Store::Open(place, false);
    if (!store.ok()) throw std::runtime_error(store.error().message);
    return std::move(store).value();
  }

  void KeepsEverything(const std::string& place) const {
    const KeptMission mission = SomeMission(5, 1);
    {
      Store store = OpenOrDie(place);
      store.Begin();
      store.PutMission(WriteMission(SomeMission(4, 1)));  // An older one of the same vehicle.
      store.PutMission(WriteMission(SomeMission(3, 2)));
      store.Commit();
      store.Begin();
      store.PutMission(WriteMission(mission));
      store.PutMission(WriteMission(mission));  // Replaces.
      store.AddCapture(SomeCapture(5, 2), kOrigin);
      store.AddCapture(SomeCapture(5, 1), kOrigin);
      store.AddToJournal(5, {{1, "command", "look"}, {2, "answer", "done"}});
      store.AddTrack(5, {{0.5, {1, 2, 3}, 0.25}, {0.6, {1.5, 2, 3}, 0.5}}, kOrigin);
      for (std::uint64_t revision = 1; revision <= 10; ++revision)
        store.AddScene(SomeScene(5, revision), kOrigin);
      store.Commit();
      store.Begin();
      store.PutMission(WriteMission(SomeMission(6, 1)));  // Never committed.
      store.Rollback();
    }
    std::vector<KeptRun> runs = OpenOrDie(place).ReadNewest();
    ASSERT_THAT(runs, SizeIs(2));
    if (runs[0].mission.mission.order.vehicle_id != 1) std::swap(runs[0], runs[1]);
    EXPECT_EQ(runs[1].mission.mission.order.mission_id, 3U);
    const KeptRun& run = runs[0];
    EXPECT_EQ(WriteMission(run.mission), WriteMission(mission));
    ASSERT_THAT(run.mission.captures, SizeIs(2));
    EXPECT_EQ(WriteCapture(run.mission.captures[0]), WriteCapture(SomeCapture(5, 1)));
    ASSERT_THAT(run.mission.log.track, SizeIs(2));
    EXPECT_EQ(run.mission.log.track[1].position_in_map_m, Eigen::Vector3d(1.5, 2, 3));
    EXPECT_THAT(run.revisions, SizeIs(10));
    EXPECT_EQ(run.revisions[3].octree_nodes, SomeScene(5, 4).understanding->scene.octree->size());
    ASSERT_THAT(run.scenes, SizeIs(kKeptRevisions));
    for (std::size_t i = 0; i < run.scenes.size(); ++i)
      EXPECT_TRUE(Same(*run.scenes[i]) == Same(SomeScene(5, i + 3)));
  }

  fs::path folder_;
  std::string place_;
};

using StoreTest = StoreFolder;

TEST_F(StoreTest, KeepsEverythingInAGeoPackage) { KeepsEverything(place_); }

TEST_F(StoreTest, KeepsLevelsBendsAndThePicturesOfFaces) {
  auto all = std::make_shared<Understanding>(test::ArchUnderstanding());
  Footprint footprint = test::BoxFootprint(2, "blue", 0, 0, 6, 5, 4.0);
  footprint.levels = {{2.0, {0, 0.2, 0, 0}}, {2.0, {0, 0.2, 1.5, 0}}, {4.0, {0, 0.2, 1.5, 0}}};
  all->scene.objects[1].footprint = footprint;
  all->scene.solids.push_back(RaiseSolid(footprint, {}).value());
  all->decisions[0].corridor->bends_in_map_m = {{2.0, 0.7, 0.7}};
  SceneSnapshot snapshot = SomeScene(5, 1);
  snapshot.understanding = all;
  Store store = OpenOrDie(place_);
  store.Begin();
  store.PutMission(WriteMission(SomeMission(5, 1)));
  store.AddScene(snapshot, std::nullopt);
  store.Commit();
  const std::vector<KeptRun> runs = store.ReadNewest();
  ASSERT_THAT(runs, SizeIs(1));
  const Understanding& kept = *runs[0].scenes.at(0)->understanding;
  for (const Footprint& read : {kept.scene.objects[1].footprint, kept.scene.solids[1].footprint}) {
    ASSERT_THAT(read.levels, SizeIs(3));
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(read.levels[i].height_m, footprint.levels[i].height_m);
      EXPECT_EQ(read.levels[i].inset_m, footprint.levels[i].inset_m);
    }
  }
  EXPECT_EQ(kept.decisions[0].corridor->bends_in_map_m, all->decisions[0].corridor->bends_in_map_m);
  const std::vector<Face>&faces = all->scene.solids[0].faces, &read = kept.scene.solids[0].faces;
  ASSERT_THAT(read, SizeIs(faces.size()));
  for (std::size_t i = 0; i < faces.size(); ++i) {
    EXPECT_EQ(read[i].kind, faces[i].kind);
    EXPECT_EQ(read[i].triangles, faces[i].triangles);
    ASSERT_EQ(read[i].picture.has_value(), faces[i].picture.has_value());
    if (!faces[i].picture) continue;
    EXPECT_EQ(read[i].picture->capture_id, faces[i].picture->capture_id);
    EXPECT_EQ(read[i].picture->outline_px.outer, faces[i].picture->outline_px.outer);
  }
}

TEST_F(StoreTest, ShowsTheNewestSceneWhereItIsOnEarth) {
  Store store = OpenOrDie(place_);
  store.Begin();
  store.AddScene(SomeScene(5, 1), kOrigin);
  store.AddScene(SomeScene(5, 2), kOrigin);
  store.AddScene(SomeScene(6, 1), std::nullopt);
  store.AddCapture(SomeCapture(5, 1), kOrigin);
  store.Commit();
  GisDataset dataset = GisDataset::Open(place_, true);
  const auto count = [&](const std::string& layer) {
    return std::get<std::int64_t>(dataset.Select("SELECT COUNT(*) FROM " + layer)[0][0]);
  };
  EXPECT_EQ(count("footprints"), 2);
  EXPECT_EQ(count("openings"), 2);
  EXPECT_EQ(count("corridors"), 1);
  EXPECT_EQ(count("decisions"), 3);  // Of all revisions.
  EXPECT_EQ(count("footprints_local"), 2);
  EXPECT_EQ(count("layer_styles WHERE f_table_name = 'footprints'"), 1);
  const auto x = dataset.Select("SELECT ST_MinX(geom), ST_MinY(geom) FROM viewpoints")[0];
  EXPECT_NEAR(std::get<double>(x[0]), 19.94 + 1.0 / 71'600.0, 1e-6);
  EXPECT_NEAR(std::get<double>(x[1]), 50.06 + 2.0 / 111'200.0, 1e-6);
}

TEST_F(StoreTest, RefusesWhatBelongsToSomethingElse) {
  {
    GisDataset foreign = GisDataset::CreateFile(place_);
    foreign.Begin();
    foreign.Add({"roads", GisShape::kNone, {{"name", GisType::kText}}, {{{}, {std::string("A4")}}}});
    foreign.Commit();
  }
  const auto store = Store::Open(place_, false);
  ASSERT_FALSE(store.ok());
  EXPECT_THAT(store.error().message, HasSubstr(place_));
  EXPECT_THAT(store.error().message, HasSubstr("belongs to something else"));
}

TEST_F(StoreTest, RefusesAnotherVersion) {
  { Store store = OpenOrDie(place_); }
  GisDataset::Open(place_, false).Execute("UPDATE soffit_store SET version = 'soffit-store/9'");
  EXPECT_THAT(Store::Open(place_, false).error().message, HasSubstr("soffit-store/9"));
}

TEST_F(StoreTest, RefusesWhatIsNoGeoPackage) {
  ASSERT_TRUE(WriteFile(place_, "not a database").ok());
  EXPECT_THAT(Store::Open(place_, false).error().message, HasSubstr("GeoPackage"));
  ASSERT_TRUE(WriteFile(place_, "").ok());
  EXPECT_FALSE(Store::Open(place_, false).ok());
  fs::remove(place_);
  fs::create_directory(place_);
  EXPECT_FALSE(Store::Open(place_, false).ok());
  EXPECT_FALSE(Store::Open("/proc/no/such/soffit.gpkg", false).ok());
  EXPECT_FALSE(Store::Open(folder_ / "none.gpkg", true).ok());
  EXPECT_FALSE(fs::exists(folder_ / "none.gpkg"));  // Who only reads makes nothing.
}

TEST_F(StoreTest, TellsDamageAndNeverCrashes) {
  {
    Store store = OpenOrDie(place_);
    store.Begin();
    store.PutMission(WriteMission(SomeMission(5, 1)));
    store.AddScene(SomeScene(5, 1), kOrigin);
    store.Commit();
  }
  const auto whole = ReadFile(place_, 100 << 20).value();
  const auto write = [&](const std::vector<std::uint8_t>& bytes) {
    for (const char* rest : {"-wal", "-shm"}) fs::remove(place_ + rest);
    ASSERT_TRUE(WriteFile(place_, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}).ok());
  };
  int told = 0;
  for (std::size_t page = 0; page < whole.size(); page += 4096) {
    std::vector<std::uint8_t> broken = whole;
    std::fill_n(broken.begin() + static_cast<std::ptrdiff_t>(page), 4096, std::uint8_t{0xff});
    write(broken);
    try {
      auto store = Store::Open(place_, false);
      if (!store.ok()) {
        EXPECT_THAT(store.error().message, HasSubstr(place_));
        ++told;
      } else {
        (void)store.value().ReadNewest();
      }
    } catch (const std::runtime_error&) {
      ++told;
    }
  }
  EXPECT_GT(told, 3);
  write({whole.begin(), whole.begin() + 10'000});
  try {
    auto store = Store::Open(place_, false);
    EXPECT_TRUE(!store.ok() || store.value().ReadNewest().empty());
  } catch (const std::runtime_error& damage) {
    EXPECT_THAT(damage.what(), ::testing::Not(HasSubstr("bug")));
  }
}

TEST_F(StoreTest, RefusesARecordThatLies) {
  {
    Store store = OpenOrDie(place_);
    store.Begin();
    store.PutMission(WriteMission(SomeMission(5, 1)));
    store.Commit();
  }
  GisDataset::Open(place_, false)
      .Execute("UPDATE missions SET record = REPLACE(record, '\"step\":6', '\"step\":99')");
  Store store = OpenOrDie(place_);
  try {
    store.ReadNewest();
    FAIL() << "an unknown step was taken";
  } catch (const std::runtime_error& problem) {
    EXPECT_THAT(problem.what(), HasSubstr("mission.status.step must be a known value"));
  }
}

/// What a process had committed when it was killed, told through a pipe.
TEST_F(StoreTest, LosesNothingThatWasCommittedWhenItIsKilled) {
  std::uint64_t least = 0;
  for (int round = 0; round < 6; ++round) {
    int told[2];
    ASSERT_EQ(pipe(told), 0);
    const pid_t child = fork();
    if (child == 0) {
      Store store = OpenOrDie(place_);
      for (std::uint64_t revision = least + 1;; ++revision) {
        store.Begin();
        store.PutMission(WriteMission(SomeMission(5, 1)));
        store.AddScene(SomeScene(5, revision), kOrigin);
        store.Commit();
        if (write(told[1], &revision, sizeof(revision)) < 0) _exit(1);
      }
    }
    close(told[1]);
    std::uint64_t committed = 0;
    ASSERT_EQ(read(told[0], &committed, sizeof(committed)), static_cast<ssize_t>(sizeof(committed)));
    std::this_thread::sleep_for(std::chrono::milliseconds(37 * round));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    while (read(told[0], &committed, sizeof(committed)) == sizeof(committed)) continue;
    close(told[0]);
    const auto runs = OpenOrDie(place_).ReadNewest();
    ASSERT_THAT(runs, SizeIs(1));
    least = runs[0].revisions.back().scene_revision;
    EXPECT_GE(least, committed);
    EXPECT_TRUE(Same(*runs[0].scenes.back()) == Same(SomeScene(5, least)));
  }
  EXPECT_GT(least, 0U);
}

// ---- The keeper ----

/// The largest file that this process can write, as a disk that is full would have it.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    previous_ = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, previous_);
  }

 private:
  rlimit before_{};
  void (*previous_)(int);
};

class KeeperTest : public StoreFolder {
 protected:
  void Note(const std::string& trouble) {
    const std::lock_guard lock(mutex_);
    troubles_.push_back(trouble);
  }
  std::vector<std::string> Troubles() {
    const std::lock_guard lock(mutex_);
    return troubles_;
  }
  Keeper::OnTrouble OnTrouble() {
    return [this](const std::string& trouble) { Note(trouble); };
  }
  static Keeper::Task Put(std::uint64_t mission_id) {
    return [mission_id](Store& store) {
      store.PutMission(WriteMission(SomeMission(mission_id, static_cast<std::uint32_t>(mission_id))));
    };
  }
  std::set<std::uint64_t> Kept() const {
    std::set<std::uint64_t> ids;
    for (const KeptRun& run : OpenOrDie(place_).ReadNewest())
      ids.insert(run.mission.mission.order.mission_id);
    return ids;
  }

  std::mutex mutex_;
  std::vector<std::string> troubles_;
};

TEST_F(KeeperTest, HasKeptWhatWasWaitedFor) {
  Keeper keeper(place_, OnTrouble());
  for (std::uint64_t id = 1; id <= 20; ++id) keeper.Keep(Put(id));
  ASSERT_TRUE(keeper.Wait(10s));
  EXPECT_THAT(Kept(), SizeIs(20));
  EXPECT_THAT(Troubles(), SizeIs(0));
}

TEST_F(KeeperTest, TellsAFullDiskAndKeepsEverythingWhenThereIsRoomAgain) {
  Keeper keeper(place_, OnTrouble());
  keeper.Keep(Put(1));
  ASSERT_TRUE(keeper.Wait(10s));
  {
    const FullDisk full(4096);
    keeper.Keep(Put(2));
    const auto began = std::chrono::steady_clock::now();
    EXPECT_FALSE(keeper.Wait(10s));
    EXPECT_LT(std::chrono::steady_clock::now() - began, 5s);  // Nobody waits for what fails.
    keeper.Keep(Put(3));
    EXPECT_FALSE(keeper.Wait(10s));
    EXPECT_THAT(Troubles(), SizeIs(::testing::Ge(1)));
  }
  for (int i = 0; i < 50 && !keeper.Wait(1s); ++i) std::this_thread::sleep_for(100ms);
  EXPECT_THAT(Kept(), ElementsAre(1, 2, 3));
  EXPECT_EQ(Troubles().back(), "");
}

TEST_F(KeeperTest, LeavesOutWhatCannotBeDoneThoughTheStoreCan) {
  Keeper keeper(place_, OnTrouble());
  keeper.Keep(Put(1));
  keeper.Keep([](Store&) { throw std::runtime_error("no such folder"); });
  keeper.Keep(Put(2));
  for (int i = 0; i < 50 && !keeper.Wait(1s); ++i) std::this_thread::sleep_for(100ms);
  EXPECT_THAT(Kept(), ElementsAre(1, 2));
  keeper.Keep(Put(3));
  for (int i = 0; i < 50 && !keeper.Wait(1s); ++i) std::this_thread::sleep_for(100ms);
  EXPECT_THAT(Troubles(), ElementsAre(HasSubstr("no such folder"), ""));
}

// ---- PostgreSQL ----

class PostGisTest : public KeeperTest {
 protected:
  void SetUp() override {
    if (!test::Postgres::IsThere()) GTEST_SKIP() << "PostgreSQL is not installed";
    server_ = std::make_unique<test::Postgres>();
    place_ = server_->Connection();
  }
  std::unique_ptr<test::Postgres> server_;
};

TEST_F(PostGisTest, KeepsEverythingAndShowsItInLayers) {
  KeepsEverything(place_);
  GisDataset dataset = GisDataset::Open(place_, true);
  const auto row = dataset.Select("SELECT ST_X(geom), ST_SRID(geom) FROM viewpoints WHERE capture_id = 1")[0];
  EXPECT_NEAR(std::get<double>(row[0]), 19.94, 1e-4);
  EXPECT_EQ(std::get<std::int64_t>(row[1]), 4326);
  EXPECT_THAT(dataset.Select("SELECT stylename FROM layer_styles WHERE useasdefault"), SizeIs(5));
}

TEST_F(PostGisTest, GoesOnWhenTheServerWasAway) {
  Keeper keeper(place_, OnTrouble());
  keeper.Keep(Put(1));
  ASSERT_TRUE(keeper.Wait(20s));
  server_->End(SIGQUIT);
  keeper.Keep(Put(2));
  EXPECT_FALSE(keeper.Wait(20s));
  server_->Start();
  for (int i = 0; i < 100 && !keeper.Wait(1s); ++i) std::this_thread::sleep_for(100ms);
  EXPECT_THAT(Kept(), ElementsAre(1, 2));
  ASSERT_GE(Troubles().size(), 2U);
  EXPECT_EQ(Troubles().back(), "");
}

TEST_F(PostGisTest, SaysNothingOfAPasswordWhenItCannotConnect) {
  const auto store = Store::Open("PG:host=/nowhere user=soffit password=hunter2 dbname=postgres", false);
  ASSERT_FALSE(store.ok());
  EXPECT_THAT(store.error().message, HasSubstr("PostGIS"));
  EXPECT_THAT(store.error().message, ::testing::Not(HasSubstr("hunter2")));
}

}  // namespace
}  // namespace soffit
