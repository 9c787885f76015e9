#include "service/edge/files/outputs.h"

#include <gmock/gmock.h>
#include <ogrsf_frmts.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <sstream>

#include "service/edge/files/city_json.h"
#include "service/edge/files/file.h"
#include "service/edge/files/geopackage.h"
#include "service/edge/files/report.h"
#include "service/edge/files/result.h"
#include "test/support/arch_scene.h"

namespace soffit {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

std::string Read(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

/// Every directed edge of a closed, oriented surface occurs once, and so does its reverse.
template <class Triangles>
bool IsClosed(const Triangles& triangles) {
  std::map<std::pair<int, int>, int> edges;
  for (const auto& triangle : triangles) {
    for (std::size_t i = 0; i < 3; ++i) ++edges[{triangle[i], triangle[(i + 1) % 3]}];
  }
  for (const auto& [edge, count] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    if (count != 1 || back == edges.end() || back->second != 1) return false;
  }
  return !edges.empty();
}

class OutputsTest : public ::testing::Test {
 protected:
  OutputsTest() : all_(test::ArchUnderstanding()), observations_(test::ArchObservations()) {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ =
        fs::path(::testing::TempDir()) / ("soffit_" + std::string(info->name()) + std::to_string(getpid()));
  }
  ~OutputsTest() override { fs::remove_all(folder_); }

  json Result() const { return json::parse(Read(folder_ / "result.json")); }

  fs::path folder_;
  Understanding all_;
  std::vector<Observation> observations_;
};

TEST_F(OutputsTest, WriteResultTellsWhatWasUnderstood) {
  ASSERT_TRUE(WriteResult(folder_, all_, observations_).ok());
  const json result = Result();
  const json& object = result["objects"][0];
  EXPECT_EQ(object["id"], "1");
  EXPECT_EQ(object["footprint"], json::parse("[[0,0],[4,0],[4,1.5],[0,1.5]]"));
  EXPECT_EQ(object["holes"], json::array());
  EXPECT_EQ(object["height_m"], 2.3);
  EXPECT_EQ(object["matched"], true);
  EXPECT_NEAR(object["match"]["rotation_cw_deg"].get<double>(), 28.6479, 1e-3);
  EXPECT_EQ(result["objects"][1]["matched"], false);
  EXPECT_FALSE(result["objects"][1].contains("match"));
  const json& model = result["models"][0];
  EXPECT_EQ(model["object"], "1");
  EXPECT_EQ(model["mesh"], "models/1.obj");
  EXPECT_EQ(model["openings"][0]["wall"], 0);
  EXPECT_EQ(model["openings"][0]["through"], true);
  EXPECT_EQ(model["openings"][0]["polygon"].size(), 4U);
  const json& decision = result["clearance"][0];
  EXPECT_EQ(decision["decision"], "CLEAR");
  EXPECT_EQ(decision["entry"], json::parse("[2.0,-1.6,0.7]"));
  EXPECT_EQ(decision["free_width_m"], 1.6);
  EXPECT_EQ(decision["binding"], "left");
  EXPECT_EQ(decision["distances_m"], json::parse(R"({"occupied": 1.0, "unknown": 0.35, "surface": 0.45})"));
  EXPECT_EQ(decision["bends"], json::array());
  EXPECT_FALSE(result.contains("mission"));
}

TEST_F(OutputsTest, WriteResultGivesNoCorridorWhereThereIsNone) {
  all_.decisions[0].corridor.reset();
  all_.decisions[0].verdict = Verdict::kInsufficientData;
  all_.decisions[0].wanted = Viewpoint{Purpose::kWall, {1, 2, 3}, 0.0, 0.0, 1, 2, "the far side"};
  ASSERT_TRUE(WriteResult(folder_, all_, observations_).ok());
  const json decision = Result()["clearance"][0];
  EXPECT_EQ(decision["decision"], "INSUFFICIENT_DATA");
  EXPECT_FALSE(decision.contains("entry"));
  EXPECT_EQ(decision["wanted"]["reason"], "the far side");
}

TEST_F(OutputsTest, WriteResultWritesTheSameMeshAndOctree) {
  ASSERT_TRUE(WriteResult(folder_, all_, observations_).ok());
  std::istringstream obj(Read(folder_ / "models/1.obj"));
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
  for (std::string line; std::getline(obj, line);) {
    std::istringstream words(line.substr(1));
    Eigen::Vector3d p;
    std::array<int, 3> t{};
    if (line[0] == 'v' && words >> p.x() >> p.y() >> p.z()) vertices.push_back(p);
    if (line[0] == 'f' && words >> t[0] >> t[1] >> t[2]) triangles.push_back({t[0] - 1, t[1] - 1, t[2] - 1});
  }
  const std::vector<Eigen::Vector3d>& expected = all_.scene.solids[0].mesh.vertices_in_map_m;
  ASSERT_EQ(vertices.size(), expected.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) EXPECT_LT((vertices[i] - expected[i]).norm(), 1e-9);
  EXPECT_EQ(triangles, all_.scene.solids[0].mesh.triangles);
  EXPECT_TRUE(IsClosed(triangles));

  octomap::OcTree octree(0.1);
  ASSERT_TRUE(octree.readBinary((folder_ / "scene.bt").string()));
  ASSERT_NE(octree.search(2.05, 0.05, 0.55), nullptr);
  EXPECT_FALSE(octree.isNodeOccupied(octree.search(2.05, 0.05, 0.55)));
  EXPECT_TRUE(octree.isNodeOccupied(octree.search(0.55, -1.05, 0.55)));
  EXPECT_EQ(octree.search(10.0, 10.0, 0.5), nullptr);
}

TEST_F(OutputsTest, WriteResultPassesMissionAndTruthOn) {
  FlightRecord flight;
  flight.mission = {{"outcome", "flown"}};
  flight.truth = {{"contacts", 0}};
  ASSERT_TRUE(WriteResult(folder_, all_, observations_, flight).ok());
  EXPECT_EQ(Result()["mission"]["outcome"], "flown");
  EXPECT_EQ(Result()["truth"]["contacts"], 0);
}

TEST_F(OutputsTest, WriteResultSaysWhereItCannotWrite) {
  std::ofstream(folder_) << "a file where the folder should be";
  const Status written = WriteResult(folder_, all_, observations_);
  ASSERT_FALSE(written.ok());
  EXPECT_THAT(written.error().message, HasSubstr(folder_.string()));
}

TEST_F(OutputsTest, CityJsonSolidIsClosedAndItsSoffitIsACeiling) {
  const json city = json::parse(ToCityJson(all_.scene, {}, std::nullopt));
  EXPECT_EQ(city["version"], "2.0");
  const json& building = city["CityObjects"]["1"];
  const json& solid = building["geometry"][1];
  ASSERT_EQ(solid["type"], "Solid");
  EXPECT_EQ(solid["lod"], "3");
  std::vector<std::array<int, 3>> triangles;
  for (const json& face : solid["boundaries"][0]) triangles.push_back(face[0].get<std::array<int, 3>>());
  EXPECT_TRUE(IsClosed(triangles));
  const json& values = solid["semantics"]["values"][0];
  ASSERT_EQ(values.size(), triangles.size());
  std::map<std::string, double> lowest_m;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::string type = solid["semantics"]["surfaces"][values[i].get<std::size_t>()]["type"];
    for (const int corner : triangles[i]) {
      const double z = city["vertices"][static_cast<std::size_t>(corner)][2].get<double>() * 1e-4;
      double& lowest = lowest_m.try_emplace(type, z).first->second;
      lowest = std::min(lowest, z);
    }
  }
  EXPECT_NEAR(lowest_m.at("OuterCeilingSurface"), 1.4, 1e-4);
  EXPECT_NEAR(lowest_m.at("RoofSurface"), 2.3, 1e-4);
  EXPECT_NEAR(lowest_m.at("GroundSurface"), 0.0, 1e-4);
  EXPECT_EQ(building["geometry"][2]["semantics"]["surfaces"][0]["type"], "ClosureSurface");
  EXPECT_EQ(city["CityObjects"]["2"]["geometry"].size(), 1U);
}

/// The kinds of the faces that came from each picture.
std::map<std::uint32_t, std::set<std::string>> KindsByCapture(const json& faces, const std::string& kind) {
  std::map<std::uint32_t, std::set<std::string>> kinds;
  for (const json& face : faces) {
    const json& place = face.contains("picture") && face["picture"].is_object() ? face["picture"] : face;
    kinds[place.value("capture", 0U)].insert(face[kind].get<std::string>());
  }
  return kinds;
}

TEST_F(OutputsTest, EachFaceTellsWhereInWhichPictureItIs) {
  ASSERT_TRUE(WriteResult(folder_, all_, observations_).ok());
  const json model = Result()["models"][0];
  const auto kinds = KindsByCapture(model["faces"], "surface");
  EXPECT_THAT(kinds.at(1), testing::Contains("RoofSurface"));
  EXPECT_THAT(kinds.at(2), testing::UnorderedElementsAre("WallSurface", "OuterCeilingSurface"));
  EXPECT_THAT(kinds.at(0), testing::Contains("GroundSurface"));
  for (const json& face : model["faces"]) {
    if (face["surface"] != "WallSurface" || face["wall"] != 0 || face.contains("opening")) continue;
    EXPECT_GT(face["picture"]["shown_ratio"], 0.9);
    EXPECT_GE(face["picture"]["polygon_px"].size(), 8U);  // On both sides of the passage and above it.
    EXPECT_FALSE(face["triangles"].empty());
  }
}

TEST_F(OutputsTest, CityJsonTellsThePictureOfASurface) {
  const json city = json::parse(ToCityJson(all_.scene, PicturesOf(observations_), std::nullopt));
  const json surfaces = city["CityObjects"]["1"]["geometry"][1]["semantics"]["surfaces"];
  EXPECT_THAT(KindsByCapture(surfaces, "type").at(1), testing::Contains("RoofSurface"));
  for (const json& surface : surfaces) {
    EXPECT_EQ(surface.contains("picture"), surface.contains("picture_outline_px"));
    if (surface["type"] != "RoofSurface") continue;
    EXPECT_EQ(surface["picture"], "overview.jpg");
    EXPECT_GE(surface["picture_outline_px"][0].size(), 4U);
    EXPECT_NEAR(surface["picture_shown_ratio"].get<double>(), 1.0, 0.01);
  }
}

/// A building of two heights, whose east wall leans inward.
Solid SteppedSolid() {
  Footprint footprint = test::BoxFootprint(3, "green", 0, 0, 6, 5, 4.0);
  footprint.levels = {{2.0, {0, 0.2, 0, 0}}, {2.0, {0, 0.2, 1.5, 0}}, {4.0, {0, 0.2, 1.5, 0}}};
  return RaiseSolid(footprint, {}).value();
}

TEST_F(OutputsTest, WriteResultTellsTheLevelsOfABuilding) {
  const Solid stepped = SteppedSolid();
  all_.scene.objects[1].footprint = stepped.footprint;
  all_.scene.solids.push_back(stepped);
  ASSERT_TRUE(WriteResult(folder_, all_, observations_).ok());
  const json result = Result();
  EXPECT_FALSE(result["objects"][0].contains("levels"));
  EXPECT_EQ(result["objects"][1]["levels"], json::parse(R"([
      {"height_m": 2.0, "inset_m": [0.0, 0.2, 0.0, 0.0]},
      {"height_m": 2.0, "inset_m": [0.0, 0.2, 1.5, 0.0]},
      {"height_m": 4.0, "inset_m": [0.0, 0.2, 1.5, 0.0]}])"));
  EXPECT_NEAR(result["models"][1]["volume_m3"].get<double>(), stepped.volume_m3, 1e-9);
}

TEST_F(OutputsTest, CityJsonTellsTheLevelsOfABuildingAndItsTerraceAsARoof) {
  const Solid stepped = SteppedSolid();
  all_.scene.objects[1].footprint = stepped.footprint;
  all_.scene.solids = {stepped};
  const json city = json::parse(ToCityJson(all_.scene, {}, std::nullopt));
  const json& building = city["CityObjects"]["3"];
  EXPECT_EQ(building["attributes"]["levels"].size(), 3U);
  EXPECT_EQ(building["attributes"]["levels"][1]["inset_m"], json::parse("[0.0, 0.2, 1.5, 0.0]"));
  EXPECT_FALSE(city["CityObjects"]["1"]["attributes"].contains("levels"));
  const json& solid = building["geometry"][1];
  std::set<std::int64_t> roof_heights;
  for (std::size_t i = 0; i < solid["boundaries"][0].size(); ++i) {
    const std::size_t surface = solid["semantics"]["values"][0][i];
    if (solid["semantics"]["surfaces"][surface]["type"] != "RoofSurface") continue;
    for (const int corner : solid["boundaries"][0][i][0])
      roof_heights.insert(city["vertices"][static_cast<std::size_t>(corner)][2].get<std::int64_t>());
  }
  EXPECT_THAT(roof_heights, testing::ElementsAre(20000, 40000));
}

TEST_F(OutputsTest, GeoPackageHoldsAllLayers) {
  fs::create_directories(folder_);
  FlightRecord flight;
  flight.track_in_map_m = {{0, 0, 0}, {0, 0, 3}, {2, -1.6, 0.7}};
  flight.origin = GeodeticOrigin{50.06, 19.94, 210.0};
  const Status written =
      WriteGeoPackage(folder_ / "scene.gpkg",
                      DescribeLayers(all_, PicturesOf(observations_), flight.track_in_map_m), flight.origin);
  ASSERT_TRUE(written.ok()) << written.error().message;
  GDALAllRegister();
  GDALDataset* dataset = GDALDataset::Open((folder_ / "scene.gpkg").c_str(), GDAL_OF_VECTOR);
  ASSERT_NE(dataset, nullptr);
  const std::map<std::string, int> expected = {
      {"footprints", 2}, {"openings", 2}, {"corridors", 1}, {"viewpoints", 2}, {"tracks", 1}};
  for (const auto& [name, count] : expected) {
    OGRLayer* layer = dataset->GetLayerByName(name.c_str());
    ASSERT_NE(layer, nullptr) << name;
    EXPECT_EQ(layer->GetFeatureCount(), count) << name;
    EXPECT_TRUE(layer->GetSpatialRef()->IsProjected());
  }
  const OGRFeatureUniquePtr decision(dataset->GetLayerByName("corridors")->GetNextFeature());
  EXPECT_STREQ(decision->GetFieldAsString("verdict"), "CLEAR");
  EXPECT_NEAR(decision->GetGeometryRef()->toLineString()->get_Length(), 4.7, 1e-9);
  EXPECT_EQ(dataset->GetLayerByName("decisions")->GetFeatureCount(), 1);
  OGRLayer* styles = dataset->GetLayerByName("layer_styles");
  ASSERT_NE(styles, nullptr);
  EXPECT_EQ(styles->GetFeatureCount(), 5);
  const OGRFeatureUniquePtr style(styles->GetNextFeature());
  EXPECT_THAT(style->GetFieldAsString("styleQML"), HasSubstr("categorizedSymbol"));
  GDALClose(dataset);
}

TEST_F(OutputsTest, WritesTheSameBytesTwice) {
  for (const char* name : {"a", "b"}) {
    ASSERT_TRUE(WriteResult(folder_ / name, all_, observations_).ok());
    ASSERT_TRUE(WriteGeoPackage(folder_ / name / "scene.gpkg",
                                DescribeLayers(all_, PicturesOf(observations_), {}), {})
                    .ok());
  }
  for (const char* file : {"result.json", "models/1.obj", "scene.bt", "scene.gpkg"}) {
    EXPECT_EQ(Read(folder_ / "a" / file), Read(folder_ / "b" / file)) << file;
  }
}

TEST_F(OutputsTest, WriteOutputsWritesAllFilesAndLeavesNoPartsBehind) {
  ASSERT_TRUE(WriteOutputs(folder_, {observations_, all_}, {}).ok());
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
    if (entry.is_regular_file()) files.push_back(fs::relative(entry.path(), folder_).string());
  }
  EXPECT_THAT(files,
              testing::UnorderedElementsAre("models/1.obj", "overlay/overview.jpg", "overlay/wall.jpg",
                                            "result.json", "scene.bt", "scene.bt.json", "scene.city.json",
                                            "scene.gpkg", "scene.png", "summary.png", "top_view.png"));
  EXPECT_FALSE(cv::imread((folder_ / "overlay/wall.jpg").string()).empty());
}

