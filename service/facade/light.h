#pragma once

#include <opencv2/core.hpp>

namespace soffit {

/// About as light adds up: a picture's gamma undone. From 0 to 255^2.
inline cv::Vec3f Light(const cv::Vec3b& color) {
  const cv::Vec3f value(color);
  return value.mul(value);
}

}  // namespace soffit
