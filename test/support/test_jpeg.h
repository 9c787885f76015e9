#pragma once

#include <libexif/exif-data.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
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

/// An APP1 segment.
inline Bytes MakeExifSegment(const TestExif& exif) {
  ExifData* data = exif_data_new();
  if (!exif.time.empty()) AddExifText(data, 0x9003, exif.time);
  if (!exif.fraction.empty()) AddExifText(data, 0x9291, exif.fraction);
  if (!exif.offset.empty()) AddExifText(data, 0x9011, exif.offset);
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

/// A file with the structure of a JPEG: what it shows does not matter.
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
