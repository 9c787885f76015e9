#include "service/mask/classify.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "shared/result/result.h"
#include "test/support/instruction_sets.h"

namespace soffit {
namespace {

using Labels = std::vector<std::uint8_t>;

const std::vector<std::string> kColors = {"red", "orange", "yellow", "green", "cyan", "blue", "magenta"};

Labels Classify(const std::vector<cv::Vec3b>& pixels, const ColorClasses& classes) {
  Labels labels(pixels.size() + 1, 77);
  ClassifyPixels(pixels.data()->val, pixels.size(), classes, labels.data());
  EXPECT_EQ(labels.back(), 77);  // Nothing is written behind the row.
  labels.pop_back();
  return labels;
}

/// Hue in degrees, 0 to 360; saturation and value 0 to 1.
cv::Vec3b FromHsv(double hue_deg, double saturation, double value) {
  const auto channel = [&](double at) {
    const double k = std::fmod(at + hue_deg / 60.0, 6.0);
    return cv::saturate_cast<std::uint8_t>(255.0 * value *
                                           (1.0 - saturation * std::clamp(std::min(k, 4.0 - k), 0.0, 1.0)));
  };
  return {channel(1.0), channel(3.0), channel(5.0)};
}

class ClassifyPixelsWith : public test::WithInstructionSet {};
INSTANTIATE_TEST_SUITE_P(InstructionSets, ClassifyPixelsWith, test::AllInstructionSets(), test::NameOfSet);

TEST_P(ClassifyPixelsWith, PartsTheHuesAllAroundTheCircle) {
  const ColorClasses classes = MakeColorClasses(kColors, 0.1, std::vector<double>(7, 0.4));
  const int first_deg[] = {-20, 18, 36, 66, 160, 204, 262, 340};
  for (std::size_t color = 0; color < kColors.size(); ++color) {
    std::vector<cv::Vec3b> pixels;
    for (int hue_deg = first_deg[color] + 1; hue_deg < first_deg[color + 1] - 1; ++hue_deg) {
      pixels.push_back(FromHsv((hue_deg + 360) % 360, 0.9, 0.8));
    }
    EXPECT_EQ(Classify(pixels, classes), Labels(pixels.size(), static_cast<std::uint8_t>(color + 1)))
        << kColors[color];
  }
}

TEST_P(ClassifyPixelsWith, TakesPaleDarkAndGreyForNoClass) {
  const ColorClasses classes = MakeColorClasses({"blue", "red"}, 0.2, {0.6, 0.3});
  const std::vector<cv::Vec3b> pixels = {
      FromHsv(230, 0.65, 0.5), FromHsv(230, 0.55, 0.5), FromHsv(0, 0.35, 0.5),
      FromHsv(0, 0.25, 0.5),   FromHsv(0, 0.9, 0.25),   FromHsv(0, 0.9, 0.15),
      FromHsv(120, 1.0, 1.0),  {200, 200, 200},         {0, 0, 0}};
  EXPECT_EQ(Classify(pixels, classes), (Labels{1, 0, 2, 0, 2, 0, 0, 0, 0}));
}

TEST_P(ClassifyPixelsWith, GivesGreyNoClassHoweverPaleItsClassesAre) {
  const ColorClasses classes = MakeColorClasses(kColors, 0.0, std::vector<double>(7, 0.0));
  EXPECT_EQ(Classify({{0, 0, 0}, {9, 9, 9}, {255, 255, 255}, {9, 9, 10}}, classes), (Labels{0, 0, 0, 1}));
}

TEST_P(ClassifyPixelsWith, GivesEveryPixelTheSameLabelWhereverItLies) {
  const ColorClasses classes = MakeColorClasses({"red", "blue", "yellow"}, 0.1, {0.45, 0.3, 0.6});
  std::vector<cv::Vec3b> pixels(200);
  cv::RNG random(3);
  for (cv::Vec3b& pixel : pixels) {
    for (int i = 0; i < 3; ++i) pixel[i] = static_cast<std::uint8_t>(random.uniform(0, 256));
  }
  Labels alone;
  for (const cv::Vec3b& pixel : pixels) alone.push_back(Classify({pixel}, classes)[0]);
  for (std::size_t count = 1; count < pixels.size(); ++count) {
    const std::vector<cv::Vec3b> some(pixels.begin(), pixels.begin() + static_cast<std::ptrdiff_t>(count));
    EXPECT_EQ(Classify(some, classes),
              Labels(alone.begin(), alone.begin() + static_cast<std::ptrdiff_t>(count)));
  }
}

TEST(MakeColorClasses, RefusesColoursThatItDoesNotKnow) {
  EXPECT_THROW(MakeColorClasses({"mauve"}, 0.1, {0.4}), ContractViolation);
  EXPECT_THROW(MakeColorClasses({"red"}, 0.1, {}), ContractViolation);
}

}  // namespace
}  // namespace soffit
