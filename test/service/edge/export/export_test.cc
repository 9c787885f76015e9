#include "service/edge/export/export.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "service/edge/files/city_json.h"
#include "service/edge/files/geopackage.h"
#include "service/edge/files/map_file.h"
#include "shared/result/say.h"
#include "test/support/arch_scene.h"

namespace soffit {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class ExportTest : public ::testing::Test {
 protected:
  ExportTest() : all_(test::ArchUnderstanding()) {
    folder_ = fs::path(::testing::TempDir()) / ("soffit_export_" + std::to_string(getpid()));
  }
  ~ExportTest() override { fs::remove_all(folder_); }

  Status Write(const std::string& format) {
    const auto layers = DescribeLayers(all_, pictures_, {{0, 0, 0}, {1, 1, 1}});
    return WriteExport(folder_ / ("scene." + format), format, {all_, pictures_, layers, origin_});
  }
  std::string Written(const std::string& format) {
    const Status status = Write(format);
    EXPECT_TRUE(status.ok()) << status.error().message;
    std::ostringstream text;
    text << std::ifstream(folder_ / ("scene." + format), std::ios::binary).rdbuf();
    return text.str();
  }
  std::string ProblemOf(const std::string& format) {
    const Status status = Write(format);
    return status.ok() ? "" : status.error().message;
  }

