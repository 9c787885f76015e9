#include "service/image/picture_header.h"

#include <algorithm>
#include <array>

namespace soffit {
namespace {

constexpr std::array<std::uint8_t, 8> kPngMagic = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

std::uint32_t BigEndian(const std::vector<std::uint8_t>& bytes, std::size_t at, int count) {
  std::uint32_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | bytes[at + static_cast<std::size_t>(i)];
  return value;
}

Error EndsTooEarly(const char* format) {
  return InvalidInput(std::string("the ") + format + " ends too early");
}

bool IsFrameHeader(std::uint8_t marker) {  // SOF0 to SOF15, without DHT, JPG and DAC between them.
  return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

Result<PictureHeader> ReadJpegHeader(const std::vector<std::uint8_t>& bytes) {
  constexpr std::uint8_t kEnd = 0xd9;
  constexpr std::uint8_t kScan = 0xda;
  PictureHeader header;
  header.scans = 0;
  std::size_t at = 2;
  while (at + 1 < bytes.size()) {
    const std::uint8_t marker = bytes[at + 1];
    const bool is_marker = bytes[at] == 0xff && marker != 0x00 && marker != 0xff;
    const bool stands_alone = marker >= 0xd0 && marker <= 0xd7;
    if (!is_marker || stands_alone) {  // Entropy-coded data, fill bytes or a restart.
      ++at;
      continue;
    }
    if (marker == kEnd) {
      if (header.scans == 0 || header.width_px == 0) return InvalidInput("the JPEG has no picture in it");
      return header;
    }
    if (at + 4 > bytes.size()) break;
    const std::size_t length = BigEndian(bytes, at + 2, 2);
    if (length < 2 || at + 2 + length > bytes.size()) break;
    if (IsFrameHeader(marker)) {
      if (length < 8) return InvalidInput("the JPEG's frame header is damaged");
      if (header.width_px != 0) return InvalidInput("the JPEG has more than one frame");
      header.height_px = BigEndian(bytes, at + 5, 2);
      header.width_px = BigEndian(bytes, at + 7, 2);
    }
    if (marker == kScan) ++header.scans;
    at += 2 + length;
  }
  return EndsTooEarly("JPEG");
}

Result<PictureHeader> ReadPngHeader(const std::vector<std::uint8_t>& bytes) {
  constexpr std::uint32_t kIhdr = 0x49484452;
  constexpr std::uint32_t kTrns = 0x74524e53;
  constexpr std::uint32_t kIend = 0x49454e44;
  constexpr std::uint8_t kColored = 2;
  constexpr std::uint8_t kAlphaChannel = 4;
  std::size_t at = kPngMagic.size();
  PictureHeader header;
  header.format = PictureFormat::kPng;
  std::uint8_t color_type = 0;
  while (at + 12 <= bytes.size()) {
    const std::size_t length = BigEndian(bytes, at, 4);
    const std::uint32_t type = BigEndian(bytes, at + 4, 4);
    if (header.width_px == 0) {
      if (type != kIhdr || length != 13 || at + 25 > bytes.size())
        return InvalidInput("the PNG has no header");
      header.width_px = BigEndian(bytes, at + 8, 4);
      header.height_px = BigEndian(bytes, at + 12, 4);
      if (header.width_px == 0) return InvalidInput("the PNG has no pixels");
      color_type = bytes[at + 17];
      header.has_alpha = (color_type & kAlphaChannel) != 0;
    }
    if (type == kTrns && (color_type & kColored) != 0) header.has_alpha = true;
    if (length > bytes.size() - at - 12) break;
    if (type == kIend) return header;
    at += 12 + length;
  }
  return EndsTooEarly("PNG");
}

}  // namespace

Result<PictureHeader> ReadPictureHeader(const std::vector<std::uint8_t>& bytes) {
  if (bytes.size() >= 3 && bytes[0] == 0xff && bytes[1] == 0xd8 && bytes[2] == 0xff)
    return ReadJpegHeader(bytes);
  if (bytes.size() >= kPngMagic.size() && std::equal(kPngMagic.begin(), kPngMagic.end(), bytes.begin())) {
    return ReadPngHeader(bytes);
  }
  return InvalidInput("neither a JPEG nor a PNG");
}

}  // namespace soffit
