#include "service/match/outline_word.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "service/match/similarity.h"
#include "shared/result/result.h"

namespace soffit {
namespace {

using std::numbers::pi;

constexpr double kAlike = 0.06;  ///< No two words of a shape differ by more.

const Ring kL = {{0, 0}, {40, 0}, {40, 15}, {15, 15}, {15, 30}, {0, 30}};
const Ring kT = {{0, 0}, {40, 0}, {40, 12}, {27, 12}, {27, 35}, {13, 35}, {13, 12}, {0, 12}};
const Ring kSquare = {{0, 0}, {20, 0}, {20, 20}, {0, 20}};

/// A blob with `arms`, each bent sideways by its share of `bend`.
Ring Starfish(int arms, double bend) {
  Ring ring;
  for (int i = 0; i < 400; ++i) {
    const double angle = 2.0 * pi * i / 400;
    const double radius = 10.0 + 4.0 * std::cos(arms * angle) + 2.0 * std::cos(angle + 1.0);
    const double turned = angle + bend * std::sin(angle) * (radius - 4.0) / 12.0;
    ring.emplace_back(radius * std::cos(turned), radius * std::sin(turned));
  }
  return ring;
}

Ring Mirrored(Ring ring) {
  for (Eigen::Vector2d& p : ring) p.x() = -p.x();
  return {ring.rbegin(), ring.rend()};
}

double Distance(const Polygon& a, const Polygon& b) { return WordDistance(SpellOutline(a), SpellOutline(b)); }
double Distance(const Ring& a, const Ring& b) { return Distance(Polygon{a, {}}, Polygon{b, {}}); }

TEST(WordDistance, IsZeroForTheSame) { EXPECT_EQ(Distance(kT, kT), 0.0); }

TEST(WordDistance, IsAboutZeroForSimilarShapesWhereverTheyStart) {
  for (const Ring& ring : {kL, kT, Starfish(5, 0.0)}) {
    for (std::size_t start = 0; start < ring.size(); start += 1 + ring.size() / 6) {
      Ring shifted = ring;
      std::rotate(shifted.begin(), shifted.begin() + static_cast<std::ptrdiff_t>(start), shifted.end());
      const Similarity turn{3.0 * std::cos(0.1 + static_cast<double>(start)),
                            3.0 * std::sin(0.1 + static_cast<double>(start)),
                            {691000.0, 5335000.0}};
      EXPECT_LT(Distance({ring, {}}, turn * Polygon{shifted, {}}), kAlike);
    }
  }
}

TEST(WordDistance, OrdersTwinsBeforeStrangers) {
  Ring twin = kL;
  twin[4].y() = twin[5].y() = 36;
  EXPECT_GT(Distance(kL, twin), 0.01);
  EXPECT_LT(Distance(kL, twin), Distance(kL, kT));
}

TEST(WordDistance, ForgivesWhatBends) {
  const double bent = Distance(Starfish(5, 0.0), Starfish(5, 0.08));
  EXPECT_LT(bent, 0.6 * Distance(Starfish(5, 0.0), Starfish(4, 0.0)));
  EXPECT_LT(bent, 0.6 * Distance(Starfish(5, 0.0), Starfish(6, 0.0)));
}

TEST(WordDistance, IsTheSameBothWaysRound) {
  EXPECT_NEAR(Distance(kL, kT), Distance(kT, kL), 0.02);
  EXPECT_NEAR(Distance(Starfish(3, 0.2), kL), Distance(kL, Starfish(3, 0.2)), 0.02);
}

TEST(WordDistance, CountsHoles) {
  const Polygon court{kSquare, {{{6, 6}, {6, 14}, {14, 14}, {14, 6}}}};
  const Polygon smaller{kSquare, {{{6, 6}, {6, 13}, {14, 13}, {14, 6}}}};
  EXPECT_GT(Distance({kSquare, {}}, court), 0.1);
  EXPECT_LT(Distance(court, smaller), Distance({kSquare, {}}, court));
  EXPECT_EQ(Distance(court, court), 0.0);
}

TEST(Mirror, GivesTheWordOfTheMirrorImage) {
  const OutlineWord mirrored = Mirror(SpellOutline({kL, {}}));
  EXPECT_LT(WordDistance(mirrored, SpellOutline({Mirrored(kL), {}})), kAlike);
  EXPECT_GT(WordDistance(mirrored, SpellOutline({kL, {}})), 2.0 * kAlike);
  EXPECT_EQ(Mirror(mirrored).letters, SpellOutline({kL, {}}).letters);
}

TEST(SpellOutline, RefusesDegenerateRings) {
  EXPECT_THROW(SpellOutline({}), ContractViolation);
  EXPECT_THROW(SpellOutline({{{0, 0}, {1, 0}}, {}}), ContractViolation);
  EXPECT_THROW(SpellOutline({{{0, 0}, {1, 0}, {2, 0}}, {}}), ContractViolation);
}

}  // namespace
}  // namespace soffit
