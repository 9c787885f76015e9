#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "test/sim/render/renderer.h"

namespace soffit::sim {

/// The cameras of the vehicle: two fixed ones, and one on a gimbal.
enum class Mount { kForward, kDown, kGimbal };

/// The true pose of a camera at a moment, not later than now; none: not known yet (the server answers 503).
/// Called from the server's threads.
using CameraPath = std::function<std::optional<Pose<Map, Camera>>(Mount mount, std::int64_t utc_ns)>;

struct CameraServerOptions {
  int port = 0;               ///< 0: any free one.
  std::uint64_t seed = 0;     ///< Of noise and faults.
  double broken_ratio = 0.0;  ///< Share of pictures that arrive cut off.
  double late_ratio = 0.0;    ///< Share of pictures that arrive `late_s` late.
  double late_s = 2.0;
};

/// HTTP on 127.0.0.1: GET /forward.jpg /down.jpg /gimbal.jpg take a picture at the moment of the request, GET
/// /health answers {"status":"ok","pictures":N}.
class CameraServer {
 public:
  /// Starts listening. @throws std::runtime_error  the port cannot be had.
  CameraServer(const World& world, const Renderer& renderer, CameraPath path,
               const CameraServerOptions& options);
  ~CameraServer();  ///< Stops; waits for pictures that are being taken.
  CameraServer(const CameraServer&) = delete;
  CameraServer& operator=(const CameraServer&) = delete;

  int port() const;
  void SetFaults(double broken_ratio, double late_ratio);

 private:
  struct Server;
  std::unique_ptr<Server> server_;
};

}  // namespace soffit::sim
