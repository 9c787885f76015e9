#include "service/image/image.h"

#include <gmock/gmock.h>

#include <cstdio>
// After <cstdio>, of which it needs declarations.
#include <jpeglib.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "service/image/picture_header.h"

namespace soffit {
namespace {

using ::testing::HasSubstr;

using Bytes = std::vector<std::uint8_t>;

cv::Mat3b Pattern(int width, int height) {
  cv::Mat3b picture(height, width, cv::Vec3b(40, 90, 160));
  cv::rectangle(picture, cv::Rect(width / 4, height / 4, width / 2, height / 2), cv::Scalar(200, 30, 20),
                cv::FILLED);
  return picture;
}

Bytes Encode(const char* extension, const cv::Mat& picture, const std::vector<int>& parameters = {}) {
  Bytes bytes;
  cv::imencode(extension, picture, bytes, parameters);
  return bytes;
}

/// A JPEG of four inks, inverted as all programs write them; YCCK is the form that Adobe's programs prefer.
Bytes EncodeInks(const cv::Mat4b& inks, J_COLOR_SPACE stored) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* memory = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &memory, &size);
  jpeg.image_width = static_cast<JDIMENSION>(inks.cols);
  jpeg.image_height = static_cast<JDIMENSION>(inks.rows);
  jpeg.input_components = 4;
  jpeg.in_color_space = JCS_CMYK;
  jpeg_set_defaults(&jpeg);
  jpeg_set_colorspace(&jpeg, stored);
  jpeg_set_quality(&jpeg, 98, TRUE);
  jpeg_start_compress(&jpeg, TRUE);
  for (int y = 0; y < inks.rows; ++y) {
    cv::Mat row = inks.row(y).clone();
    JSAMPROW samples = row.data;
    jpeg_write_scanlines(&jpeg, &samples, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  const Bytes bytes(memory, memory + size);
  std::free(memory);  // NOLINT(cppcoreguidelines-no-malloc): libjpeg's.
  return bytes;
}

/// The bytes up to `share` of the way, and the marker that ends a JPEG.
Bytes CutAndClose(const Bytes& jpeg, double share) {
  Bytes cut(jpeg.begin(),
            jpeg.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(jpeg.size())));
  cut.insert(cut.end(), {0xff, 0xd9});
  return cut;
}

/// Where a JPEG says how large it is: two bytes for the height, two for the width.
std::size_t FindFrameSize(const Bytes& jpeg) {
  const Bytes frame = {0xff, 0xc0, 0x00, 0x11, 0x08};
  const auto found = std::search(jpeg.begin(), jpeg.end(), frame.begin(), frame.end());
  return static_cast<std::size_t>(found - jpeg.begin()) + frame.size();
}

Capture CaptureOf(Bytes bytes, int width = 64, int height = 48) {
  Capture capture;
  capture.capture_id = 5;
  capture.name = "top_1.jpg";
  capture.purpose = Purpose::kTop;
  capture.intrinsics = {width, height, 60.0, 60.0, (width - 1) / 2.0, (height - 1) / 2.0, {}};
  capture.map_from_camera.translation_m = {1, 2, 9};
  capture.bytes = std::move(bytes);
  return capture;
}

std::string ErrorOf(const Capture& capture, const ImageOptions& options = {}) {
  const Result<Image> image = DecodeImage(capture, options);
  return image.ok() ? "" : image.error().message;
}

TEST(DecodeImage, ReadsJpegAndPng) {
  for (const char* extension : {".jpg", ".png"}) {
    const Result<Image> image = DecodeImage(CaptureOf(Encode(extension, Pattern(64, 48))), {});
    ASSERT_TRUE(image.ok()) << image.error().message;
    EXPECT_EQ(image.value().bgr.size(), cv::Size(64, 48));
    EXPECT_EQ(image.value().seen, cv::Rect(0, 0, 64, 48));
    EXPECT_EQ(image.value().capture_id, 5u);
    EXPECT_EQ(image.value().purpose, Purpose::kTop);
    EXPECT_NEAR(image.value().bgr(24, 32)[0], 200, 6);
  }
}

TEST(DecodeImage, TurnsGreyAlphaAnd16BitToBgr) {
  cv::Mat grey, alpha, deep;
  cv::cvtColor(Pattern(64, 48), grey, cv::COLOR_BGR2GRAY);
  cv::cvtColor(Pattern(64, 48), alpha, cv::COLOR_BGR2BGRA);
  Pattern(64, 48).convertTo(deep, CV_16UC3, 257.0);
  for (const cv::Mat& picture : {grey, alpha, deep}) {
    const Result<Image> image = DecodeImage(CaptureOf(Encode(".png", picture)), {});
    ASSERT_TRUE(image.ok()) << image.error().message;
    EXPECT_EQ(image.value().bgr.size(), cv::Size(64, 48));
  }
  EXPECT_TRUE(DecodeImage(CaptureOf(Encode(".jpg", grey)), {}).ok());
}

TEST(DecodeImage, RefusesWhatIsNeitherJpegNorPng) {
  EXPECT_THAT(ErrorOf(CaptureOf({})), HasSubstr("'top_1.jpg'"));
  EXPECT_THAT(ErrorOf(CaptureOf({'h', 'e', 'l', 'l', 'o'})), HasSubstr("neither a JPEG nor a PNG"));
  EXPECT_THAT(ErrorOf(CaptureOf(Encode(".bmp", Pattern(64, 48)))), HasSubstr("neither a JPEG nor a PNG"));
}

TEST(DecodeImage, RefusesEveryTruncation) {
  for (const char* extension : {".jpg", ".png"}) {
    const Bytes whole = Encode(extension, Pattern(64, 48));
    for (std::size_t length = 0; length < whole.size(); length += 7) {
      EXPECT_NE(ErrorOf(CaptureOf(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)))),
                "");
    }
  }
}

