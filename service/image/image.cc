#include "service/image/image.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "service/image/jpeg.h"
#include "service/image/picture_header.h"
#include "service/image/picture_memory.h"

namespace soffit {
namespace {

/// A picture that may have been taken anywhere, or in any direction, tells nothing of where things are.
constexpr double kMaxPositionStd_m = 10.0;
constexpr double kMaxOrientationStd_rad = 0.5;

std::string SizeText(std::int64_t width_px, std::int64_t height_px) {
  return std::to_string(width_px) + " x " + std::to_string(height_px) + " pixels";
}

Status CheckHeader(const PictureHeader& header, const ImageOptions& options) {
  const double megapixels =
      static_cast<double>(header.width_px) * static_cast<double>(header.height_px) * 1e-6;
  if (!(megapixels > 0.0)) return InvalidInput("it has no pixels");
  if (!(megapixels <= options.max_megapixels)) {
    std::ostringstream text;
    text << "it claims " << SizeText(header.width_px, header.height_px) << ", more than "
         << options.max_megapixels << " megapixels (image.max_megapixels)";
    return Error{Error::Code::kTooLarge, text.str()};
  }
  if (header.scans > options.max_scans) {
    return Error{Error::Code::kTooLarge, "it has " + std::to_string(header.scans) + " scans, more than " +
                                             std::to_string(options.max_scans) + " (image.max_scans)"};
  }
  return OkStatus();
}

/// Reads no more than the header, and refuses what is too large to be decoded.
Result<PictureHeader> Inspect(const std::vector<std::uint8_t>& bytes, const ImageOptions& options) {
  SOFFIT_EXPECT(IsValidOptions(options));
  if (bytes.empty()) return InvalidInput("it is empty");
  if (bytes.size() > static_cast<std::size_t>(options.max_bytes)) {
    return Error{Error::Code::kTooLarge, "it has " + std::to_string(bytes.size()) + " bytes, more than " +
                                             std::to_string(options.max_bytes) + " (image.max_bytes)"};
  }
  Result<PictureHeader> header = ReadPictureHeader(bytes);
  if (!header.ok()) return header;
  if (const Status status = CheckHeader(header.value(), options); !status.ok()) return status.error();
  return header;
}

/// What is transparent shows white paper.
template <class Channel>
cv::Mat3b LayOnWhite(const cv::Mat_<cv::Vec<Channel, 4>>& bgra) {
  constexpr std::uint32_t kOpaque = std::numeric_limits<Channel>::max();
  cv::Mat3b bgr(bgra.size());
  std::transform(bgra.begin(), bgra.end(), bgr.begin(), [](const cv::Vec<Channel, 4>& pixel) {
    const std::uint32_t alpha = pixel[3];
    cv::Vec3b laid;
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t level = (pixel[i] * alpha + kOpaque / 2) / kOpaque + kOpaque - alpha;
      laid[i] = static_cast<std::uint8_t>((level * 255U + kOpaque / 2) / kOpaque);
    }
    return laid;
  });
  return bgr;
}

Result<cv::Mat3b> DecodePng(const std::vector<std::uint8_t>& bytes, const PictureHeader& header) {
  cv::Mat decoded;
  try {
    const int color = cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION;
    decoded = cv::imdecode(bytes, header.has_alpha ? cv::IMREAD_UNCHANGED : color);
  } catch (const cv::Exception&) {
    decoded.release();
  }
  if (decoded.cols != header.width_px || decoded.rows != header.height_px)
    return InvalidInput("the PNG is damaged");
  if (decoded.type() == CV_8UC4) return LayOnWhite<std::uint8_t>(decoded);
  if (decoded.type() == CV_16UC4) return LayOnWhite<std::uint16_t>(decoded);
  return cv::Mat3b(decoded);
}

Result<cv::Mat3b> Decode(const std::vector<std::uint8_t>& bytes, const PictureHeader& header) {
  if (header.format == PictureFormat::kPng) return DecodePng(bytes, header);
  return DecodeJpeg(bytes, cv::Size(static_cast<int>(header.width_px), static_cast<int>(header.height_px)));
}

bool IsFinite(const Pose<Map, Camera>& pose) {
  return pose.translation_m.allFinite() && pose.rotation.coeffs().allFinite() &&
         std::abs(pose.rotation.norm() - 1.0) < 1e-3;
}

/// Whether points farther from the axis are seen farther from the centre, out to the corners; else the
/// polynomial folds the picture over itself and has no inverse.
bool IsDistortionInvertible(const Intrinsics& k) {
  const double x = std::max(k.cx_px, k.width_px - 1 - k.cx_px) / k.fx_px;
  const double y = std::max(k.cy_px, k.height_px - 1 - k.cy_px) / k.fy_px;
  const double farthest = x * x + y * y;
  for (int i = 0; i <= 50; ++i) {
    const double r2 = farthest * i / 50.0;
    const double slope =
        1.0 + r2 * (3.0 * k.distortion[0] + r2 * (5.0 * k.distortion[1] + r2 * 7.0 * k.distortion[4]));
    if (!(slope > 0.05)) return false;
  }
  return true;
}

cv::Matx33d CameraMatrix(const Intrinsics& k) {
  return {k.fx_px, 0.0, k.cx_px, 0.0, k.fy_px, k.cy_px, 0.0, 0.0, 1.0};
}

bool HasDistortion(const Intrinsics& k) {
  for (const double d : k.distortion) {
    if (d != 0.0) return true;
  }
  return false;
}

Intrinsics WithoutDistortion(const Intrinsics& k) {
  const cv::Size size(k.width_px, k.height_px);
  const cv::Mat ideal = cv::getOptimalNewCameraMatrix(CameraMatrix(k), k.distortion, size, 0.0, size);
  Intrinsics result = k;
  result.distortion.fill(0.0);
  result.fx_px = ideal.at<double>(0, 0);
  result.fy_px = ideal.at<double>(1, 1);
  result.cx_px = ideal.at<double>(0, 2);
  result.cy_px = ideal.at<double>(1, 2);
  return result;
}

/// Where the pixels of rows of the ideal picture come from, starting with row `first`. The lens is asked in
/// the middle of every 8 x 8 pixels: between, it bends no line by more than hundredths of a pixel.
cv::Mat2f FindSources(const Intrinsics& distorted, const Intrinsics& ideal, int first, cv::Size size) {
  constexpr int kCell = 8;
  const cv::Size cells((size.width + kCell - 1) / kCell + 2, (size.height + kCell - 1) / kCell + 2);
  const double middle = 0.5 * (kCell - 1) - kCell;  // Of the first cell, which lies before the first pixel.
  const cv::Matx33d camera(ideal.fx_px / kCell, 0.0, (ideal.cx_px - middle) / kCell, 0.0, ideal.fy_px / kCell,
                           (ideal.cy_px - first - middle) / kCell, 0.0, 0.0, 1.0);
  cv::Mat2f coarse, fine;
  cv::initUndistortRectifyMap(CameraMatrix(distorted), distorted.distortion, cv::noArray(), camera, cells,
                              CV_32FC2, coarse, cv::noArray());
  cv::resize(coarse, fine, cv::Size(), kCell, kCell, cv::INTER_LINEAR);
  return fine(cv::Rect({kCell, kCell}, size));
}

/// A few rows at a time: where their pixels come from then stays in the cache.
cv::Mat3b Undistort(const cv::Mat3b& picture, const Intrinsics& distorted, const Intrinsics& ideal) {
  constexpr int kBandRows = 32;
  cv::Mat3b result = NewPicture(picture.size(), CV_8UC3);
  cv::Mat whole, fraction;
  for (int first = 0; first < picture.rows; first += kBandRows) {
    cv::Mat3b band = result.rowRange(first, std::min(first + kBandRows, picture.rows));
    cv::convertMaps(FindSources(distorted, ideal, first, band.size()), cv::noArray(), whole, fraction,
                    CV_16SC2);
    cv::remap(picture, band, whole, fraction, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  }
  return result;
}

}  // namespace

Result<cv::Mat3b> DecodePicture(const std::vector<std::uint8_t>& bytes, const ImageOptions& options) {
  const Result<PictureHeader> header = Inspect(bytes, options);
  if (!header.ok()) return header.error();
  return Decode(bytes, header.value());
}

Result<Image> DecodeImage(const Capture& capture, const ImageOptions& options) {
  const std::string who =
      "picture " + (capture.name.empty() ? std::to_string(capture.capture_id) : "'" + capture.name + "'") +
      ": ";
  const Intrinsics& k = capture.intrinsics;
  if (!IsValid(k)) return InvalidInput(who + "its camera intrinsics are not valid");
  if (!IsFinite(capture.map_from_camera))
    return InvalidInput(who + "its pose is not a finite rotation and position");
  if (!(capture.position_std_m >= 0.0 && capture.position_std_m <= kMaxPositionStd_m) ||
      !(capture.orientation_std_rad >= 0.0 && capture.orientation_std_rad <= kMaxOrientationStd_rad)) {
    return InvalidInput(who + "the standard deviations of its pose are not from 0 to 10 m and 0 to 0.5 rad");
  }
  if (!IsDistortionInvertible(k)) return InvalidInput(who + "its distortion folds the picture over itself");
  const Result<PictureHeader> inspected = Inspect(capture.bytes, options);
  if (!inspected.ok()) return Error{inspected.error().code, who + inspected.error().message};
  const PictureHeader& header = inspected.value();
  if (header.width_px != k.width_px || header.height_px != k.height_px) {
    return InvalidInput(who + "it has " + SizeText(header.width_px, header.height_px) +
                        ", its intrinsics are for " + SizeText(k.width_px, k.height_px));
  }
  Result<cv::Mat3b> picture = Decode(capture.bytes, header);
  if (!picture.ok()) return Error{picture.error().code, who + picture.error().message};
  const cv::Mat3b& bgr = picture.value();

  Image image;
  image.capture_id = capture.capture_id;
  image.name = capture.name;
  image.purpose = capture.purpose;
  image.has_trusted_pose = capture.has_trusted_pose;
  image.view = {k, capture.map_from_camera, capture.position_std_m, capture.orientation_std_rad};
  image.view.map_from_camera.rotation.normalize();
  image.taken = k;
  image.seen = cv::Rect(0, 0, bgr.cols, bgr.rows);
  image.bgr = bgr;
  if (HasDistortion(k)) {
    image.view.intrinsics = WithoutDistortion(k);
    if (!IsValid(image.view.intrinsics)) return InvalidInput(who + "its distortion cannot be taken out");
    image.bgr = Undistort(bgr, k, image.view.intrinsics);
  }
  return image;
}

Image ShrinkImage(Image image, double max_megapixels) {
  SOFFIT_EXPECT(max_megapixels > 0.0);
  const cv::Size full = image.bgr.size();
  const double scale = std::sqrt(max_megapixels * 1e6 / static_cast<double>(full.area()));
  if (scale >= 1.0) return image;
  const cv::Size size(std::max(1, static_cast<int>(full.width * scale)),
                      std::max(1, static_cast<int>(full.height * scale)));
  cv::Mat3b bgr;
  cv::resize(image.bgr, bgr, size, 0.0, 0.0, cv::INTER_AREA);
  image.bgr = bgr;
  image.seen = cv::Rect(cv::Point(), size);
  Intrinsics& k = image.view.intrinsics;
  const double sx = static_cast<double>(size.width) / full.width;
  const double sy = static_cast<double>(size.height) / full.height;
  k.width_px = size.width;
  k.height_px = size.height;
  k.fx_px *= sx;
  k.fy_px *= sy;
  k.cx_px = sx * (k.cx_px + 0.5) - 0.5;  // Pixel centres are at integer coordinates.
  k.cy_px = sy * (k.cy_px + 0.5) - 0.5;
  return image;
}

}  // namespace soffit
