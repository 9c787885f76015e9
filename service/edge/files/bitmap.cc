#include "service/edge/files/bitmap.h"

#include <gdal_priv.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "service/edge/files/file.h"
#include "service/image/image.h"

namespace soffit {
namespace {

struct CloseDataset {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};

bool IsGif(const std::vector<std::uint8_t>& bytes) {
  constexpr std::uint8_t kMagic[] = {'G', 'I', 'F', '8'};
  return bytes.size() >= 10 && std::equal(std::begin(kMagic), std::end(kMagic), bytes.begin());
}

/// Greyscale of the 256 colours of a table.
cv::Mat1b GreyOf(const GDALColorTable* colors) {
  cv::Mat1b grey(1, 256, uchar{0});
  for (int i = 0; colors != nullptr && i < std::min(256, colors->GetColorEntryCount()); ++i) {
    const GDALColorEntry& color = *colors->GetColorEntry(i);
    grey(i) = cv::saturate_cast<uchar>(0.299 * color.c1 + 0.587 * color.c2 + 0.114 * color.c3);
  }
  return grey;
}

/// The first picture of a GIF. `bytes` are those of the file.
Result<cv::Mat1b> ReadGif(const std::filesystem::path& file, const std::vector<std::uint8_t>& bytes,
                          double max_megapixels) {
  const cv::Size size(bytes[6] | bytes[7] << 8, bytes[8] | bytes[9] << 8);
  if (size.width * static_cast<double>(size.height) > max_megapixels * 1e6) {
    return Error{Error::Code::kTooLarge, file.string() + ": the GIF is too large"};
  }
  static const bool is_registered = (GDALAllRegister(), true);
  const char* const drivers[] = {"GIF", "BIGGIF", nullptr};
  CPLPushErrorHandler(CPLQuietErrorHandler);
  const std::unique_ptr<GDALDataset, CloseDataset> gif(
      is_registered ? GDALDataset::Open(file.c_str(), GDAL_OF_RASTER, drivers) : nullptr);
  cv::Mat1b picture(size);
  const bool is_read =
      gif && gif->GetRasterCount() > 0 && gif->GetRasterXSize() == size.width &&
      gif->GetRasterYSize() == size.height &&
      gif->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, size.width, size.height, picture.data, size.width,
                                      size.height, GDT_Byte, 0, 0, nullptr) == CE_None;
  CPLPopErrorHandler();
  if (!is_read) return InvalidInput(file.string() + ": the GIF is damaged");
  cv::LUT(picture, GreyOf(gif->GetRasterBand(1)->GetColorTable()), picture);
  return picture;
}

}  // namespace

Result<cv::Mat1b> ReadBitmapFile(const std::filesystem::path& file) {
  const ImageOptions options;
  const Result<std::vector<std::uint8_t>> bytes = ReadFile(file, options.max_bytes);
  if (!bytes.ok()) return bytes.error();
  if (IsGif(bytes.value())) return ReadGif(file, bytes.value(), options.max_megapixels);
  const Result<cv::Mat3b> picture = DecodePicture(bytes.value(), options);
  if (!picture.ok()) return Error{picture.error().code, file.string() + ": " + picture.error().message};
  cv::Mat1b grey;
  cv::cvtColor(picture.value(), grey, cv::COLOR_BGR2GRAY);
  return grey;
}

}  // namespace soffit
