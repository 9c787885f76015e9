#include "service/facade/seam.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "service/facade/light.h"

namespace soffit {
namespace {

constexpr double kSeam_px = 5.0;         // On either side of the labelled wall's end.
constexpr double kMostOffMixture = 0.2;  // Of the way from one colour to the other.

/// For each cell the nearest one of a kind that is surrounded by its like, and how far away it is.
struct Nearest {
  cv::Mat1f distance;
  cv::Mat1i label;
  std::vector<cv::Point> cells;  ///< By label.

  explicit Nearest(const cv::Mat1b& kind) {
    cv::Mat1b core;
    cv::erode(kind, core, cv::Mat());
    cv::bitwise_not(core, core);
    cv::distanceTransform(core, distance, label, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
    double count = 0.0;
    cv::minMaxLoc(label, nullptr, &count);
    cells.resize(static_cast<std::size_t>(count) + 1);
    for (int y = 0; y < core.rows; ++y) {
      for (int x = 0; x < core.cols; ++x) {
        if (core(y, x) == 0) cells[static_cast<std::size_t>(label(y, x))] = {x, y};
      }
    }
  }
  const cv::Point& At(int row, int column) const {
    return cells[static_cast<std::size_t>(label(row, column))];
  }
};

/// Whether a colour is a mixture of two others, of the first more than of the second.
bool IsMostly(const cv::Vec3b& first, const cv::Vec3b& second, const cv::Vec3b& mixed) {
  const cv::Vec3f way = Light(second) - Light(first);
  const cv::Vec3f part = Light(mixed) - Light(first);
  const float share = way.dot(part) / std::max(1.0F, way.dot(way));
  return share < 0.5F && cv::norm(part - share * way) < kMostOffMixture * cv::norm(way);
}

}  // namespace

cv::Mat1b SplitSeams(const Elevation& view) {
  const double seam = kSeam_px * view.pixel_m / view.cell_m;
  cv::Mat1b wall, beyond;
  cv::compare(view.seen, static_cast<double>(Seen::kStructure), wall, cv::CMP_EQ);
  const Nearest own(wall);
  cv::compare(own.distance, seam, beyond, cv::CMP_GT);
  const Nearest far(beyond);
  cv::Mat1b open(view.seen.size(), uchar{255});
  for (int row = 0; row < open.rows; ++row) {
    for (int column = 0; column < open.cols; ++column) {
      if (wall(row, column) != 0) continue;
      if (own.distance(row, column) + far.distance(row, column) > 2.0 * seam) continue;
      if (IsMostly(view.bgr(own.At(row, column)), view.bgr(far.At(row, column)), view.bgr(row, column)))
        open(row, column) = 0;
    }
  }
  return open;
}

}  // namespace soffit
