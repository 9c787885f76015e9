#include "service/scene/evidence.h"

#include <gtest/gtest.h>

#include <random>

#include "service/scene/ground_check.h"
#include "test/support/painted_world.h"

namespace soffit {
namespace {

using Sees = Evidence::Sees;

/// A picture of an arch with a pole before it; ground is unconfirmed west of the middle.
Evidence Gather() {
  const test::Thing pole = test::Block(test::Box(-0.05, -1.3, 0.05, -1.2), 0.0, 2.5, {30, 60, 30});
  const test::Thing arch = test::Arch{}.thing();
  const Sight sight = test::Look({test::FromSouth()}, {arch, pole}).sights.front();
  const Prediction prediction = Predict(sight.view, {&arch.mesh});
  cv::Mat1b votes(sight.seen.size(), static_cast<uchar>(GroundVote::kConfirmed));
  votes.colRange(0, votes.cols / 2).setTo(static_cast<uchar>(GroundVote::kNone));
  const cv::Mat1b lines(sight.seen.size(), uchar{0});
  return {sight, prediction, votes, lines,
          Eigen::AlignedBox2d(Eigen::Vector2d(-5, -5), Eigen::Vector2d(5, 5))};
}

TEST(Evidence, WhatItSeesAlikeHoldsForEveryBallWithin) {
  const Evidence picture = Gather();
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto within = [&] {
    Eigen::Vector3d p(unit(random), unit(random), unit(random));
    while (p.norm() > 1.0) p = {unit(random), unit(random), unit(random)};
    return p;
  };
  std::array<int, 4> met{};
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d center(5.0 * unit(random), 5.0 * unit(random), 2.5 + 2.5 * unit(random));
    const double radius_m = 0.5 + 0.45 * unit(random);
    const std::optional<Sees> alike = picture.SeesAlike(center, radius_m);
    if (!alike) continue;
    ++met[static_cast<std::size_t>(*alike)];
    for (int k = 0; k < 8; ++k) {
      const double small_m = radius_m * (0.5 + 0.49 * unit(random));
      const Eigen::Vector3d place = center + (radius_m - small_m) * within();
      ASSERT_EQ(picture.SeeThrough(place, small_m), *alike);
      if (*alike != Sees::kNothing) continue;
      ASSERT_FALSE(picture.SeesPartly(place, small_m));
      ASSERT_FALSE(picture.ShowsThingAt(place));
    }
  }
  EXPECT_GT(met[static_cast<std::size_t>(Sees::kNothing)], 100);
  EXPECT_GT(met[static_cast<std::size_t>(Sees::kSure)], 100);
  EXPECT_GT(met[static_cast<std::size_t>(Sees::kLikely)], 50);
}

TEST(Evidence, TellsNothingAlikeWhereAThingMayStand) {
  EXPECT_NE(Gather().SeesAlike({0.0, -1.25, 1.0}, 0.3), Sees::kNothing);
}

TEST(Evidence, SeesNothingBehindTheCamera) {
  EXPECT_EQ(
      Gather().SeesAlike(test::FromSouth().map_from_camera.translation_m - Eigen::Vector3d(0, 3, 0), 1.0),
      Sees::kNothing);
}

}  // namespace
}  // namespace soffit
