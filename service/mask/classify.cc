// Highway compiles this file once for each instruction set, see median.cc.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "service/mask/classify.cc"
#include "service/mask/classify.h"

#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace soffit {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Levels = hn::ScalableTag<std::int16_t>;
using Bytes = hn::Rebind<std::uint8_t, Levels>;
using Vector = hn::Vec<Levels>;
using Mask = hn::Mask<Levels>;

/// In each lane, the value for the channel that is greatest there.
HWY_INLINE Vector Choose(const ColorClasses::ByChannel& values, Mask is_red, Mask is_green) {
  const Levels d;
  return hn::IfThenElse(is_red, hn::Set(d, values[0]),
                        hn::IfThenElse(is_green, hn::Set(d, values[1]), hn::Set(d, values[2])));
}

/// All products stay below 128 * 255, so that 16 bits hold them.
HWY_INLINE Vector ClassOf(const ColorClasses& classes, Vector blue, Vector green, Vector red) {
  const Levels d;
  const Vector value = hn::Max(hn::Max(blue, green), red);
  const Vector range = hn::Sub(value, hn::Min(hn::Min(blue, green), red));
  const Mask is_red = hn::Eq(value, red);
  const Mask is_green = hn::Eq(value, green);
  const Vector hue = hn::ShiftLeft<7>(hn::IfThenElse(
      is_red, hn::Sub(green, blue), hn::IfThenElse(is_green, hn::Sub(blue, red), hn::Sub(red, green))));
  Vector label = Choose(classes.label[0], is_red, is_green);
  Vector min_saturation = Choose(classes.min_saturation[0], is_red, is_green);
  for (std::size_t i = 0; i < ColorClasses::kMaxBounds; ++i) {
    const Mask is_before = hn::Lt(hue, hn::Mul(range, Choose(classes.bound[i], is_red, is_green)));
    label = hn::IfThenElse(is_before, label, Choose(classes.label[i + 1], is_red, is_green));
    min_saturation =
        hn::IfThenElse(is_before, min_saturation, Choose(classes.min_saturation[i + 1], is_red, is_green));
  }
  const Mask is_grey = hn::Eq(range, hn::Zero(d));
  const Mask is_pale = hn::Lt(hn::ShiftLeft<7>(range), hn::Mul(min_saturation, value));
  const Mask is_dark = hn::Lt(value, hn::Set(d, classes.min_value));
  return hn::IfThenZeroElse(hn::Or(is_grey, hn::Or(is_pale, is_dark)), label);
}

HWY_INLINE void ClassifyVector(const ColorClasses& classes, const std::uint8_t* bgr, std::uint8_t* labels) {
  const Levels d;
  const Bytes bytes;
  hn::Vec<Bytes> blue, green, red;
  hn::LoadInterleaved3(bytes, bgr, blue, green, red);
  const Vector label =
      ClassOf(classes, hn::PromoteTo(d, blue), hn::PromoteTo(d, green), hn::PromoteTo(d, red));
  hn::StoreU(hn::DemoteTo(bytes, label), bytes, labels);
}

void Classify(const std::uint8_t* bgr, std::size_t count, const ColorClasses& classes, std::uint8_t* labels) {
  const std::size_t lanes = hn::Lanes(Levels());
  std::size_t at = 0;
  for (; at + lanes <= count; at += lanes) ClassifyVector(classes, bgr + 3 * at, labels + at);
  if (at == count) return;
  std::uint8_t rest[3 * hn::MaxLanes(Levels())] = {};
  std::uint8_t rest_labels[hn::MaxLanes(Levels())];
  std::memcpy(rest, bgr + 3 * at, 3 * (count - at));
  ClassifyVector(classes, rest, rest_labels);
  std::memcpy(labels + at, rest_labels, count - at);
}

}  // namespace HWY_NAMESPACE
}  // namespace soffit
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>
#include <cmath>

#include "shared/result/result.h"

namespace soffit {
HWY_EXPORT(Classify);
namespace {

struct HueRange {
  const char* color;
  int from_deg;  ///< Each ends where the next begins, the last one where the first begins.
};

/// Every hue belongs to one colour. Ochre ground lies in `yellow` and sky in `blue`: saturation tells them
/// apart.
constexpr std::array<HueRange, 7> kHueRanges = {{{"red", -20},
                                                 {"orange", 18},
                                                 {"yellow", 36},
                                                 {"green", 66},
                                                 {"cyan", 160},
                                                 {"blue", 204},
                                                 {"magenta", 262}}};

/// The last range that begins at a hue of -60 to 300 degrees or before it.
std::size_t FindRange(int hue_deg) {
  std::size_t at = kHueRanges.size() - 1;
  while (at > 0 && kHueRanges[at].from_deg > hue_deg) --at;
  return hue_deg < kHueRanges.front().from_deg ? kHueRanges.size() - 1 : at;
}

}  // namespace

ColorClasses MakeColorClasses(const std::vector<std::string>& colors, double min_value,
                              const std::vector<double>& min_saturations) {
  SOFFIT_EXPECT(colors.size() == min_saturations.size());
  std::array<std::int16_t, kHueRanges.size()> labels{};
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const auto range = std::find_if(kHueRanges.begin(), kHueRanges.end(),
                                    [&](const HueRange& known) { return colors[i] == known.color; });
    SOFFIT_EXPECT(range != kHueRanges.end());
    labels[static_cast<std::size_t>(range - kHueRanges.begin())] = static_cast<std::int16_t>(i + 1);
  }
  ColorClasses classes;
  classes.min_value = static_cast<std::int16_t>(std::lround(255.0 * min_value));
  for (std::size_t channel = 0; channel < 3; ++channel) {
    const int middle_deg = 120 * static_cast<int>(channel);
    std::size_t step = 0;
    const auto enter = [&](std::size_t range) {
      const std::int16_t label = labels[range];
      classes.label[step][channel] = label;
      classes.min_saturation[step][channel] =
          label == 0 ? std::int16_t{0}
                     : static_cast<std::int16_t>(std::lround(
                           kSaturationSteps * min_saturations[static_cast<std::size_t>(label) - 1]));
    };
    enter(FindRange(middle_deg - 60));
    for (std::size_t range = 0; range < kHueRanges.size(); ++range) {
      const int offset_deg = kHueRanges[range].from_deg - middle_deg;
      if (offset_deg <= -60 || offset_deg >= 60) continue;
      SOFFIT_EXPECT(step < ColorClasses::kMaxBounds);
      classes.bound[step][channel] = static_cast<std::int16_t>(std::lround(offset_deg * 128.0 / 60.0));
      ++step;
      enter(range);
    }
    for (; step < ColorClasses::kMaxBounds; ++step) {  // What is left bounds nothing.
      classes.bound[step][channel] = 128;
      classes.label[step + 1][channel] = classes.label[step][channel];
      classes.min_saturation[step + 1][channel] = classes.min_saturation[step][channel];
    }
  }
  return classes;
}

void ClassifyPixels(const std::uint8_t* bgr, std::size_t count, const ColorClasses& classes,
                    std::uint8_t* labels) {
  HWY_DYNAMIC_DISPATCH(Classify)(bgr, count, classes, labels);
}

}  // namespace soffit
#endif
