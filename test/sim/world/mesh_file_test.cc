#include "test/sim/world/mesh_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <fstream>

namespace soffit::sim {
namespace {

using testing::HasSubstr;

const std::filesystem::path kFolder = SOFFIT_SIM_TESTDATA;

Mesh Read(const MeshFile& wanted) {
  const Result<Mesh> mesh = ReadMesh(wanted, kFolder);
  EXPECT_TRUE(mesh.ok()) << mesh.error().message;
  return mesh.ok() ? mesh.value() : Mesh{};
}

std::string Problem(const MeshFile& wanted, const std::filesystem::path& folder = kFolder) {
  const Result<Mesh> mesh = ReadMesh(wanted, folder);
  return mesh.ok() ? "no problem" : mesh.error().message;
}

MeshFile Gatehouse() {
  MeshFile house;
  house.file = "gatehouse.gml";
  return house;
}

Eigen::AlignedBox3d BoxOf(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& vertex : mesh.vertices_m) box.extend(vertex);
  return box;
}

double Area_m2(const Mesh& mesh) {
  double sum = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d& p = mesh.vertices_m[a];
    sum += 0.5 * (mesh.vertices_m[b] - p).cross(mesh.vertices_m[c] - p).norm();
  }
  return sum;
}

/// A file that is gone at the end of the test.
class Scratch {
 public:
  explicit Scratch(const std::string& text) { std::ofstream(path_) << text; }
  ~Scratch() { std::filesystem::remove(path_); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  MeshFile Wanted() const {
    MeshFile wanted;
    wanted.file = path_.filename();
    return wanted;
  }

 private:
  std::filesystem::path path_ = std::filesystem::temp_directory_path() /
                                ("soffit-mesh-" + std::to_string(::getpid()) +
                                 testing::UnitTest::GetInstance()->current_test_info()->name() + ".gml");
};

std::string ProblemOf(const std::string& text) {
  const Scratch file(text);
  return Problem(file.Wanted(), std::filesystem::temp_directory_path());
}

/// One wall of the given outline, in CityGML 3.
std::string Wall(const std::string& corners) {
  return "<CityModel xmlns:gml='g' xmlns:con='c'><con:WallSurface gml:id='w'><con:lod2MultiSurface>"
         "<gml:Polygon gml:id='p'><gml:exterior><gml:LinearRing><gml:posList>" +
         corners +
         "</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon></con:lod2MultiSurface>"
         "</con:WallSurface></CityModel>";
}

TEST(ReadMesh, PutsTheMiddleOfACityModelOnTheGroundAtTheOrigin) {
  const Eigen::AlignedBox3d box = BoxOf(Read(Gatehouse()));
  EXPECT_LT((box.min() - Eigen::Vector3d(-5, -3, 0)).norm(), 1e-6);
  EXPECT_LT((box.max() - Eigen::Vector3d(5, 3, 7)).norm(), 1e-6);
}

TEST(ReadMesh, KeepsTheLastDigitOfProjectedCoordinates) {
  MeshFile house = Gatehouse();
  house.origin = Eigen::Vector3d(690000.25, 5335000.5, 512.125);
  const Mesh mesh = Read(house);
  for (const Eigen::Vector3d& vertex : mesh.vertices_m)
    EXPECT_LT((vertex - (2.0 * vertex).array().round().matrix() / 2.0).norm(), 2e-9) << vertex.transpose();
}

TEST(ReadMesh, TakesTheFinestLevelAndLeavesClosureSurfacesOut) {
  const double walls_m2 = 2 * (50 - 9) - 1 + 9 + 2 * (30 + 6) + 2 * 18, window_m2 = 1.0;
  const double roofs_m2 = 2 * 10 * std::hypot(3, 2), ceiling_and_ground_m2 = 18 + 42;
  EXPECT_NEAR(Area_m2(Read(Gatehouse())), walls_m2 + window_m2 + roofs_m2 + ceiling_and_ground_m2, 1e-6);
}

TEST(ReadMesh, ChoosesSurfacesByKindAndId) {
  MeshFile house = Gatehouse();
  house.only = {"WallSurface"};
  house.without = {"front", "back_polygon", "gate"};
  EXPECT_NEAR(Area_m2(Read(house)), 2 * (30 + 6) + 2 * 18, 1e-6);
  house.only = {"pane"};
  house.without = {};
  EXPECT_NEAR(Area_m2(Read(house)), 1.0, 1e-6);
  house.only = {"Chimney"};
  EXPECT_THAT(Problem(house),
              HasSubstr("no surface of the kind or id 'Chimney'; its kinds are ClosureSurface, "
                        "GroundSurface, OuterCeilingSurface, RoofSurface, WallSurface, Window"));
}

TEST(ReadMesh, CutsAHoleOfAnyShape) {
  MeshFile house = Gatehouse();
  house.only = {"gate"};
  Prism cut;
  cut.is_lying = true;
  cut.section.outer = {{-1, 0}, {1, 0}, {1, 1}, {0, 2}, {-1, 1}};
  cut.low_m = 2.0;
  cut.high_m = 4.0;
  house.cuts = {cut};
  house.origin = Eigen::Vector3d(690005.25, 5335003.5, 512.125);
  EXPECT_NEAR(Area_m2(Read(house)), 9.0 - 3.0, 1e-6);
  house.cuts[0].low_m = 3.1;
  EXPECT_NEAR(Area_m2(Read(house)), 9.0, 1e-6);
  house.cuts[0] = {};
  house.cuts[0].section.outer = {{-9, -9}, {9, -9}, {9, 9}, {-9, 9}};
  house.cuts[0].high_m = 9.0;
  EXPECT_THAT(Problem(house), HasSubstr("nothing is left of it"));
}

TEST(ReadMesh, LeavesNoNeedlesWhereTheTilesOfACutMeet) {
  MeshFile house = Gatehouse();
  house.only = {"back"};
  Prism cut;
  cut.is_lying = true;
  cut.section.outer = {{-3, 1}, {-2, 1}, {-2, 3.3}, {-3, 3.3}};
  cut.low_m = 2.0;
  cut.high_m = 4.0;
  house.cuts = {cut};
  const Mesh mesh = Read(house);
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d &p = mesh.vertices_m[static_cast<std::size_t>(a)],
                          &q = mesh.vertices_m[static_cast<std::size_t>(b)],
                          &r = mesh.vertices_m[static_cast<std::size_t>(c)];
    EXPECT_GT((q - p).cross(r - p).norm(), 1e-9);
  }
}

