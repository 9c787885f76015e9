#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "shared/result/result.h"

namespace soffit {

struct JpegInfo {
  int width_px = 0;
  int height_px = 0;
};

/// Whether the bytes are one whole JPEG file, from its first marker to its last: every segment within the
/// file, one frame header before the first scan, the end marker at the end (padding behind it is allowed).
/// Nothing is decoded. The error says what is wrong.
Result<JpegInfo> CheckJpeg(std::span<const std::uint8_t> bytes);

/// UTC nanoseconds of the exposure by the picture's EXIF data: DateTimeOriginal, SubSecTimeOriginal and
/// OffsetTimeOriginal. None when one of the first and the last is missing or malformed: a local time without
/// its offset says nothing.
std::optional<std::int64_t> FindExposureTime(std::span<const std::uint8_t> jpeg);

/// How long the shutter was open by the picture's EXIF data (ExposureTime), in seconds. None when it does not
/// say so, or nonsense.
std::optional<double> FindShutterTime(std::span<const std::uint8_t> jpeg);

/// Decodes a picture that CheckJpeg found whole, at an eighth of its size, and says what makes it useless: it
/// cannot be decoded, or it is black or white nearly everywhere. Empty: nothing does.
std::string FindExposureProblem(std::span<const std::uint8_t> jpeg);

}  // namespace soffit