TEST_F(OutputsTest, WriteOutputsKeepsMillimetresFarFromTheOrigin) {
  FlightRecord flight;
  flight.map_origin_m = {690000, 5335000, 0};
  ASSERT_TRUE(WriteOutputs(folder_, {observations_, all_}, flight).ok());
  const json result = Result();
  EXPECT_EQ(result["map_origin"], json::parse("[690000.0,5335000.0,0.0]"));
  EXPECT_EQ(result["objects"][0]["footprint"][2], json::parse("[690004.0,5335001.5]"));
  EXPECT_NEAR(result["clearance"][0]["entry"][1].get<double>(), 5334998.4, 1e-6);
  EXPECT_NEAR(result["models"][0]["openings"][0]["polygon"][0][0].get<double>(),
              690000.0 + all_.scene.solids[0].openings[0].polygon_in_map_m[0].x(), 1e-6);

  std::istringstream obj(Read(folder_ / "models/1.obj"));
  std::vector<Eigen::Vector3d> vertices;
  for (std::string line; std::getline(obj, line);) {
    std::istringstream words(line.substr(1));
    Eigen::Vector3d p;
    if (line[0] == 'v' && words >> p.x() >> p.y() >> p.z()) vertices.push_back(p - flight.map_origin_m);
  }
  ASSERT_EQ(vertices.size(), all_.scene.solids[0].mesh.vertices_in_map_m.size());
  for (std::size_t i = 0; i < vertices.size(); ++i)
    EXPECT_LT((vertices[i] - all_.scene.solids[0].mesh.vertices_in_map_m[i]).norm(), 1e-5);

  const json city = json::parse(Read(folder_ / "scene.city.json"));
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double at =
        city["vertices"][0][axis].get<double>() * city["transform"]["scale"][axis].get<double>() +
        city["transform"]["translate"][axis].get<double>();
    EXPECT_NEAR(at, flight.map_origin_m[static_cast<Eigen::Index>(axis)], 10.0);
  }
  EXPECT_EQ(json::parse(Read(folder_ / "scene.bt.json"))["origin"], result["map_origin"]);

  GDALAllRegister();
  auto* dataset = GDALDataset::Open((folder_ / "scene.gpkg").c_str(), GDAL_OF_VECTOR);
  ASSERT_NE(dataset, nullptr);
  OGREnvelope extent;
  ASSERT_EQ(dataset->GetLayerByName("corridors")->GetExtent(&extent), OGRERR_NONE);
  EXPECT_NEAR(extent.MinY, 5334998.4, 1e-6);
  GDALClose(dataset);
}

