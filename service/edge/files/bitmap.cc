#include "service/edge/files/bitmap.h"

#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "service/edge/files/file.h"
#include "service/image/image.h"

namespace soffit {

Result<cv::Mat1b> ReadBitmapFile(const std::filesystem::path& file) {
  const ImageOptions options;
  const Result<std::vector<std::uint8_t>> bytes = ReadFile(file, options.max_bytes);
  if (!bytes.ok()) return bytes.error();
  const Result<cv::Mat3b> picture = DecodePicture(bytes.value(), options);
  if (!picture.ok()) return Error{picture.error().code, file.string() + ": " + picture.error().message};
  cv::Mat1b grey;
  cv::cvtColor(picture.value(), grey, cv::COLOR_BGR2GRAY);
  return grey;
}

}  // namespace soffit