TEST(DecodeImage, RefusesAJpegThatLacksPixelsThoughItIsClosed) {
  cv::Mat3b noise(48, 64);
  cv::randu(noise, 0, 255);
  for (const int progressive : {0, 1}) {
    const Bytes whole = Encode(".jpg", noise, {cv::IMWRITE_JPEG_PROGRESSIVE, progressive});
    EXPECT_EQ(ErrorOf(CaptureOf(whole)), "");
    for (const double share : {0.5, 0.8, 0.95})
      EXPECT_THAT(ErrorOf(CaptureOf(CutAndClose(whole, share))), HasSubstr("damaged")) << share;
  }
}

TEST(DecodeImage, TakesBytesBetweenTheSegmentsOfAJpegForPadding) {
  const Bytes whole = Encode(".jpg", Pattern(64, 48));
  Bytes padded = whole;
  padded.insert(padded.end() - 2, 6, 0x00);
  const Result<cv::Mat3b> picture = DecodePicture(padded, {});
  ASSERT_TRUE(picture.ok()) << picture.error().message;
  EXPECT_EQ(cv::norm(picture.value(), DecodePicture(whole, {}).value(), cv::NORM_INF), 0.0);
}

TEST(DecodeImage, TurnsInksToBgr) {
  cv::Mat4b inks(48, 64, cv::Vec4b(255, 255, 255, 200));
  inks(cv::Rect(0, 0, 32, 48)) = cv::Vec4b(160, 90, 40, 255);
  for (const J_COLOR_SPACE stored : {JCS_CMYK, JCS_YCCK}) {
    const Result<cv::Mat3b> picture = DecodePicture(EncodeInks(inks, stored), {});
    ASSERT_TRUE(picture.ok()) << picture.error().message;
    EXPECT_LE(cv::norm(picture.value()(24, 10) - cv::Vec3b(40, 90, 160), cv::NORM_INF), 4.0);
    EXPECT_LE(cv::norm(picture.value()(24, 54) - cv::Vec3b(200, 200, 200), cv::NORM_INF), 4.0);
  }
}