TEST_F(OutputsTest, AMissionWithoutAnyPictureHasAResultAndAReport) {
  Understanding nothing;
  nothing.problems = {"no picture arrived"};
  FlightRecord flight;
  flight.mission = {{"outcome", "failed"}, {"message", "the autopilot does not arm"}};
  ASSERT_TRUE(WriteOutputs(folder_, {{}, nothing}, flight).ok());
  ASSERT_TRUE(WriteReport(folder_, nothing, {}, flight, "").ok());
  EXPECT_EQ(Result()["mission"]["outcome"], "failed");
  const std::string html = Read(folder_ / "report.html");
  EXPECT_THAT(html, HasSubstr("the autopilot does not arm"));
  EXPECT_THAT(html, HasSubstr("no picture arrived"));
  EXPECT_THAT(html, Not(HasSubstr("<img")));
}

TEST_F(OutputsTest, ReportTellsTheBindingMarginTheDistancesAndTheBends) {
  all_.decisions[0].corridor->bends_in_map_m = {{2.1, 0.7, 0.7}};
  ASSERT_TRUE(WriteReport(folder_, all_, observations_, {}, "").ok());
  const std::string html = Read(folder_ / "report.html");
  EXPECT_THAT(html, HasSubstr("least at the left"));
  EXPECT_THAT(html, HasSubstr("to occupied over 1.00 m, to unknown 0.35 m, to the model 0.45 m; 1 bend"));
}

