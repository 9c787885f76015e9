#include "service/scene/labels.h"

#include <opencv2/imgproc.hpp>

namespace soffit {
namespace {

cv::Mat Square(int reach) {
  return cv::getStructuringElement(cv::MORPH_RECT, cv::Size(2 * reach + 1, 2 * reach + 1));
}

}  // namespace

cv::Mat1b Only(const cv::Mat1b& labels, Seen wanted) {
  cv::Mat1b mask;
  cv::compare(labels, static_cast<double>(wanted), mask, cv::CMP_EQ);
  return mask;
}

cv::Mat1b Both(const cv::Mat1b& a, const cv::Mat1b& b) {
  cv::Mat1b both;
  cv::bitwise_and(a, b, both);
  return both;
}

cv::Mat1b Either(const cv::Mat1b& a, const cv::Mat1b& b) {
  cv::Mat1b either;
  cv::bitwise_or(a, b, either);
  return either;
}

cv::Mat1b Grow(const cv::Mat1b& mask, int reach) {
  cv::Mat1b grown;
  cv::dilate(mask, grown, Square(reach));
  return grown;
}

cv::Mat1b Shrink(const cv::Mat1b& mask, int reach) {
  cv::Mat1b shrunk;
  cv::erode(mask, shrunk, Square(reach));
  return shrunk;
}

cv::Mat1b Border(const cv::Mat1b& mask, int reach) {
  cv::Mat1b border;
  cv::subtract(Grow(mask, reach), Shrink(mask, reach), border);
  return border;
}

}  // namespace soffit
