#include "service/edge/files/map_file.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "service/edge/files/file.h"

namespace soffit {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

octomap::OcTree SmallTree() {
  octomap::OcTree tree(0.1);
  for (int i = 0; i < 40; ++i) {
    tree.updateNode(octomap::point3d(0.1F * static_cast<float>(i) + 0.05F, 0.05F, 1.05F), i % 3 == 0);
  }
  tree.updateNode(octomap::point3d(-30.05F, 12.05F, -3.05F), true);
  tree.updateInnerOccupancy();
  return tree;
}

std::vector<std::uint8_t> Bytes(const std::string& text) { return {text.begin(), text.end()}; }

std::string ProblemOf(const std::string& text) {
  const auto tree = DecodeMap(Bytes(text));
  return tree.ok() ? "" : tree.error().message;
}

std::string HeaderOf(const std::string& map) { return map.substr(0, map.find("\ndata\n") + 6); }

TEST(DecodeMap, GivesBackEveryNodeThatWasEncoded) {
  const octomap::OcTree tree = SmallTree();
  for (const MapFormat format : {MapFormat::kBinary, MapFormat::kFull}) {
    const std::string bytes = EncodeMap(tree, format);
    const auto decoded = DecodeMap(Bytes(bytes));
    ASSERT_TRUE(decoded.ok()) << decoded.error().message;
    EXPECT_EQ(decoded.value()->size(), tree.size());
    EXPECT_EQ(EncodeMap(*decoded.value(), format), bytes);
  }
}

TEST(DecodeMap, TakesAnEmptyTree) {
  const auto decoded = DecodeMap(Bytes(EncodeMap(octomap::OcTree(0.1), MapFormat::kBinary)));
  ASSERT_TRUE(decoded.ok()) << decoded.error().message;
  EXPECT_EQ(decoded.value()->size(), 0U);
}

TEST(DecodeMap, RefusesBytesThatWouldNeverEnd) {
  for (const MapFormat format : {MapFormat::kBinary, MapFormat::kFull}) {
    const std::string map = HeaderOf(EncodeMap(SmallTree(), format)) + std::string(200'000, '\xff');
    EXPECT_NE(ProblemOf(map), "");
  }
  const std::string deep =
      HeaderOf(EncodeMap(SmallTree(), MapFormat::kBinary)) + std::string(200'000, '\x03');
  EXPECT_THAT(ProblemOf(deep), HasSubstr("deeper than 16"));
}

TEST(DecodeMap, RefusesAMapThatIsCutAnywhere) {
  for (const MapFormat format : {MapFormat::kBinary, MapFormat::kFull}) {
    const std::string map = EncodeMap(SmallTree(), format);
    for (std::size_t size = 0; size < map.size(); ++size)
      EXPECT_NE(ProblemOf(map.substr(0, size)), "") << size;
    EXPECT_THAT(ProblemOf(map + "x"), HasSubstr("follow the last node"));
  }
}

TEST(DecodeMap, NeverCrashesOnBytesThatWereFlipped) {
  std::mt19937 random(1);
  for (const MapFormat format : {MapFormat::kBinary, MapFormat::kFull}) {
    const std::string map = EncodeMap(SmallTree(), format);
    for (int i = 0; i < 3000; ++i) {
      std::string broken = map;
      broken[random() % broken.size()] = static_cast<char>(random());
      (void)ProblemOf(broken);
    }
  }
}

TEST(DecodeMap, SaysWhatIsWrongWithAHeader) {
  const std::string map = EncodeMap(SmallTree(), MapFormat::kBinary);
  const auto with = [&](const std::string& what, const std::string& instead) {
    std::string changed = map;
    return changed.replace(changed.find(what), what.size(), instead);
  };
  EXPECT_THAT(ProblemOf(""), HasSubstr("not an OctoMap"));
  EXPECT_THAT(ProblemOf(with("id OcTree", "id ColorOcTree")), HasSubstr("not an OcTree"));
  EXPECT_THAT(ProblemOf(with("res 0.1", "res nan")), HasSubstr("resolution"));
  EXPECT_THAT(ProblemOf(with("res 0.1", "res -1 ")), HasSubstr("resolution"));
  EXPECT_THAT(ProblemOf(with("size", "seiz")), HasSubstr("size"));
  EXPECT_THAT(ProblemOf(with("size ", "size 9")), HasSubstr("its header says"));
}

class MapFileTest : public ::testing::Test {
 protected:
  MapFileTest()
      : file_(fs::path(::testing::TempDir()) / ("soffit_map_" + std::to_string(getpid())) / "scene.ot") {
    EXPECT_TRUE(WriteMap(file_, SmallTree(), 7, MapFormat::kFull, {690000, 5335000, 0}).ok());
  }
  ~MapFileTest() override { fs::remove_all(file_.parent_path()); }

  std::string Problem() const {
    const auto map = ReadMap(file_);
    return map.ok() ? "" : map.error().message;
  }

  fs::path file_;
};

TEST_F(MapFileTest, IsReadWithWhatItsManifestSays) {
  const auto map = ReadMap(file_);
  ASSERT_TRUE(map.ok()) << map.error().message;
  EXPECT_EQ(map.value().octree->size(), SmallTree().size());
  EXPECT_EQ(map.value().manifest.scene_revision, 7U);
  EXPECT_EQ(map.value().manifest.frame, "map");
  EXPECT_EQ(map.value().manifest.origin_m, Eigen::Vector3d(690000, 5335000, 0));
  EXPECT_EQ(map.value().manifest.resolution_m, 0.1);
  EXPECT_EQ(map.value().manifest.sha256.size(), 64U);
}

TEST_F(MapFileTest, IsRefusedWhenOneValueOfItWasChanged) {
  std::fstream stream(file_, std::ios::in | std::ios::out | std::ios::binary);
  stream.seekp(-4, std::ios::end);
  stream.put(1);
  stream.close();
  EXPECT_THAT(Problem(), HasSubstr("SHA-256"));
}

TEST_F(MapFileTest, IsRefusedWithoutItsManifest) {
  fs::remove(file_.string() + ".json");
  EXPECT_THAT(Problem(), HasSubstr("scene.ot.json: no such file"));
  ASSERT_TRUE(WriteFile(file_.string() + ".json", "{\"manifest\":\"soffit-map/1\"}").ok());
  EXPECT_THAT(Problem(), HasSubstr("not a map's manifest"));
}

}  // namespace
}  // namespace soffit
