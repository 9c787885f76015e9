#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "shared/capture/capture.h"
#include "test/sim/world/world.h"

namespace soffit::sim {

struct Exposure {
  std::vector<Pose<Map, Camera>>
      path;                ///< Where the camera was, evenly over the exposure; one pose: it stood still.
  std::uint64_t seed = 0;  ///< Of the noise.
};

/// Pictures of a world: Embree ray casting with lens distortion, sun with soft shadows, light of the sky and
/// of one bounce (computed once, in the constructor), procedural textures, clouds, haze, exposure, blur,
/// noise. Same world, exposure and seed: same picture, on any number of threads.
class Renderer {
 public:
  explicit Renderer(const World& world, int threads = 2);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// BGR, 8 bit, as large as the camera says.
  cv::Mat3b Render(const Exposure& exposure) const;

 private:
  struct Stage;
  std::unique_ptr<Stage> stage_;
};

/// JPEG with the UTC time of mid exposure in its EXIF (DateTimeOriginal, SubSecTimeOriginal,
/// OffsetTimeOriginal).
std::vector<std::uint8_t> EncodeJpeg(const cv::Mat3b& picture, int quality, std::int64_t mid_exposure_utc_ns);

}  // namespace soffit::sim
