#include "vehicle_agent/camera/jpeg.h"

#include <libexif/exif-data.h>
#include <turbojpeg.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstdio>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace soffit {
namespace {

constexpr std::uint8_t kStartOfImage = 0xd8;
constexpr std::uint8_t kEndOfImage = 0xd9;
constexpr std::uint8_t kStartOfScan = 0xda;

bool IsFrameHeader(std::uint8_t marker) {
  return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

bool StandsAlone(std::uint8_t marker) { return marker == 0x01 || (marker >= 0xd0 && marker <= 0xd7); }

/// Position of the marker that ends the entropy-coded data from `at` on; the size of the file when there is
/// none.
std::size_t SkipScan(std::span<const std::uint8_t> bytes, std::size_t at) {
  for (; at + 1 < bytes.size(); ++at) {
    const std::uint8_t next = bytes[at + 1];
    if (bytes[at] == 0xff && next != 0x00 && next != 0xff && !(next >= 0xd0 && next <= 0xd7)) return at;
  }
  return bytes.size();
}

using OwnedExif = std::unique_ptr<ExifData, decltype(&exif_data_unref)>;

OwnedExif ReadExif(std::span<const std::uint8_t> jpeg) {
  const bool is_readable = jpeg.size() <= std::numeric_limits<unsigned>::max();
  return {is_readable ? exif_data_new_from_data(jpeg.data(), static_cast<unsigned>(jpeg.size())) : nullptr,
          &exif_data_unref};
}

std::string ReadText(ExifData& data, ExifTag tag) {
  const ExifEntry* entry = exif_content_get_entry(data.ifd[EXIF_IFD_EXIF], tag);
  if (entry == nullptr || entry->data == nullptr || entry->format != EXIF_FORMAT_ASCII) return {};
  const auto* begin = reinterpret_cast<const char*>(entry->data);
  return {begin, std::find(begin, begin + entry->size, '\0')};
}

/// Digits behind the decimal point, as nanoseconds.
std::int64_t ParseFraction_ns(const std::string& digits) {
  std::int64_t ns = 0;
  std::int64_t unit = 100'000'000;
  for (const char c : digits) {
    if (std::isdigit(static_cast<unsigned char>(c)) == 0) break;
    ns += (c - '0') * unit;
    unit /= 10;
  }
  return ns;
}

/// "+02:00" as seconds.
std::optional<std::int64_t> ParseOffset_s(const std::string& text) {
  char sign = 0;
  int hours = 0;
  int minutes = 0;
  if (text == "Z") return 0;
  if (std::sscanf(text.c_str(), "%c%2d:%2d", &sign, &hours, &minutes) != 3) return std::nullopt;
  if ((sign != '+' && sign != '-') || hours < 0 || hours > 14 || minutes < 0 || minutes > 59)
    return std::nullopt;
  return (sign == '+' ? 1 : -1) * (hours * 3600 + minutes * 60);
}

std::optional<std::int64_t> ParseDateTime_s(const std::string& text) {
  int year = 0;
  unsigned month = 0;
  unsigned day = 0;
  int hour = 0;
  int minute = 0;
  int second = 0;
  if (std::sscanf(text.c_str(), "%4d:%2u:%2u %2d:%2d:%2d", &year, &month, &day, &hour, &minute, &second) !=
      6) {
    return std::nullopt;
  }
  using namespace std::chrono;
  const year_month_day date{std::chrono::year(year), std::chrono::month(month), std::chrono::day(day)};
  const bool is_time = hour >= 0 && hour < 24 && minute >= 0 && minute < 60 && second >= 0 && second < 61;
  if (!date.ok() || !is_time || year < 1970 || year > 2200) return std::nullopt;
  const seconds time = hours(hour) + minutes(minute) + seconds(second);
  return (sys_days(date).time_since_epoch() + time).count();
}

}  // namespace

Result<JpegInfo> CheckJpeg(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 4 || bytes[0] != 0xff || bytes[1] != kStartOfImage)
    return InvalidInput("not a JPEG picture");
  JpegInfo info;
  std::size_t at = 2;
  while (true) {
    while (at < bytes.size() && bytes[at] == 0xff && at + 1 < bytes.size() && bytes[at + 1] == 0xff) ++at;
    if (at + 2 > bytes.size()) return InvalidInput("the picture is cut off: its end marker is missing");
    if (bytes[at] != 0xff) return InvalidInput("the picture is damaged: a marker is missing");
    const std::uint8_t marker = bytes[at + 1];
    at += 2;
    if (marker == kEndOfImage) break;
    if (StandsAlone(marker)) continue;
    if (at + 2 > bytes.size()) return InvalidInput("the picture is cut off within a segment");
    const std::size_t length = static_cast<std::size_t>(bytes[at]) << 8 | bytes[at + 1];
    if (length < 2 || at + length > bytes.size())
      return InvalidInput("the picture is cut off within a segment");
    if (IsFrameHeader(marker)) {
      if (length < 8) return InvalidInput("the picture is damaged: its frame header is too short");
      info.height_px = bytes[at + 3] << 8 | bytes[at + 4];
      info.width_px = bytes[at + 5] << 8 | bytes[at + 6];
    }
    at += length;
    if (marker != kStartOfScan) continue;
    if (info.width_px == 0 || info.height_px == 0)
      return InvalidInput("the picture is damaged: it has no size");
    at = SkipScan(bytes, at);
  }
  if (info.width_px == 0 || info.height_px == 0) return InvalidInput("the picture is empty");
  return info;
}

