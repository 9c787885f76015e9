#include "service/match/word.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "service/outline/ring_fit.h"
#include "shared/result/result.h"

namespace soffit {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

constexpr double kTurnPrice = 0.08;    ///< Of half a turn, in perimeters.
constexpr double kMissingPrice = 1.0;  ///< Per length of a missing side.
constexpr double kMergePrice = 0.01;
constexpr std::size_t kMaxMerged = 3;
constexpr std::size_t kMaxSides = 64;  ///< Longer words are not compared side by side.

double WrapAngle(double angle) { return angle - 2.0 * pi * std::nearbyint(angle / (2.0 * pi)); }

/// `count` sides from `at` on, taken for one.
Primitive Merge(const Word& word, std::size_t at, std::size_t count) {
  Primitive merged;
  Vector2d chord = Vector2d::Zero();
  for (std::size_t k = 0; k < count; ++k) {
    const Primitive& side = word[(at + k) % word.size()];
    chord += side.length * Vector2d(std::cos(side.heading_rad), std::sin(side.heading_rad));
  }
  merged.length = chord.norm();
  merged.heading_rad = std::atan2(chord.y(), chord.x());
  const Primitive& next = word[(at + count) % word.size()];
  merged.turn_rad = WrapAngle(next.heading_rad - merged.heading_rad);
  return merged;
}

double BendOf(const Word& word, std::size_t at, std::size_t count) {
  double bend = 0.0;
  for (std::size_t k = 0; k + 1 < count; ++k) bend += std::abs(word[(at + k) % word.size()].turn_rad);
  return bend;
}

double PriceOf(const Primitive& a, const Primitive& b) {
  return std::abs(a.length - b.length) + kTurnPrice * std::abs(WrapAngle(a.turn_rad - b.turn_rad)) / pi;
}

struct MergedSide {
  Primitive side;
  Vector2d direction = Vector2d::Zero();  ///< Unit.
};

/// Merged sides of a word, made once: [count - 1][at].
using Merged = std::array<std::vector<MergedSide>, kMaxMerged>;

Merged MergeAll(const Word& word) {
  Merged merged;
  for (std::size_t count = 1; count <= kMaxMerged; ++count) {
    for (std::size_t at = 0; at < word.size(); ++at) {
      const Primitive side = Merge(word, at, count);
      merged[count - 1].push_back({side, {std::cos(side.heading_rad), std::sin(side.heading_rad)}});
    }
  }
  return merged;
}

struct Cell {
  double cost = std::numeric_limits<double>::infinity();
  double sine = 0.0;  ///< Of heading differences, weighted by length.
  double cosine = 0.0;
};

WordAlignment AlignFrom(const Word& a, const Merged& merged_a, const Word& b, const Merged& merged_b,
                        std::size_t start, std::vector<Cell>& cells) {
  const std::size_t n = a.size();
  const std::size_t m = b.size();
  SOFFIT_EXPECT(start < m);
  cells.assign((n + 1) * (m + 1), Cell{});
  const auto cell = [&](std::size_t i, std::size_t j) -> Cell& { return cells[i * (m + 1) + j]; };
  cell(0, 0).cost = 0.0;
  for (std::size_t i = 0; i <= n; ++i) {
    for (std::size_t j = 0; j <= m; ++j) {
      const Cell from = cell(i, j);
      if (!std::isfinite(from.cost)) continue;
      const std::size_t at_b = (start + j) % m;
      const auto relax = [](Cell& to, double cost, double sine, double cosine) {
        if (cost < to.cost) to = {cost, sine, cosine};
      };
      if (i < n) relax(cell(i + 1, j), from.cost + kMissingPrice * a[i].length, from.sine, from.cosine);
      if (j < m) relax(cell(i, j + 1), from.cost + kMissingPrice * b[at_b].length, from.sine, from.cosine);
      for (std::size_t p = 1; p <= kMaxMerged && i + p <= n; ++p) {
        for (std::size_t q = 1; q <= kMaxMerged && j + q <= m; ++q) {
          if (p > 1 && q > 1) continue;
          const auto& [side_a, direction_a] = merged_a[p - 1][i];
          const auto& [side_b, direction_b] = merged_b[q - 1][at_b];
          const double merging =
              p + q == 2 ? 0.0 : kMergePrice + kTurnPrice * 0.5 * (BendOf(a, i, p) + BendOf(b, at_b, q)) / pi;
          const double cost = from.cost + PriceOf(side_a, side_b) + merging;
          Cell& to = cell(i + p, j + q);
          if (cost >= to.cost) continue;
          const double weight = std::min(side_a.length, side_b.length);
          const double sine = direction_a.x() * direction_b.y() - direction_a.y() * direction_b.x();
          to = {cost, from.sine + weight * sine, from.cosine + weight * direction_a.dot(direction_b)};
        }
      }
    }
  }
  const Cell& end = cell(n, m);
  return {end.cost, std::atan2(end.sine, end.cosine)};
}

}  // namespace

Word Spell(const Ring& ring, double tolerance) {
  Ring sides = ring;
  if (const FittedRing fitted = FitRing(ring, 0.5 * tolerance, tolerance); !fitted.ring.empty())
    sides = fitted.ring;
  Word word;
  const double perimeter = Perimeter(sides);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const Vector2d side = sides[(i + 1) % sides.size()] - sides[i];
    word.push_back({side.norm() / perimeter, 0.0, std::atan2(side.y(), side.x())});
  }
  for (std::size_t i = 0; i < word.size(); ++i) {
    word[i].turn_rad = WrapAngle(word[(i + 1) % word.size()].heading_rad - word[i].heading_rad);
  }
  return word;
}

std::vector<WordAlignment> AlignWords(const Word& a, const Word& b) {
  if (a.empty() || b.empty() || a.size() > kMaxSides || b.size() > kMaxSides) return {};
  const Merged merged_a = MergeAll(a);
  const Merged merged_b = MergeAll(b);
  std::vector<Cell> cells;
  std::vector<WordAlignment> alignments;
  for (std::size_t start = 0; start < b.size(); ++start) {
    alignments.push_back(AlignFrom(a, merged_a, b, merged_b, start, cells));
  }
  std::stable_sort(alignments.begin(), alignments.end(),
                   [](const WordAlignment& x, const WordAlignment& y) { return x.cost < y.cost; });
  return alignments;
}

}  // namespace soffit
