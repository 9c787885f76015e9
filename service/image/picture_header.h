#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "shared/result/result.h"

namespace soffit {

enum class PictureFormat { kJpeg, kPng };

/// What the first bytes of a picture say about the rest, read without decoding anything.
struct PictureHeader {
  PictureFormat format = PictureFormat::kJpeg;
  std::int64_t width_px = 0;
  std::int64_t height_px = 0;
  bool has_alpha = false;  ///< PNG: an alpha channel, or colours that are transparent.
  int scans = 1;           ///< JPEG: the number of scans; PNG: 1.
};

/// Reads the header of a JPEG (ITU-T T.81, annex B) or a PNG (ISO/IEC 15948, section 5), told by their magic.
/// An error for anything else, and for a file that ends too early. Pure; O(bytes).
Result<PictureHeader> ReadPictureHeader(const std::vector<std::uint8_t>& bytes);

}  // namespace soffit