std::optional<std::int64_t> FindExposureTime(std::span<const std::uint8_t> jpeg) {
  const OwnedExif data = ReadExif(jpeg);
  if (!data) return std::nullopt;
  constexpr auto kOffsetTimeOriginal = static_cast<ExifTag>(0x9011);
  const auto local_s = ParseDateTime_s(ReadText(*data, EXIF_TAG_DATE_TIME_ORIGINAL));
  const auto offset_s = ParseOffset_s(ReadText(*data, kOffsetTimeOriginal));
  if (!local_s || !offset_s) return std::nullopt;
  return (*local_s - *offset_s) * 1'000'000'000 +
         ParseFraction_ns(ReadText(*data, EXIF_TAG_SUB_SEC_TIME_ORIGINAL));
}

std::optional<double> FindShutterTime(std::span<const std::uint8_t> jpeg) {
  const OwnedExif data = ReadExif(jpeg);
  if (!data) return std::nullopt;
  const ExifEntry* entry = exif_content_get_entry(data->ifd[EXIF_IFD_EXIF], EXIF_TAG_EXPOSURE_TIME);
  if (entry == nullptr || entry->format != EXIF_FORMAT_RATIONAL || entry->size < 8) return std::nullopt;
  const ExifRational time = exif_get_rational(entry->data, exif_data_get_byte_order(data.get()));
  const double time_s = static_cast<double>(time.numerator) / static_cast<double>(time.denominator);
  constexpr double kLongest_s = 60.0;
  if (!(time_s > 0.0 && time_s <= kLongest_s)) return std::nullopt;
  return time_s;
}

std::string FindExposureProblem(std::span<const std::uint8_t> jpeg) {
  constexpr tjscalingfactor kEighth = {1, 8};
  constexpr double kShare = 0.05;  // Of the pixels, that may be brighter, or darker.
  constexpr std::size_t kDark = 24;
  constexpr std::size_t kBright = 232;
  const std::unique_ptr<void, decltype(&tjDestroy)> decoder(tjInitDecompress(), &tjDestroy);
  int width_px = 0;
  int height_px = 0;
  int sampling = 0;
  int colors = 0;
  const auto size = static_cast<unsigned long>(jpeg.size());
  if (tjDecompressHeader3(decoder.get(), jpeg.data(), size, &width_px, &height_px, &sampling, &colors) != 0) {
    return std::string("the picture cannot be decoded: ") + tjGetErrorStr2(decoder.get());
  }
  const int small_width_px = TJSCALED(width_px, kEighth);
  const int small_height_px = TJSCALED(height_px, kEighth);
  std::vector<std::uint8_t> grey(static_cast<std::size_t>(small_width_px) *
                                 static_cast<std::size_t>(small_height_px));
  const int flags = TJFLAG_FASTDCT | TJFLAG_STOPONWARNING;
  if (tjDecompress2(decoder.get(), jpeg.data(), size, grey.data(), small_width_px, 0, small_height_px,
                    TJPF_GRAY, flags) != 0) {
    return std::string("the picture cannot be decoded: ") + tjGetErrorStr2(decoder.get());
  }
  const auto few = static_cast<std::ptrdiff_t>(kShare * static_cast<double>(grey.size()));
  std::ranges::nth_element(grey, grey.begin() + few);
  if (grey[static_cast<std::size_t>(few)] > kBright)
    return "the picture is overexposed: nearly all of it is white";
  std::ranges::nth_element(grey, grey.end() - 1 - few);
  if (*(grey.end() - 1 - few) < kDark) return "the picture is underexposed: nearly all of it is black";
  return {};
}

}  // namespace soffit
