#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace soffit {

constexpr int kSaturationSteps = 128;  ///< Of a fully saturated colour.

/// Which colours belong to which class. Hues are looked up by the channel that is greatest (red, green, blue)
/// and how far the other two differ; there, each class ends where the next begins.
struct ColorClasses {
  static constexpr std::size_t kMaxBounds = 3;
  using ByChannel = std::array<std::int16_t, 3>;

  std::int16_t min_value = 0;                     ///< 0 to 255: darker pixels have no class.
  std::array<ByChannel, kMaxBounds> bound{};      ///< Hues from there on; 128 is a sixth of the circle.
  std::array<ByChannel, kMaxBounds + 1> label{};  ///< 0: no class.
  std::array<ByChannel, kMaxBounds + 1> min_saturation{};  ///< Of kSaturationSteps.
};

/// @param colors  Names: red orange yellow green cyan blue magenta. Colour i has label i + 1.
/// @param min_value  0 to 1.
/// @param min_saturations  0 to 1, for each colour.
/// Throws ContractViolation when a colour is unknown.
ColorClasses MakeColorClasses(const std::vector<std::string>& colors, double min_value,
                              const std::vector<double>& min_saturations);

/// Labels of a row of pixels (three bytes each: blue, green, red). Grey has no hue, so it has no class. Many
/// pixels at a time, with the best instructions of the processor; the same labels with any. Pure.
void ClassifyPixels(const std::uint8_t* bgr, std::size_t count, const ColorClasses& classes,
                    std::uint8_t* labels);

}  // namespace soffit
