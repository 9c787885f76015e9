#include "test/sim/camera/camera_server.h"

#include <httplib.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "test/sim/camera/http_port.h"
#include "test/sim/world/noise.h"

namespace soffit::sim {
namespace {

std::int64_t Now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

void Answer(httplib::Response& response, int status, const std::string& text) {
  response.status = status;
  response.set_content(text + "\n", "text/plain");
}

}  // namespace

struct CameraServer::Server {
  Server(const World& the_world, const Renderer& the_renderer, CameraPath the_path,
         const CameraServerOptions& options)
      : camera(the_world.camera),
        renderer(the_renderer),
        path(std::move(the_path)),
        seed(options.seed),
        broken_ratio(options.broken_ratio),
        late_ratio(options.late_ratio),
        late_s(options.late_s) {}

  /// The poses during an exposure that ends now.
  std::optional<Exposure> Expose(Mount mount, std::int64_t end_ns, std::uint64_t number) const {
    constexpr int kPoses = 8;
    const auto length_ns = static_cast<std::int64_t>(camera.exposure_s * 1e9);
    Exposure exposure{{}, Mix(seed + number)};
    for (int i = 0; i < kPoses; ++i) {
      const auto pose = path(mount, end_ns - length_ns + length_ns * (2 * i + 1) / (2 * kPoses));
      if (!pose) return std::nullopt;
      exposure.path.push_back(*pose);
    }
    return exposure;
  }

  void TakePicture(Mount mount, httplib::Response& response) {
    const std::int64_t end_ns = Now_ns();
    const std::uint64_t number = pictures++;
    const auto exposure = Expose(mount, end_ns, number);
    if (!exposure) return Answer(response, 503, "the camera's pose is not known yet");
    cv::Mat3b picture;
    {
      const std::lock_guard one_at_a_time(rendering);
      picture = renderer.Render(*exposure);
    }
    auto jpeg = EncodeJpeg(picture, camera.jpeg_quality,
                           end_ns - static_cast<std::int64_t>(0.5e9 * camera.exposure_s));
    if (ToUnit(Mix(exposure->seed + 1)) < broken_ratio) jpeg.resize(jpeg.size() * 2 / 5);
    if (ToUnit(Mix(exposure->seed + 2)) < late_ratio)
      std::this_thread::sleep_for(std::chrono::duration<double>(late_s));
    response.set_content(reinterpret_cast<const char*>(jpeg.data()), jpeg.size(), "image/jpeg");
  }

  void Route(const char* address, Mount mount) {
    http.Get(address, [this, mount](const httplib::Request&, httplib::Response& response) {
      TakePicture(mount, response);
    });
  }

  const CameraModel camera;
  const Renderer& renderer;
  const CameraPath path;
  const std::uint64_t seed;
  std::atomic<double> broken_ratio;
  std::atomic<double> late_ratio;
  const double late_s;
  std::atomic<std::uint64_t> pictures = 0;
  std::mutex rendering;
  httplib::Server http;
  int port = 0;
  std::jthread listener;
};

CameraServer::CameraServer(const World& world, const Renderer& renderer, CameraPath path,
                           const CameraServerOptions& options)
    : server_(std::make_unique<Server>(world, renderer, std::move(path), options)) {
  httplib::Server& http = server_->http;
  http.new_task_queue = [] { return new httplib::ThreadPool(4); };  // Owned by the server.
  server_->Route("/forward.jpg", Mount::kForward);
  server_->Route("/down.jpg", Mount::kDown);
  server_->Route("/gimbal.jpg", Mount::kGimbal);
  http.Get("/health", [server = server_.get()](const httplib::Request&, httplib::Response& response) {
    const nlohmann::json health = {{"status", "ok"}, {"pictures", server->pictures.load()}};
    response.set_content(health.dump() + "\n", "application/json");
  });
  http.set_exception_handler(
      [](const httplib::Request&, httplib::Response& response, std::exception_ptr error) {
        try {
          std::rethrow_exception(error);
        } catch (const std::exception& problem) {
          Answer(response, 500, problem.what());
        }
      });
  server_->port = BindAlone(http, options.port);
  server_->listener = std::jthread([&http] { http.listen_after_bind(); });
  while (!http.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));  // stop() needs it.
}

CameraServer::~CameraServer() { server_->http.stop(); }

int CameraServer::port() const { return server_->port; }

void CameraServer::SetFaults(double broken_ratio, double late_ratio) {
  server_->broken_ratio = broken_ratio;
  server_->late_ratio = late_ratio;
}

}  // namespace soffit::sim
