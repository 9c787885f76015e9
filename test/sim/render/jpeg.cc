#include <libexif/exif-data.h>

#include <algorithm>
#include <cstring>
#include <ctime>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <string>

#include "test/sim/render/renderer.h"

namespace soffit::sim {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;

void PutText(ExifData* data, ExifTag tag, const std::string& text) {
  ExifEntry* entry = exif_entry_new();
  entry->tag = tag;
  entry->format = EXIF_FORMAT_ASCII;
  entry->components = text.size() + 1;
  entry->size = static_cast<unsigned>(text.size() + 1);
  entry->data = static_cast<unsigned char*>(std::malloc(entry->size));  // Freed by libexif.
  std::memcpy(entry->data, text.c_str(), entry->size);
  exif_content_add_entry(data->ifd[EXIF_IFD_EXIF], entry);
  exif_entry_unref(entry);
}

std::vector<std::uint8_t> MakeExif(std::int64_t utc_ns) {
  const std::time_t seconds = static_cast<std::time_t>(utc_ns / kNsPerSecond);
  std::tm calendar{};
  gmtime_r(&seconds, &calendar);
  char date[32];
  std::strftime(date, sizeof(date), "%Y:%m:%d %H:%M:%S", &calendar);
  const std::string fraction = std::to_string(kNsPerSecond + utc_ns % kNsPerSecond).substr(1);

  const std::unique_ptr<ExifData, void (*)(ExifData*)> data(exif_data_new(), &exif_data_unref);
  exif_data_set_option(data.get(), EXIF_DATA_OPTION_FOLLOW_SPECIFICATION);
  exif_data_set_data_type(data.get(), EXIF_DATA_TYPE_COMPRESSED);
  exif_data_set_byte_order(data.get(), EXIF_BYTE_ORDER_INTEL);
  PutText(data.get(), EXIF_TAG_DATE_TIME_ORIGINAL, date);
  PutText(data.get(), EXIF_TAG_SUB_SEC_TIME_ORIGINAL, fraction);
  PutText(data.get(), EXIF_TAG_OFFSET_TIME_ORIGINAL, "+00:00");
  unsigned char* bytes = nullptr;
  unsigned size = 0;
  exif_data_save_data(data.get(), &bytes, &size);
  const std::vector<std::uint8_t> exif(bytes, bytes + size);
  std::free(bytes);
  return exif;
}

}  // namespace

std::vector<std::uint8_t> EncodeJpeg(const cv::Mat3b& picture, int quality,
                                     std::int64_t mid_exposure_utc_ns) {
  std::vector<std::uint8_t> jpeg;
  if (!cv::imencode(".jpg", picture, jpeg, {cv::IMWRITE_JPEG_QUALITY, quality}))
    throw std::runtime_error("JPEG encoder failed");
  const std::vector<std::uint8_t> exif = MakeExif(mid_exposure_utc_ns);
  const std::size_t length = exif.size() + 2;
  std::vector<std::uint8_t> with_exif(jpeg.size() + exif.size() + 4);
  auto out = std::copy_n(jpeg.begin(), 2, with_exif.begin());  // The start marker, then the EXIF segment.
  for (const std::size_t byte : {std::size_t{0xFF}, std::size_t{0xE1}, length >> 8U, length & 0xFFU}) {
    *out++ = static_cast<std::uint8_t>(byte);
  }
  out = std::copy(exif.begin(), exif.end(), out);
  std::copy(jpeg.begin() + 2, jpeg.end(), out);
  return with_exif;
}

}  // namespace soffit::sim
