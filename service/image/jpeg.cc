#include "service/image/jpeg.h"

#include <csetjmp>
#include <cstdio>
// In this order: <jpeglib.h> needs what <cstdio> declares.
#include <jpeglib.h>
// After <jpeglib.h>.
#include <jerror.h>

#include <array>

#include "service/image/picture_memory.h"

namespace soffit {
namespace {

/// libjpeg leaves by a jump when it meets an error: nothing on the way may need a destructor.
struct Reader {
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr errors{};
  std::jmp_buf on_error{};
  std::array<char, JMSG_LENGTH_MAX> problem{};
};

[[noreturn]] void GiveUp(j_common_ptr jpeg) {
  auto* reader = static_cast<Reader*>(jpeg->client_data);
  jpeg->err->format_message(jpeg, reader->problem.data());
  std::longjmp(reader->on_error, 1);
}

/// libjpeg goes on after damage, with grey in place of what is missing, and only warns. Some cameras leave a
/// few bytes between segments: nothing is missing then.
void RefuseDamage(j_common_ptr jpeg, int level) {
  constexpr int kWarning = -1;
  const int code = jpeg->err->msg_code;
  const bool is_harmless =
      code == JWRN_EXTRANEOUS_DATA || code == JWRN_JFIF_MAJOR || code == JWRN_ADOBE_XFORM;
  if (level == kWarning && !is_harmless) GiveUp(jpeg);
}

/// Inverted CMYK is how much of the light each ink lets through.
void ConvertCmyk(const cv::Vec4b* cmyk, int count, cv::Vec3b* bgr) {
  const auto both = [](int a, int b) { return static_cast<std::uint8_t>((a * b + 127) / 255); };
  for (int i = 0; i < count; ++i) {
    const auto [cyan, magenta, yellow, black] = cmyk[i].val;
    bgr[i] = {both(yellow, black), both(magenta, black), both(cyan, black)};
  }
}

void ReadPixels(jpeg_decompress_struct& jpeg, cv::Mat3b& bgr, cv::Mat4b& cmyk_row) {
  jpeg.out_color_space = jpeg.num_components == 4 ? JCS_CMYK : JCS_EXT_BGR;
  jpeg_start_decompress(&jpeg);
  const bool is_cmyk = jpeg.out_color_space == JCS_CMYK;
  for (int y = 0; y < bgr.rows; ++y) {
    JSAMPROW row = is_cmyk ? cmyk_row.data : bgr.ptr(y);
    jpeg_read_scanlines(&jpeg, &row, 1);
    if (is_cmyk) ConvertCmyk(cmyk_row[0], bgr.cols, bgr[y]);
  }
  jpeg_finish_decompress(&jpeg);
}

/// Whether all of `bgr` was read; else `reader.problem` says why not.
bool ReadJpeg(const std::vector<std::uint8_t>& bytes, Reader& reader, cv::Mat3b& bgr, cv::Mat4b& cmyk_row) {
  jpeg_decompress_struct& jpeg = reader.jpeg;
  if (setjmp(reader.on_error) != 0) {
    jpeg_destroy_decompress(&jpeg);
    return false;
  }
  jpeg_create_decompress(&jpeg);
  jpeg_mem_src(&jpeg, bytes.data(), bytes.size());
  jpeg_read_header(&jpeg, TRUE);
  const bool has_size = jpeg.image_width == static_cast<JDIMENSION>(bgr.cols) &&
                        jpeg.image_height == static_cast<JDIMENSION>(bgr.rows);
  if (has_size) ReadPixels(jpeg, bgr, cmyk_row);
  jpeg_destroy_decompress(&jpeg);
  return has_size;
}

}  // namespace

Result<cv::Mat3b> DecodeJpeg(const std::vector<std::uint8_t>& bytes, const cv::Size& size) {
  Reader reader;
  reader.jpeg.err = jpeg_std_error(&reader.errors);
  reader.jpeg.client_data = &reader;
  reader.errors.error_exit = GiveUp;
  reader.errors.emit_message = RefuseDamage;
  cv::Mat3b bgr = NewPicture(size, CV_8UC3);
  cv::Mat4b cmyk_row(1, size.width);
  if (ReadJpeg(bytes, reader, bgr, cmyk_row)) return bgr;
  const std::string problem = reader.problem.data();
  return InvalidInput("the JPEG is damaged" + (problem.empty() ? problem : ": " + problem));
}

}  // namespace soffit
