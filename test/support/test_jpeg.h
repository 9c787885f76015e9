#pragma once

#include <libexif/exif-data.h>
#include <turbojpeg.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>
#include <vector>

namespace soffit {

using Bytes = std::vector<std::uint8_t>;

inline void AddExifText(ExifData* data, int tag, const std::string& text) {
  ExifEntry* entry = exif_entry_new();
  exif_content_add_entry(data->ifd[EXIF_IFD_EXIF], entry);
  entry->tag = static_cast<ExifTag>(tag);
  entry->format = EXIF_FORMAT_ASCII;
  entry->components = text.size() + 1;
  entry->size = static_cast<unsigned>(text.size() + 1);
  entry->data = static_cast<unsigned char*>(std::calloc(1, entry->size));
  std::memcpy(entry->data, text.data(), text.size());
  exif_entry_unref(entry);
}

struct TestExif {
  std::string time;  ///< "2026:11:22 05:00:00"; empty: left out.
  std::string fraction;
  std::string offset;
};

/// An APP1 segment of EXIF data, which are released.
inline Bytes TakeSegment(ExifData* data) {
  unsigned char* saved = nullptr;
  unsigned size = 0;
  exif_data_save_data(data, &saved, &size);
  Bytes segment(4 + size);
  segment[0] = 0xff;
  segment[1] = 0xe1;
  segment[2] = static_cast<std::uint8_t>((size + 2) >> 8);
  segment[3] = static_cast<std::uint8_t>(size + 2);
  std::copy(saved, saved + size, segment.begin() + 4);
  std::free(saved);
  exif_data_unref(data);
  return segment;
}

/// An APP1 segment that tells the time of exposure.
inline Bytes MakeExifSegment(const TestExif& exif) {
  ExifData* data = exif_data_new();
  if (!exif.time.empty()) AddExifText(data, 0x9003, exif.time);
  if (!exif.fraction.empty()) AddExifText(data, 0x9291, exif.fraction);
  if (!exif.offset.empty()) AddExifText(data, 0x9011, exif.offset);
  return TakeSegment(data);
}

/// An APP1 segment that tells the shutter time.
inline Bytes MakeShutterSegment(unsigned numerator, unsigned denominator) {
  ExifData* data = exif_data_new();
  exif_data_set_byte_order(data, EXIF_BYTE_ORDER_INTEL);
  ExifEntry* entry = exif_entry_new();
  exif_content_add_entry(data->ifd[EXIF_IFD_EXIF], entry);
  exif_entry_initialize(entry, EXIF_TAG_EXPOSURE_TIME);
  exif_set_rational(entry->data, EXIF_BYTE_ORDER_INTEL, {numerator, denominator});
  exif_entry_unref(entry);
  return TakeSegment(data);
}

inline Bytes EncodeGrey(const Bytes& pixels, int width_px, int height_px) {
  tjhandle encoder = tjInitCompress();
  unsigned char* coded = nullptr;
  unsigned long size = 0;
  tjCompress2(encoder, pixels.data(), width_px, 0, height_px, TJPF_GRAY, &coded, &size, TJSAMP_GRAY, 85, 0);
  Bytes bytes(coded, coded + size);
  tjFree(coded);
  tjDestroy(encoder);
  return bytes;
}

/// A real picture: level `grey`, 0 black to 255 white, with a slant of a few levels.
inline Bytes MakeGreyJpeg(int width_px, int height_px, int grey = 128, const Bytes& segment = {}) {
  Bytes pixels;
  for (int i = 0; i < width_px * height_px; ++i) {
    pixels.push_back(static_cast<std::uint8_t>(std::clamp(grey + i % width_px / 16, 0, 255)));
  }
  Bytes bytes = EncodeGrey(pixels, width_px, height_px);
  bytes.insert(bytes.begin() + 2, segment.begin(), segment.end());
  return bytes;
}

/// A real picture that is large for its size.
inline Bytes MakeNoiseJpeg(int width_px, int height_px) {
  std::mt19937 random(1);
  Bytes pixels(static_cast<std::size_t>(width_px * height_px));
  for (std::uint8_t& pixel : pixels) pixel = static_cast<std::uint8_t>(random());
  return EncodeGrey(pixels, width_px, height_px);
}

/// A file with the structure of a JPEG: it shows nothing.
inline Bytes MakeTestJpeg(int width_px, int height_px, const Bytes& segment = {}) {
  Bytes bytes = {0xff, 0xd8};
  bytes.insert(bytes.end(), segment.begin(), segment.end());
  const auto high = [](int value) { return static_cast<std::uint8_t>(value >> 8); };
  const auto low = [](int value) { return static_cast<std::uint8_t>(value); };
  const Bytes rest = {0xff,
                      0xc0,
                      0,
                      11,
                      8,
                      high(height_px),
                      low(height_px),
                      high(width_px),
                      low(width_px),
                      1,
                      1,
                      0x11,
                      0,
                      0xff,
                      0xda,
                      0,
                      8,
                      1,
                      1,
                      0,
                      0,
                      63,
                      0,
                      0x12,
                      0x34,
                      0xff,
                      0x00,
                      0x56,
                      0xff,
                      0xd0,
                      0x78,  // Data with a stuffed byte and a restart marker.
                      0xff,
                      0xd9};
  bytes.insert(bytes.end(), rest.begin(), rest.end());
  return bytes;
}

}  // namespace soffit
