#include "vehicle_agent/camera/camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <future>
#include <random>

#include "test/support/test_jpeg.h"
#include "vehicle_agent/camera/jpeg.h"

namespace soffit {
namespace {

using ::testing::HasSubstr;

constexpr std::int64_t kMoment_s = 1'795'323'600;  // 2026-11-22 05:00:00 UTC.

CameraOptions SmallCamera() {
  CameraOptions options;
  options.width_px = 64;
  options.height_px = 48;
  options.timeout_s = 2.0;
  return options;
}

/// A folder that is gone after the test.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    path_ =
        std::filesystem::temp_directory_path() / ("soffit_camera_" + std::to_string(std::random_device{}()));
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  std::string Write(const std::string& name, const Bytes& bytes) const {
    std::ofstream(path_ / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return (path_ / name).string();
  }
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

TEST(CheckJpeg, FindsTheSizeOfAWholePicture) {
  const Bytes jpeg = MakeTestJpeg(640, 480, MakeExifSegment({"2026:11:22 05:00:00", "", "+00:00"}));
  const auto info = CheckJpeg(jpeg);
  ASSERT_TRUE(info.ok()) << info.error().message;
  EXPECT_EQ(info.value().width_px, 640);
  EXPECT_EQ(info.value().height_px, 480);
}

TEST(CheckJpeg, RefusesEveryCutOffPicture) {
  const Bytes jpeg = MakeTestJpeg(640, 480);
  for (std::size_t size = 0; size < jpeg.size(); ++size) {
    EXPECT_FALSE(CheckJpeg(Bytes(jpeg.begin(), jpeg.begin() + static_cast<std::ptrdiff_t>(size))).ok())
        << size;
  }
}

TEST(CheckJpeg, AllowsPaddingBehindTheEnd) {
  Bytes jpeg = MakeTestJpeg(640, 480);
  jpeg.insert(jpeg.end(), 7, 0);
  EXPECT_TRUE(CheckJpeg(jpeg).ok());
}

TEST(CheckJpeg, RefusesOtherThings) {
  const std::string page = "<html>404</html>";
  EXPECT_FALSE(CheckJpeg(Bytes(page.begin(), page.end())).ok());
  EXPECT_FALSE(CheckJpeg(Bytes{0xff, 0xd8, 0xff, 0xd9}).ok());
  EXPECT_FALSE(CheckJpeg({}).ok());
}

TEST(CheckJpeg, SurvivesRandomDamage) {
  std::mt19937 random(7);
  const Bytes whole = MakeTestJpeg(64, 48, MakeExifSegment({"2026:11:22 05:00:00", "123", "+00:00"}));
  for (int i = 0; i < 20000; ++i) {
    Bytes jpeg = whole;
    for (int k = 0; k < 3; ++k) jpeg[random() % jpeg.size()] = static_cast<std::uint8_t>(random());
    (void)CheckJpeg(jpeg);
    (void)FindExposureTime(jpeg);
  }
}

TEST(FindExposureTime, ReadsTimeFractionAndOffset) {
  const auto time = [](const TestExif& exif) {
    return FindExposureTime(MakeTestJpeg(64, 48, MakeExifSegment(exif)));
  };
  EXPECT_EQ(time({"2026:11:22 05:00:00", "123456", "+00:00"}), kMoment_s * 1'000'000'000 + 123'456'000);
  EXPECT_EQ(time({"2026:11:22 07:00:00", "5", "+02:00"}), kMoment_s * 1'000'000'000 + 500'000'000);
  EXPECT_EQ(time({"2026:11:22 01:30:00", "", "-03:30"}), kMoment_s * 1'000'000'000);
}

TEST(FindExposureTime, GivesNothingRatherThanAGuess) {
  const auto time = [](const TestExif& exif) {
    return FindExposureTime(MakeTestJpeg(64, 48, MakeExifSegment(exif)));
  };
  EXPECT_FALSE(time({"2026:11:22 05:00:00", "123", ""}).has_value());  // A local time of an unknown place.
  EXPECT_FALSE(time({"2026:13:22 05:00:00", "123", "+00:00"}).has_value());
  EXPECT_FALSE(time({"yesterday", "123", "+00:00"}).has_value());
  EXPECT_FALSE(time({"", "123", "+00:00"}).has_value());
  EXPECT_FALSE(FindExposureTime(MakeTestJpeg(64, 48)).has_value());
}

TEST(MakePicture, TakesTheTimeOfArrivalLessTheLatencyWithoutExif) {
  CameraOptions options = SmallCamera();
  options.latency_s = 0.25;
  const auto picture = MakePicture(MakeGreyJpeg(64, 48), 10'000'000'000, options);
  ASSERT_TRUE(picture.ok());
  EXPECT_EQ(picture.value().exposure_utc_ns, 9'750'000'000);
}

TEST(MakePicture, TrustsOnlyAClockThatIsOurs) {
  const auto trusts = [](std::int64_t exposed_before_arrival_ns) {
    const Bytes jpeg = MakeGreyJpeg(64, 48, 128, MakeExifSegment({"2026:11:22 05:00:00", "", "+00:00"}));
    const auto picture =
        MakePicture(jpeg, kMoment_s * 1'000'000'000 + exposed_before_arrival_ns, SmallCamera());
    EXPECT_EQ(picture.value().exposure_utc_ns, kMoment_s * 1'000'000'000);
    return picture.value().has_trusted_time;
  };
  EXPECT_TRUE(trusts(0));
  EXPECT_TRUE(trusts(2'000'000'000));
  EXPECT_FALSE(trusts(-100'000'000));       // Exposed after it arrived.
  EXPECT_FALSE(trusts(3'600'000'000'000));  // An hour ago.
  EXPECT_TRUE(MakePicture(MakeGreyJpeg(64, 48), 1, SmallCamera()).value().has_trusted_time);
}

TEST(MakePicture, ReadsHowLongTheShutterWasOpen) {
  const auto shutter_s = [](const Bytes& segment) {
    return MakePicture(MakeGreyJpeg(64, 48, 128, segment), 1, SmallCamera()).value().shutter_s;
  };
  EXPECT_NEAR(shutter_s(MakeShutterSegment(1, 250)), 0.004, 1e-9);
  EXPECT_NEAR(shutter_s(MakeShutterSegment(1, 0)), 0.02, 1e-9);  // Nonsense: what the configuration says.
  EXPECT_NEAR(shutter_s({}), 0.02, 1e-9);
}

TEST(MakePicture, RefusesWhatIsBlackWhiteOrCannotBeDecoded) {
  const auto problem = [](const Bytes& jpeg) {
    const auto picture = MakePicture(jpeg, 1, SmallCamera());
    return picture.ok() ? "" : picture.error().message;
  };
  EXPECT_THAT(problem(MakeGreyJpeg(64, 48, 0)), HasSubstr("underexposed"));
  EXPECT_THAT(problem(MakeGreyJpeg(64, 48, 253)), HasSubstr("overexposed"));
  EXPECT_EQ(problem(MakeGreyJpeg(64, 48, 40)), "");
  EXPECT_EQ(problem(MakeGreyJpeg(64, 48, 215)), "");
  EXPECT_THAT(problem(MakeTestJpeg(64, 48)), HasSubstr("cannot be decoded"));
}

TEST(FindExposureProblem, SurvivesRandomDamage) {
  std::mt19937 random(7);
  const Bytes whole = MakeGreyJpeg(64, 48);
  for (int i = 0; i < 5000; ++i) {
    Bytes jpeg = whole;
    for (int k = 0; k < 3; ++k) jpeg[random() % jpeg.size()] = static_cast<std::uint8_t>(random());
    (void)MakePicture(jpeg, 1, SmallCamera());
    (void)FindShutterTime(jpeg);
  }
}

TEST(MakePicture, RefusesAPictureOfAnotherSizeThanTheLensWasCalibratedFor) {
  const auto picture = MakePicture(MakeGreyJpeg(32, 48), 1, SmallCamera());
  ASSERT_FALSE(picture.ok());
  EXPECT_THAT(picture.error().message, HasSubstr("32 x 48"));
}

TEST(SnapshotCamera, TakesOnePictureAfterAnother) {
  const TemporaryFolder folder;
  CameraOptions options = SmallCamera();
  options.pipeline = "filesrc blocksize=50 location=" + folder.Write("a.jpg", MakeGreyJpeg(64, 48));
  auto camera = OpenCamera(options);
  ASSERT_TRUE(camera.ok()) << camera.error().message;
  for (int i = 0; i < 3; ++i) {
    const auto picture = camera.value()->Take();
    ASSERT_TRUE(picture.ok()) << picture.error().message;
    EXPECT_EQ(picture.value().bytes, MakeGreyJpeg(64, 48));
  }
}

TEST(SnapshotCamera, RecoversAfterABrokenPicture) {
  const TemporaryFolder folder;
  Bytes half = MakeGreyJpeg(64, 48);
  half.resize(half.size() / 2);
  CameraOptions options = SmallCamera();
  options.pipeline = "filesrc location=" + folder.Write("a.jpg", half);
  auto camera = OpenCamera(options);
  ASSERT_TRUE(camera.ok());
  EXPECT_THAT(camera.value()->Take().error().message, HasSubstr("cut off"));
  folder.Write("a.jpg", MakeGreyJpeg(64, 48));
  EXPECT_TRUE(camera.value()->Take().ok());
}

TEST(SnapshotCamera, SaysWhatIsMissing) {
  CameraOptions options = SmallCamera();
  options.pipeline = "filesrc location=/nowhere/at/all.jpg";
  auto camera = OpenCamera(options);
  ASSERT_TRUE(camera.ok());
  EXPECT_THAT(camera.value()->Take().error().message, HasSubstr("/nowhere/at/all.jpg"));
}

TEST(OpenCamera, RefusesAPipelineThatGStreamerDoesNotUnderstand) {
  CameraOptions options = SmallCamera();
  options.pipeline = "nosuchsource ! nothing";
  const auto camera = OpenCamera(options);
  ASSERT_FALSE(camera.ok());
  EXPECT_THAT(camera.error().message, HasSubstr("nosuchsource"));
}

TEST(OpenCamera, OpensSeveralAtOnceInAFreshProcess) {
  std::vector<std::future<std::string>> openings;
  for (int i = 0; i < 8; ++i) {
    openings.push_back(std::async(std::launch::async, [] {
      CameraOptions options = SmallCamera();
      options.pipeline = "souphttpsrc location=http://127.0.0.1:9/none.jpg";
      const auto camera = OpenCamera(options);
      return camera.ok() ? "" : camera.error().message;
    }));
  }
  for (auto& opening : openings) EXPECT_EQ(opening.get(), "");
}

TEST(StreamCamera, GivesAPictureThatWasExposedAfterTheCall) {
  const TemporaryFolder folder;
  CameraOptions options = SmallCamera();
  options.is_stream = true;
  options.latency_s = 0.0;
  options.pipeline = "multifilesrc loop=true location=" + folder.Write("a.jpg", MakeGreyJpeg(64, 48));
  auto camera = OpenCamera(options);
  ASSERT_TRUE(camera.ok()) << camera.error().message;
  const auto before = std::chrono::system_clock::now().time_since_epoch();
  const auto picture = camera.value()->Take();
  ASSERT_TRUE(picture.ok()) << picture.error().message;
  EXPECT_GE(picture.value().exposure_utc_ns,
            std::chrono::duration_cast<std::chrono::nanoseconds>(before).count());
}

TEST(FolderCamera, TakesPicturesInTheOrderOfTheirNamesUntilNoneIsLeft) {
  const TemporaryFolder folder;
  folder.Write("b.jpg", MakeGreyJpeg(64, 48, 128, MakeExifSegment({"2026:11:22 05:00:01", "", "+00:00"})));
  folder.Write("a.jpg", MakeGreyJpeg(64, 48, 128, MakeExifSegment({"2026:11:22 05:00:00", "", "+00:00"})));
  folder.Write("readme.txt", {});
  CameraOptions options = SmallCamera();
  options.folder = folder.path();
  auto camera = OpenCamera(options);
  ASSERT_TRUE(camera.ok());
  EXPECT_EQ(camera.value()->Take().value().exposure_utc_ns, kMoment_s * 1'000'000'000);
  EXPECT_EQ(camera.value()->Take().value().exposure_utc_ns, (kMoment_s + 1) * 1'000'000'000);
  EXPECT_THAT(camera.value()->Take().error().message, HasSubstr("no picture is left"));
}

TEST(OpenCamera, RefusesAMissingOrEmptyFolder) {
  const TemporaryFolder folder;
  CameraOptions options = SmallCamera();
  options.folder = folder.path();
  EXPECT_THAT(OpenCamera(options).error().message, HasSubstr("no JPEG"));
  options.folder = folder.path() + "/missing";
  EXPECT_THAT(OpenCamera(options).error().message, HasSubstr("missing"));
}

}  // namespace
}  // namespace soffit