TEST(DecodeImage, ShowsWhiteWhereAPngIsTransparent) {
  cv::Mat4b picture(48, 64, cv::Vec4b(0, 0, 0, 0));
  picture(cv::Rect(0, 0, 32, 48)) = cv::Vec4b(40, 90, 160, 255);
  picture(24, 60) = cv::Vec4b(0, 0, 0, 128);
  cv::Mat deep;
  picture.convertTo(deep, CV_16UC4, 257.0);
  for (const cv::Mat& stored : {cv::Mat(picture), deep}) {
    const Result<cv::Mat3b> decoded = DecodePicture(Encode(".png", stored), {});
    ASSERT_TRUE(decoded.ok()) << decoded.error().message;
    EXPECT_EQ(decoded.value()(24, 10), cv::Vec3b(40, 90, 160));
    EXPECT_EQ(decoded.value()(24, 50), cv::Vec3b(255, 255, 255));
    EXPECT_EQ(decoded.value()(24, 60), cv::Vec3b(127, 127, 127));
  }
}

TEST(DecodeImage, SurvivesEveryFlippedByte) {
  for (const char* extension : {".jpg", ".png"}) {
    const Bytes whole = Encode(extension, Pattern(64, 48));
    for (std::size_t at = 0; at < whole.size(); at += 3) {
      Bytes damaged = whole;
      damaged[at] = static_cast<std::uint8_t>(damaged[at] ^ 0xff);
      const Result<Image> image = DecodeImage(CaptureOf(damaged), {});
      if (image.ok()) {
        EXPECT_EQ(image.value().bgr.size(), cv::Size(64, 48));
      }
    }
  }
}

TEST(DecodeImage, RefusesAGiganticClaimUnread) {
  Bytes png = Encode(".png", Pattern(64, 48));
  png[16] = png[20] = 0;
  png[18] = png[22] = 0xea;  // 60,000 x 60,000
  png[17] = png[21] = 0;
  png[19] = png[23] = 0x60;
  const Result<Image> image = DecodeImage(CaptureOf(png), {});
  ASSERT_FALSE(image.ok());
  EXPECT_EQ(image.error().code, Error::Code::kTooLarge);
  EXPECT_THAT(image.error().message, HasSubstr("60000 x 60000"));
}

TEST(DecodeImage, RefusesAGiganticJpegUnread) {
  Bytes jpeg = Encode(".jpg", Pattern(64, 48));
  const std::size_t at = FindFrameSize(jpeg);
  ASSERT_LT(at + 4, jpeg.size());
  std::fill_n(jpeg.begin() + static_cast<std::ptrdiff_t>(at), 4, std::uint8_t{0x75});  // 30,069 x 30,069
  const Result<cv::Mat3b> picture = DecodePicture(jpeg, {});
  ASSERT_FALSE(picture.ok());
  EXPECT_EQ(picture.error().code, Error::Code::kTooLarge);
  EXPECT_THAT(picture.error().message, HasSubstr("30069 x 30069"));
}

