#include "test/sim/camera/camera_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>

#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

namespace soffit::sim {
namespace {

using testing::HasSubstr;

World SmallWorld() {
  World world;
  world.camera.intrinsics = {64, 48, 40, 40, 31.5, 23.5, {}};
  return world;
}

std::optional<Pose<Map, Camera>> Hover(Mount mount, std::int64_t) {
  const double pitch_rad = mount == Mount::kDown ? -std::numbers::pi / 2 : 0.0;
  return Pose<Map, Camera>{CameraAttitude(0.0, pitch_rad), {0, 0, 3}};
}

class CameraServerTest : public testing::Test {
 protected:
  httplib::Result Get(const CameraServer& server, const char* address) {
    return httplib::Client("127.0.0.1", server.port()).Get(address);
  }
  static cv::Mat Decode(const httplib::Result& result) {
    return cv::imdecode(std::vector<char>(result->body.begin(), result->body.end()), cv::IMREAD_COLOR);
  }

  const World world_ = SmallWorld();
  const Renderer renderer_{world_, 1};
};

TEST_F(CameraServerTest, ServesAPictureOfEachCamera) {
  const CameraServer server(world_, renderer_, Hover, {});
  const auto forward = Get(server, "/forward.jpg"), down = Get(server, "/down.jpg");
  ASSERT_TRUE(forward && down);
  EXPECT_EQ(forward->get_header_value("Content-Type"), "image/jpeg");
  ASSERT_EQ(Decode(down).size(), cv::Size(64, 48));
  EXPECT_GT(cv::norm(Decode(forward), Decode(down), cv::NORM_INF), 20.0);
  EXPECT_THAT(Get(server, "/health")->body, HasSubstr("\"pictures\":2"));
}

TEST_F(CameraServerTest, AnswersUnavailableWhileThePoseIsUnknown) {
  const CameraServer server(world_, renderer_, [](Mount, std::int64_t) { return std::nullopt; }, {});
  EXPECT_EQ(Get(server, "/gimbal.jpg")->status, 503);
  EXPECT_EQ(Get(server, "/sideways.jpg")->status, 404);
}

TEST_F(CameraServerTest, CutsPicturesOffWhenTold) {
  CameraServer server(world_, renderer_, Hover, {});
  const std::size_t whole = Get(server, "/down.jpg")->body.size();
  server.SetFaults(1.0, 0.0);
  EXPECT_LT(Get(server, "/down.jpg")->body.size(), whole / 2);
}

TEST_F(CameraServerTest, RefusesAPortThatIsTaken) {
  const CameraServer first(world_, renderer_, Hover, {});
  CameraServerOptions options;
  options.port = first.port();
  EXPECT_THROW(CameraServer(world_, renderer_, Hover, options), std::runtime_error);
}

}  // namespace
}  // namespace soffit::sim
