#include "service/image/picture_memory.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>

namespace soffit {

cv::Mat NewPicture(cv::Size size, int type) {
  cv::Mat picture(size, type);
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const std::uintptr_t begin = (reinterpret_cast<std::uintptr_t>(picture.data) + page - 1) / page * page;
  const std::uintptr_t end = reinterpret_cast<std::uintptr_t>(picture.dataend) / page * page;
  // Advice only: where it is not taken, the picture lies in small pages.
  if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
  return picture;
}

}  // namespace soffit