TEST_F(OutputsTest, ReportShowsReasonsAsTextOnly) {
  all_.decisions[0].reason = "<script>alert(1)</script>";
  FlightRecord flight;
  flight.mission = {{"outcome", "flown"},
                    {"steps", {{{"step", "take off"}}, {{"step", "look"}, {"seconds", 4.5}}}}};
  ASSERT_TRUE(WriteReport(folder_, all_, observations_, flight, "reference.png").ok());
  const std::string html = Read(folder_ / "report.html");
  EXPECT_THAT(html, HasSubstr("&lt;script&gt;"));
  EXPECT_THAT(html, testing::Not(HasSubstr("<script>")));
  EXPECT_THAT(html, HasSubstr("take off"));
  EXPECT_THAT(html, HasSubstr("4.500"));
  EXPECT_THAT(html, HasSubstr("overlay/wall.jpg"));
}

TEST(ReadTrackFile, ReadsItsColumnsByName) {
  const fs::path file = fs::path(::testing::TempDir()) / ("soffit_track" + std::to_string(getpid()));
  ASSERT_TRUE(WriteFile(file, "t_s,z_m,x_m,y_m\n0.0,3,1,2\r\n0.1,6,4,5\n").ok());
  const Result<std::vector<Eigen::Vector3d>> track = ReadTrackFile(file);
  ASSERT_TRUE(track.ok()) << track.error().message;
  EXPECT_THAT(track.value(), testing::ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6)));
  ASSERT_TRUE(WriteFile(file, "x_m,y_m,z_m\n1,2,3\n1,nan,3\n").ok());
  EXPECT_THAT(ReadTrackFile(file).error().message, HasSubstr("line 3: y_m"));
  ASSERT_TRUE(WriteFile(file, "x,y,z\n").ok());
  EXPECT_THAT(ReadTrackFile(file).error().message, HasSubstr("no column x_m"));
  fs::remove(file);
}

}  // namespace
}  // namespace soffit