TEST(DecodeImage, RefusesTooManyBytesAndScans) {
  ImageOptions options;
  options.max_bytes = 1024;
  EXPECT_THAT(ErrorOf(CaptureOf(Bytes(2000, 0xff)), options), HasSubstr("image.max_bytes"));
  options = {};
  options.max_scans = 2;
  const Bytes progressive = Encode(".jpg", Pattern(64, 48), {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
  EXPECT_THAT(ErrorOf(CaptureOf(progressive), options), HasSubstr("image.max_scans"));
  EXPECT_EQ(ErrorOf(CaptureOf(progressive)), "");
}

TEST(DecodeImage, RefusesASizeThatIsNotThatOfTheIntrinsics) {
  EXPECT_THAT(ErrorOf(CaptureOf(Encode(".jpg", Pattern(48, 64)))), HasSubstr("48 x 64"));
}

TEST(DecodeImage, RefusesBrokenPosesAndIntrinsics) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Bytes bytes = Encode(".jpg", Pattern(64, 48));
  Capture capture = CaptureOf(bytes);
  capture.map_from_camera.translation_m.x() = nan;
  EXPECT_THAT(ErrorOf(capture), HasSubstr("pose"));
  capture = CaptureOf(bytes);
  capture.map_from_camera.rotation.coeffs().setZero();
  EXPECT_THAT(ErrorOf(capture), HasSubstr("pose"));
  capture = CaptureOf(bytes);
  capture.position_std_m = nan;
  EXPECT_THAT(ErrorOf(capture), HasSubstr("standard deviations"));
  capture.position_std_m = 1000.0;
  EXPECT_THAT(ErrorOf(capture), HasSubstr("standard deviations"));
  capture = CaptureOf(bytes);
  capture.orientation_std_rad = 3.0;
  EXPECT_THAT(ErrorOf(capture), HasSubstr("standard deviations"));
  capture = CaptureOf(bytes);
  capture.intrinsics.fx_px = 0.0;
  EXPECT_THAT(ErrorOf(capture), HasSubstr("intrinsics"));
  capture = CaptureOf(bytes);
  capture.intrinsics.distortion = {-3.0, 0, 0, 0, 0};
  EXPECT_THAT(ErrorOf(capture), HasSubstr("distortion"));
}

TEST(DecodeImage, TakesTheDistortionOut) {
  Capture capture = CaptureOf({}, 640, 480);
  capture.intrinsics.fx_px = capture.intrinsics.fy_px = 500.0;
  capture.intrinsics.distortion = {-0.2, 0.05, 0.001, -0.0005, 0.0};
  View distorted;
  distorted.intrinsics = capture.intrinsics;
  const Eigen::Vector3d point(0.9, -0.6, 2.0);  // In the camera.
  const double x = point.x() / point.z();
  const double y = point.y() / point.z();
  const auto& d = capture.intrinsics.distortion;
  const double r2 = x * x + y * y;
  const double radial = 1 + r2 * (d[0] + r2 * d[1]);
  const double u =
      500.0 * (x * radial + 2 * d[2] * x * y + d[3] * (r2 + 2 * x * x)) + capture.intrinsics.cx_px;
  const double v =
      500.0 * (y * radial + d[2] * (r2 + 2 * y * y) + 2 * d[3] * x * y) + capture.intrinsics.cy_px;
  cv::Mat3b picture(480, 640, cv::Vec3b(0, 0, 0));
  cv::circle(picture, cv::Point(static_cast<int>(std::lround(u)), static_cast<int>(std::lround(v))), 4,
             cv::Scalar(255, 255, 255), cv::FILLED);
  capture.bytes = Encode(".png", picture);
  const Result<Image> image = DecodeImage(capture, {});
  ASSERT_TRUE(image.ok()) << image.error().message;
  const Intrinsics& k = image.value().view.intrinsics;
  EXPECT_EQ(k.distortion, (std::array<double, 5>{}));
  cv::Mat1b grey;
  cv::cvtColor(image.value().bgr, grey, cv::COLOR_BGR2GRAY);
  const cv::Moments m = cv::moments(grey);
  EXPECT_NEAR(m.m10 / m.m00, k.fx_px * x + k.cx_px, 1.0);
  EXPECT_NEAR(m.m01 / m.m00, k.fy_px * y + k.cy_px, 1.0);
}

/// A lens as strong as wide ones are, and a picture whose sides are no multiples of anything.
TEST(DecodeImage, TakesTheDistortionOutEverywhere) {
  Capture capture = CaptureOf({}, 637, 475);
  capture.intrinsics.fx_px = capture.intrinsics.fy_px = 400.0;
  capture.intrinsics.distortion = {-0.3, 0.09, 0.001, -0.0005, 0.0};
  const auto wave = [](double x, double y) {
    return 128.0 + 60.0 * std::sin(0.1 * x) + 60.0 * std::cos(0.08 * y);
  };
  cv::Mat3b picture(475, 637);
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x)
      picture(y, x) = cv::Vec3b::all(cv::saturate_cast<uchar>(wave(x, y)));
  }
  capture.bytes = Encode(".png", picture);
  const Image image = DecodeImage(capture, {}).value();
  const Intrinsics& k = image.view.intrinsics;
  const auto& d = capture.intrinsics.distortion;
  double farthest = 0.0;
  for (int row = 0; row < image.bgr.rows; ++row) {
    for (int col = 0; col < image.bgr.cols; ++col) {
      const double x = (col - k.cx_px) / k.fx_px;
      const double y = (row - k.cy_px) / k.fy_px;
      const double r2 = x * x + y * y;
      const double radial = 1 + r2 * (d[0] + r2 * d[1]);
      const double u =
          400.0 * (x * radial + 2 * d[2] * x * y + d[3] * (r2 + 2 * x * x)) + capture.intrinsics.cx_px;
      const double v =
          400.0 * (y * radial + d[2] * (r2 + 2 * y * y) + 2 * d[3] * x * y) + capture.intrinsics.cy_px;
      if (u < 0.0 || v < 0.0 || u > picture.cols - 1 || v > picture.rows - 1) continue;
      farthest = std::max(farthest, std::abs(image.bgr(row, col)[0] - wave(u, v)));
    }
  }
  EXPECT_LT(farthest, 1.6);  // Of 6 levels from one pixel to the next.
}