  fs::path folder_;
  Understanding all_;
  std::vector<TakenPicture> pictures_ = PicturesOf(test::ArchObservations());
  std::optional<GeodeticOrigin> origin_ = GeodeticOrigin{50.06, 19.94, 210.0};
};

TEST_F(ExportTest, WritesEveryFormatTheSameTwice) {
  for (const ExportFormat& format : ExportFormats()) {
    const std::string once = Written(format.name);
    EXPECT_FALSE(once.empty()) << format.name;
    EXPECT_TRUE(once == Written(format.name)) << format.name;
  }
}

TEST_F(ExportTest, SaysWhatIsMissing) {
  EXPECT_THAT(ProblemOf("dwg"), HasSubstr("geojson"));
  origin_.reset();
  EXPECT_THAT(ProblemOf("geojson"), HasSubstr("not known"));
  EXPECT_THAT(ProblemOf("plan"), HasSubstr("not known"));
  origin_ = GeodeticOrigin{50.06, 19.94, 210.0};
  all_.decisions.front().verdict = Verdict::kBlocked;
  EXPECT_THAT(ProblemOf("plan"), HasSubstr("CLEAR"));
  all_ = {};
  EXPECT_THAT(ProblemOf("glb"), HasSubstr("no model"));
  EXPECT_THAT(ProblemOf("bt"), HasSubstr("no map"));
  EXPECT_EQ(ProblemOf("ply"), "");
}

TEST_F(ExportTest, GlbHasAllVerticesAndTrianglesAligned) {
  const std::string glb = Written("glb");
  const auto word = [&](std::size_t at) {
    std::uint32_t value;
    std::memcpy(&value, glb.data() + at, 4);
    return value;
  };
  ASSERT_EQ(glb.substr(0, 4), "glTF");
  EXPECT_EQ(word(8), glb.size());
  const std::size_t json_size = word(12);
  EXPECT_EQ(json_size % 4, 0U);
  EXPECT_EQ(glb.substr(16, 4), "JSON");
  const json gltf = json::parse(glb.substr(20, json_size));
  EXPECT_EQ(glb.size(), 20 + json_size + 8 + gltf["buffers"][0]["byteLength"].get<std::size_t>());
  const Mesh& mesh = all_.scene.solids[0].mesh;
  EXPECT_EQ(gltf["accessors"][0]["count"], mesh.vertices_in_map_m.size());
  EXPECT_EQ(gltf["accessors"][1]["count"], 3 * mesh.triangles.size());
  EXPECT_EQ(gltf["nodes"].back()["children"], json::parse("[0]"));
}

TEST_F(ExportTest, PlyAndObjHaveEveryTriangle) {
  const Mesh mesh = all_.scene.solids[0].mesh;
  const std::string ply = Written("ply");
  EXPECT_THAT(ply, HasSubstr("element face " + std::to_string(mesh.triangles.size())));
  const std::size_t header = ply.find("end_header\n") + 11;
  EXPECT_EQ(ply.size() - header, 24 * mesh.vertices_in_map_m.size() + 17 * mesh.triangles.size());
  all_.scene.solids.push_back(all_.scene.solids[0]);
  all_.scene.solids[1].footprint.object_id = 2;
  const std::string obj = Written("obj");
  EXPECT_THAT(obj, HasSubstr("o building_2\n"));
  const auto& [a, b, c] = mesh.triangles[0];
  const int more = static_cast<int>(mesh.vertices_in_map_m.size()) + 1;  // Of the second: counted on.
  EXPECT_THAT(obj, HasSubstr(Say("\nf ", a + more, " ", b + more, " ", c + more, "\n")));
}

TEST_F(ExportTest, GeoJsonLiesAtItsOrigin) {
  const json collection = json::parse(Written("geojson"));
  const json& footprint = collection["features"][0];
  EXPECT_EQ(footprint["properties"]["layer"], "footprints");
  EXPECT_EQ(footprint["properties"]["matched"], true);
  const json& ring = footprint["geometry"]["coordinates"][0];
  ASSERT_THAT(ring, SizeIs(5));
  EXPECT_EQ(ring[0], ring[4]);
  EXPECT_NEAR(ring[0][0].get<double>(), 19.94, 1e-9);
  EXPECT_NEAR(ring[0][1].get<double>(), 50.06, 1e-9);
  EXPECT_NEAR(ring[1][0].get<double>(), 19.94 + 4.0 / 71'610.0, 1e-7);
  EXPECT_NEAR(ring[0][2].get<double>(), 210.0, 1e-4);
}

TEST_F(ExportTest, PlanFliesThroughTheWidestCorridorAtItsHeight) {
  const json plan = json::parse(Written("plan"));
  EXPECT_EQ(plan["fileType"], "Plan");
  std::vector<double> heights_m;
  for (const json& item : plan["mission"]["items"]) {
    if (item["command"] == 16) heights_m.push_back(item["params"][6]);
    EXPECT_THAT(item["params"], SizeIs(7));
  }
  ASSERT_THAT(heights_m, SizeIs(4));
  EXPECT_GT(heights_m[0], 2.3 + 1.0);
  EXPECT_NEAR(heights_m[1], 0.7, 1e-9);
  EXPECT_NEAR(heights_m[2], 0.7, 1e-9);
  EXPECT_EQ(plan["mission"]["items"].back()["command"], 20);
  EXPECT_NEAR(plan["mission"]["items"][2]["params"][3].get<double>(), 0.0, 1e-9);  // North.
}

TEST_F(ExportTest, CityJsonIsInUtmWhereTheOriginIsKnown) {
  const json city = json::parse(Written("cityjson"));
  EXPECT_EQ(city["metadata"]["referenceSystem"], "https://www.opengis.net/def/crs/EPSG/0/32634");
  EXPECT_NEAR(city["transform"]["translate"][0].get<double>(), 424'118, 1'500);
  EXPECT_NEAR(city["transform"]["translate"][1].get<double>(), 5'545'700, 1'500);
}

TEST_F(ExportTest, CityJsonTellsTheBackOfARecessAsAWindowOfItsWall) {
  Facade wall;
  wall.object_id = 1;
  wall.width_m = 4.0;
  wall.height_m = 2.3;
  wall.was_seen = true;
  std::vector<Facade> walls(4, wall);
  for (int side = 0; side < 4; ++side) walls[static_cast<std::size_t>(side)].side = side;
  Opening niche;
  niche.ring_in_wall_m = {{1, 0.5}, {2, 0.5}, {2, 1.5}, {1, 1.5}};
  niche.recess = Recess{niche.ring_in_wall_m, 0.3, 0.01};
  walls[0].openings = {niche};
  const auto solid = RaiseSolid(all_.scene.objects[0].footprint, walls);
  ASSERT_TRUE(solid.ok()) << solid.error().message;
  all_.scene.solids = {solid.value()};
  const json city = json::parse(ToCityJson(all_.scene, {}, std::nullopt));
  ASSERT_THAT(city["CityObjects"]["1"]["geometry"], SizeIs(2));  // Footprint and solid: nothing is left over.
  const json& semantics = city["CityObjects"]["1"]["geometry"][1]["semantics"];
  const json& surfaces = semantics["surfaces"];
  const auto window =
      std::ranges::find(surfaces, "Window", [](const json& surface) { return surface["type"]; });
  ASSERT_NE(window, surfaces.end());
  const json& around = surfaces[(*window)["parent"].get<std::size_t>()];
  EXPECT_EQ(around["type"], "WallSurface");
  EXPECT_EQ(around["wall"], 0);
  EXPECT_EQ(around["children"], json::array({window - surfaces.begin()}));
  EXPECT_EQ(std::ranges::count(semantics["values"][0], json(window - surfaces.begin())), 2);
}

}  // namespace
}  // namespace soffit
