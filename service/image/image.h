#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "shared/capture/capture.h"
#include "shared/options/options.h"
#include "shared/result/result.h"

namespace soffit {

/// A picture without lens distortion, and the camera that would have taken it so.
struct Image {
  std::uint32_t capture_id = 0;
  std::string name;
  Purpose purpose = Purpose::kUnknown;
  bool has_trusted_pose = false;
  cv::Mat3b bgr;  ///< Never empty.
  cv::Rect seen;  ///< The rectangle in which every pixel was seen by the lens. Never empty.
  View view;
  Intrinsics taken;  ///< Of the picture as it was given, with distortion.
};

struct ImageOptions {
  double max_megapixels = 50.0;
  double kept_megapixels = 2.0;
  int max_bytes = 64 << 20;
  int max_scans = 100;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("max_megapixels", self.max_megapixels,
          OptionInfo{0.01, 200.0, "MP", "Larger pictures are refused unread"});
    field(
        "kept_megapixels", self.kept_megapixels,
        OptionInfo{0.1, 200.0, "MP",
                   "Pictures are kept and compared at no more; outlines from above are traced at full size"});
    field("max_bytes", self.max_bytes, OptionInfo{1024, 1 << 30, "B", "Longer files are refused unread"});
    field("max_scans", self.max_scans,
          OptionInfo{1, 1000, "", "Progressive JPEGs with more scans are refused"});
  }
};

/// Decodes a JPEG or PNG, told by its magic. Size, scans and completeness are checked before anything is
/// decoded. Greyscale, 16-bit and CMYK are turned to 8-bit BGR, what is transparent shows white; an
/// orientation tag is not followed. An error says what is wrong. Pure; O(pixels).
Result<cv::Mat3b> DecodePicture(const std::vector<std::uint8_t>& bytes, const ImageOptions& options);

/// Decodes and undistorts a picture, when its size is that of its intrinsics and its pose known to 10 m and
/// 0.5 rad. The undistorted camera is zoomed so that the lens saw all of its pixels; none is made up.
/// Errors name the picture and what is wrong with it. Pure; O(pixels).
Result<Image> DecodeImage(const Capture& capture, const ImageOptions& options);

/// The same picture at `max_megapixels` at most, averaged, with a camera to match; as it is when it has no
/// more.
Image ShrinkImage(Image image, double max_megapixels);

}  // namespace soffit
