#include "service/edge/files/bitmap.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <vector>

namespace soffit {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// 12 x 10 pixels, black, with a white rectangle of 6 x 5 from column 3 and row 2 on.
const std::vector<unsigned char> kGif = {
    0x47, 0x49, 0x46, 0x38, 0x37, 0x61, 0x0c, 0x00, 0x0a, 0x00, 0x81, 0x00, 0x00, 0x00,
    0x00, 0x00, 0xff, 0xff, 0xff, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x2c, 0x00, 0x00,
    0x00, 0x00, 0x0c, 0x00, 0x0a, 0x00, 0x00, 0x08, 0x1f, 0x00, 0x01, 0x08, 0x1c, 0x48,
    0xb0, 0xa0, 0x41, 0x83, 0x01, 0x12, 0x2a, 0x44, 0xa8, 0x30, 0x21, 0xc3, 0x86, 0x0f,
    0x17, 0x16, 0x6c, 0xe8, 0xf0, 0xa0, 0xc5, 0x8b, 0x18, 0x09, 0x06, 0x04, 0x00, 0x3b};

Result<cv::Mat1b> ReadBytes(const std::vector<unsigned char>& bytes) {
  const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
  const fs::path file =
      fs::path(::testing::TempDir()) / ("soffit_" + std::string(info->name()) + std::to_string(getpid()));
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  Result<cv::Mat1b> read = ReadBitmapFile(file);
  fs::remove(file);
  return read;
}

TEST(ReadBitmapFile, ReadsAGif) {
  const Result<cv::Mat1b> bitmap = ReadBytes(kGif);
  ASSERT_TRUE(bitmap.ok()) << bitmap.error().message;
  ASSERT_EQ(bitmap.value().size(), cv::Size(12, 10));
  for (int row = 0; row < 10; ++row) {
    for (int col = 0; col < 12; ++col) {
      const bool is_white = cv::Rect(3, 2, 6, 5).contains({col, row});
      EXPECT_EQ(bitmap.value()(row, col), is_white ? 255 : 0) << row << ", " << col;
    }
  }
}

TEST(ReadBitmapFile, RefusesADamagedOrGiganticGif) {
  const Result<cv::Mat1b> cut = ReadBytes({kGif.begin(), kGif.end() - 20});
  ASSERT_FALSE(cut.ok());
  EXPECT_THAT(cut.error().message, HasSubstr("damaged"));
  std::vector<unsigned char> gigantic = kGif;
  for (const std::size_t at : {6, 7, 8, 9}) gigantic[at] = 0xff;
  const Result<cv::Mat1b> refused = ReadBytes(gigantic);
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.error().message, HasSubstr("too large"));
}

TEST(ReadBitmapFile, RefusesWhatIsNoPicture) { EXPECT_FALSE(ReadBytes({'G', 'I', 'F', '8'}).ok()); }

}  // namespace
}  // namespace soffit