TEST(ReadMesh, RepairsOutlinesThatTouchThemselves) {
  const Scratch spike(Wall("0 0 0 4 0 0 4 0 2 4 0 3 4 0 2 0 0 2 0 0 0"));
  const Result<Mesh> mesh = ReadMesh(spike.Wanted(), std::filesystem::temp_directory_path());
  ASSERT_TRUE(mesh.ok()) << mesh.error().message;
  EXPECT_NEAR(Area_m2(mesh.value()), 8.0, 1e-6);
}

TEST(ReadMesh, SaysWhatIsWrongWithACityModel) {
  MeshFile missing;
  missing.file = "nowhere.gml";
  EXPECT_THAT(Problem(missing), HasSubstr("nowhere.gml: cannot be read"));
  EXPECT_THAT(ProblemOf("<CityModel><a></CityModel>"), HasSubstr("cannot be read as XML"));
  EXPECT_THAT(ProblemOf("<gpx/>"), HasSubstr("has no CityModel"));
  EXPECT_THAT(ProblemOf("<CityModel/>"), HasSubstr("no geometry in level of detail 1, 2 or 3"));
  EXPECT_THAT(ProblemOf("<CityModel><w><lod1Solid/></w></CityModel>"), HasSubstr("no polygons"));
  for (const char* corners :
       {"", "1 2", "0 0 0 4 0 0 4 0 2", "0 0 0 4 0 0 4 0 2 0 0 1", "0 0 0 4 0 zero 4 0 2 0 0 0"})
    EXPECT_THAT(ProblemOf(Wall(corners)), HasSubstr("polygon 'p' of a WallSurface")) << corners;
}

TEST(ReadMesh, MovesAnObjFileByItsOrigin) {
  MeshFile obj;
  obj.file = "triangle.obj";
  obj.origin = Eigen::Vector3d(690000, 5335000, 500);
  EXPECT_LT((BoxOf(Read(obj)).max() - Eigen::Vector3d(1.001, 1, 0.5)).norm(), 1e-9);
  obj.only = {"WallSurface"};
  EXPECT_THAT(Problem(obj), HasSubstr("no kinds and ids"));
}

}  // namespace
}  // namespace soffit::sim
