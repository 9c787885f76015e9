#include "vehicle_agent/camera/shrink.h"

#include <turbojpeg.h>

#include <array>
#include <memory>
#include <string>
#include <utility>

namespace soffit {
namespace {

using Handle = std::unique_ptr<void, decltype(&tjDestroy)>;

constexpr std::array<tjscalingfactor, 5> kSizes = {{{1, 1}, {3, 4}, {1, 2}, {3, 8}, {1, 4}}};
constexpr int kPadding = 4;

/// `at`: a coordinate of a picture with pixel centres at integers.
double ScaleCoordinate(double at_px, double ratio) { return (at_px + 0.5) * ratio - 0.5; }

Intrinsics ScaleIntrinsics(Intrinsics intrinsics, int width_px, int height_px) {
  const double x_ratio = static_cast<double>(width_px) / intrinsics.width_px;
  const double y_ratio = static_cast<double>(height_px) / intrinsics.height_px;
  intrinsics.width_px = width_px;
  intrinsics.height_px = height_px;
  intrinsics.fx_px *= x_ratio;
  intrinsics.fy_px *= y_ratio;
  intrinsics.cx_px = ScaleCoordinate(intrinsics.cx_px, x_ratio);
  intrinsics.cy_px = ScaleCoordinate(intrinsics.cy_px, y_ratio);
  return intrinsics;
}

class Shrinker {
 public:
  explicit Shrinker(const std::vector<std::uint8_t>& jpeg) : jpeg_(jpeg) {
    if (tjDecompressHeader3(decoder_.get(), jpeg_.data(), Size(), &width_px_, &height_px_, &sampling_,
                            &colors_) != 0) {
      problem_ = tjGetErrorStr2(decoder_.get());
    }
  }

  /// Stays in the picture's own colours, so that nothing is lost but size.
  std::vector<std::uint8_t> Encode(tjscalingfactor size, int quality) {
    if (!problem_.empty()) return {};
    const int width_px = TJSCALED(width_px_, size);
    const int height_px = TJSCALED(height_px_, size);
    std::vector<std::uint8_t> planes(tjBufSizeYUV2(width_px, kPadding, height_px, sampling_));
    unsigned char* encoded = nullptr;
    unsigned long encoded_size = 0;
    if (tjDecompressToYUV2(decoder_.get(), jpeg_.data(), Size(), planes.data(), width_px, kPadding, height_px,
                           0) != 0) {
      problem_ = tjGetErrorStr2(decoder_.get());
    } else if (tjCompressFromYUV(encoder_.get(), planes.data(), width_px, kPadding, height_px, sampling_,
                                 &encoded, &encoded_size, quality, 0) != 0) {
      problem_ = tjGetErrorStr2(encoder_.get());
    }
    const std::unique_ptr<unsigned char, decltype(&tjFree)> owned(encoded, &tjFree);
    if (!problem_.empty()) return {};
    return {encoded, encoded + encoded_size};
  }

  const std::string& problem() const { return problem_; }
  int width_px() const { return width_px_; }
  int height_px() const { return height_px_; }

 private:
  unsigned long Size() const { return static_cast<unsigned long>(jpeg_.size()); }

  const std::vector<std::uint8_t>& jpeg_;
  Handle decoder_{tjInitDecompress(), &tjDestroy};
  Handle encoder_{tjInitCompress(), &tjDestroy};
  int width_px_ = 0;
  int height_px_ = 0;
  int sampling_ = 0;
  int colors_ = 0;
  std::string problem_;
};

}  // namespace

Result<Capture> ShrinkCapture(Capture capture, std::size_t max_bytes, int quality) {
  if (capture.bytes.size() <= max_bytes) return capture;
  Shrinker shrinker(capture.bytes);
  for (const tjscalingfactor& size : kSizes) {
    std::vector<std::uint8_t> smaller = shrinker.Encode(size, quality);
    if (!shrinker.problem().empty())
      return InvalidInput("the picture cannot be made smaller: " + shrinker.problem());
    if (smaller.size() > max_bytes && &size != &kSizes.back()) continue;
    capture.intrinsics = ScaleIntrinsics(capture.intrinsics, TJSCALED(shrinker.width_px(), size),
                                         TJSCALED(shrinker.height_px(), size));
    capture.bytes = std::move(smaller);
    break;
  }
  return capture;
}

}  // namespace soffit
