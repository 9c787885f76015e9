#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "service/image/image.h"
#include "shared/options/options.h"

namespace soffit {

/// Which colour class each pixel belongs to.
struct Mask {
  cv::Mat1b label;                   ///< 0: none (background); i + 1: `classes[i]`. Size of the picture.
  std::vector<std::string> classes;  ///< As in the options.
  double confidence = 0.0;           ///< 0 to 1: how well the classes are separated from the background.
};

struct MaskOptions {
  std::vector<std::string> colors = {"red", "blue", "yellow"};
  int median_px = 7;
  double gamma = 1.0;
  double min_saturation = 0.45;
  double min_value = 0.10;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("colors", self.colors,
          OptionInfo{0, 0, "", "Colours of buildings: red orange yellow green cyan blue magenta"});
    field("median_px", self.median_px,
          OptionInfo{1, 15, "px", "Median filter against noise, odd (paper: 7)"});
    field("gamma", self.gamma, OptionInfo{0.2, 5.0, "", "Gamma correction before the colour extraction"});
    field("min_saturation", self.min_saturation,
          OptionInfo{0.0, 1.0, "",
                     "Less saturated pixels are background, where the picture itself does not tell better"});
    field("min_value", self.min_value, OptionInfo{0.0, 1.0, "", "Darker pixels are background"});
  }
};

/// Extracts the pixels of buildings by colour: median filter, gamma correction, HSV classes (paper,
/// section 2.2). Throws ContractViolation when an option is invalid or a colour is unknown. Pure; O(pixels).
Mask SegmentBuildings(const Image& image, const MaskOptions& options);

}  // namespace soffit
