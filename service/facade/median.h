#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "shared/result/result.h"

namespace soffit {

/// The upper one of the two in the middle of an even number. `values` are at least one.
inline double Median(std::vector<double> values) {
  SOFFIT_EXPECT(!values.empty());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace soffit