TEST(DecodeImage, GivesTheSameForTheSame) {
  Capture capture = CaptureOf(Encode(".jpg", Pattern(64, 48)));
  capture.intrinsics.distortion = {-0.1, 0.01, 0, 0, 0};
  const Result<Image> once = DecodeImage(capture, {});
  const Result<Image> again = DecodeImage(capture, {});
  ASSERT_TRUE(once.ok() && again.ok());
  EXPECT_EQ(cv::norm(once.value().bgr, again.value().bgr, cv::NORM_INF), 0.0);
}

TEST(ShrinkImage, ShowsEveryPointAtTheSamePlaceOfTheWorld) {
  Image image;
  image.bgr = cv::Mat3b(900, 1200, cv::Vec3b(0, 0, 0));
  image.seen = cv::Rect(0, 0, 1200, 900);
  image.view.intrinsics = {1200, 900, 800.0, 800.0, 599.5, 449.5, {}};
  cv::Mat3b(image.bgr, cv::Rect(300, 600, 60, 60)).setTo(cv::Vec3b(255, 255, 255));
  const Eigen::Vector3d middle((329.5 - 599.5) / 800.0, (629.5 - 449.5) / 800.0, 1.0);
  const Image small = ShrinkImage(image, 0.12);
  EXPECT_LE(small.bgr.total(), 120000u);
  EXPECT_TRUE(IsValid(small.view.intrinsics));
  const auto pixel = Project(small.view, middle);
  ASSERT_TRUE(pixel);
  cv::Mat1b grey;
  cv::cvtColor(small.bgr, grey, cv::COLOR_BGR2GRAY);
  const cv::Moments moments = cv::moments(grey);
  EXPECT_NEAR(pixel->x(), moments.m10 / moments.m00, 0.01);
  EXPECT_NEAR(pixel->y(), moments.m01 / moments.m00, 0.01);
}

TEST(ShrinkImage, LeavesASmallPictureAsItIs) {
  Image image;
  image.bgr = cv::Mat3b(30, 40, cv::Vec3b(1, 2, 3));
  image.view.intrinsics = {40, 30, 30.0, 30.0, 19.5, 14.5, {}};
  const Image same = ShrinkImage(image, 1.0);
  EXPECT_EQ(same.bgr.data, image.bgr.data);
  EXPECT_EQ(same.view.intrinsics.fx_px, 30.0);
}

TEST(ReadPictureHeader, ReadsSizeAndScans) {
  const auto jpeg = ReadPictureHeader(Encode(".jpg", Pattern(70, 50)));
  ASSERT_TRUE(jpeg.ok());
  EXPECT_EQ(jpeg.value().format, PictureFormat::kJpeg);
  EXPECT_EQ(jpeg.value().width_px, 70);
  EXPECT_EQ(jpeg.value().height_px, 50);
  EXPECT_EQ(jpeg.value().scans, 1);
  const auto png = ReadPictureHeader(Encode(".png", Pattern(70, 50)));
  ASSERT_TRUE(png.ok());
  EXPECT_EQ(png.value().format, PictureFormat::kPng);
  EXPECT_EQ(png.value().width_px, 70);
}

}  // namespace
}  // namespace soffit
