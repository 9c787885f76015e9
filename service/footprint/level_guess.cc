#include "service/footprint/level_guess.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace soffit {
namespace {

using Eigen::Vector2d;

constexpr double kTopShare = 0.97;         // Of the height: above, rounding of corners tells nothing.
constexpr int kStations = 48;              // Heights at which profiles are compared.
constexpr double kLeastInsetShare = 0.04;  // Of the height; less is an upright wall.
constexpr double kSigmas = 3.0;
constexpr double kSameHeightShare = 0.04;  // Of the height: breaks that are nearer are one.
constexpr std::size_t kMostBreaks = 6;     // That are tried.
constexpr double kBetterShare = 0.6;       // Of the misfit: what a further break has to bring it to.

Vector2d Outward(const Ring& ring, std::size_t side) {
  const Vector2d along = (ring[(side + 1) % ring.size()] - ring[side]).normalized();
  return {along.y(), -along.x()};
}

double StationHeight(int k, double height_m) {
  return height_m * (kFootShare + (kTopShare - kFootShare) * k / (kStations - 1));
}

/// How far one side of the building stands back at the stations, as the pictures show it on which it is at
/// the end: the least of them. Empty when no picture does.
struct SideProfile {
  std::vector<double> inset_m;
  double least_m = 0.0;  ///< Less is nothing.
};

SideProfile ProfileOf(const Vector2d& outward, const std::vector<Profile>& profiles, double height_m) {
  SideProfile side;
  for (const Profile& profile : profiles) {
    const double facing = outward.dot(profile.right);
    if (std::abs(facing) < kSideCosine) continue;
    const auto end = [&](double z) -> std::optional<double> {
      const auto extent = profile.Extent(z);
      if (!extent) return std::nullopt;
      return facing > 0.0 ? extent->y() : -extent->x();
    };
    const auto base = end(kFootShare * height_m);
    if (!base) continue;
    const double least_m = (kLeastInsetShare + kSigmas * profile.turn_std_rad) * height_m;
    std::vector<double> inset_m;
    for (int k = 0; k < kStations; ++k) {
      const auto here = end(StationHeight(k, height_m));
      inset_m.push_back(here ? std::max(0.0, *base - *here) : (inset_m.empty() ? 0.0 : inset_m.back()));
    }
    if (side.inset_m.empty()) {
      side = {std::move(inset_m), least_m};
      continue;
    }
    side.least_m = std::max(side.least_m, least_m);
    for (std::size_t k = 0; k < inset_m.size(); ++k) side.inset_m[k] = std::min(side.inset_m[k], inset_m[k]);
  }
  return side;
}

/// A profile from one break to the next as a straight line, by least squares.
struct Piece {
  double at_low_m = 0.0;
  double at_high_m = 0.0;
  double misfit_m = 0.0;
};

Piece FitPiece(const std::vector<double>& inset_m, double height_m, double low_m, double high_m) {
  std::vector<Vector2d> points;  // (height, inset)
  for (int k = 0; k < kStations; ++k) {
    const double z = StationHeight(k, height_m);
    if (z >= low_m && z <= high_m) points.emplace_back(z, inset_m[static_cast<std::size_t>(k)]);
  }
  if (points.size() < 2) return {};
  const Vector2d middle =
      std::accumulate(points.begin(), points.end(), Vector2d(0.0, 0.0)) / static_cast<double>(points.size());
  double along = 0.0, across = 0.0;
  for (const Vector2d& p : points) {
    along += (p.x() - middle.x()) * (p.x() - middle.x());
    across += (p.x() - middle.x()) * (p.y() - middle.y());
  }
  const auto at = [&](double z) { return middle.y() + across / along * (z - middle.x()); };
  Piece piece;
  piece.at_low_m = std::max(0.0, at(low_m));
  piece.at_high_m = std::max(piece.at_low_m, at(high_m));
  for (const Vector2d& p : points) piece.misfit_m += std::abs(p.y() - at(p.x()));
  return piece;
}

LevelGuess GuessWith(const std::vector<SideProfile>& sides, double height_m,
                     const std::vector<double>& breaks_m) {
  const std::size_t n = sides.size();
  LevelGuess guess;
  std::vector<double> below_m(n, 0.0);
  double low_m = 0.0;
  const auto add_level = [&](double at_m, const std::vector<double>& wanted_m) {
    Level level{at_m, below_m};
    std::vector<bool> is_free(n, false);
    for (std::size_t i = 0; i < n; ++i) {
      if (sides[i].inset_m.empty() || wanted_m[i] < below_m[i] + sides[i].least_m) continue;
      level.inset_m[i] = wanted_m[i];
      is_free[i] = true;
    }
    below_m = level.inset_m;
    guess.levels.push_back(std::move(level));
    guess.is_free.push_back(std::move(is_free));
  };
  for (std::size_t b = 0; b <= breaks_m.size(); ++b) {
    const double high_m = b < breaks_m.size() ? breaks_m[b] : height_m;
    std::vector<double> at_low_m(n, 0.0), at_high_m(n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
      if (sides[i].inset_m.empty()) continue;
      const Piece piece = FitPiece(sides[i].inset_m, height_m, low_m, high_m);
      at_low_m[i] = piece.at_low_m;
      at_high_m[i] = piece.at_high_m;
      guess.misfit_m += piece.misfit_m;
    }
    if (b > 0) {
      add_level(low_m, at_low_m);
      const std::vector<bool>& steps = guess.is_free.back();
      if (std::count(steps.begin(), steps.end(), true) == 0) {  // No ledge.
        guess.levels.pop_back();
        guess.is_free.pop_back();
      }
    }
    add_level(high_m, at_high_m);
    low_m = high_m;
  }
  return guess;
}

/// Heights at which outlines have corners, without those near the ground and the roof.
std::vector<double> FindBreaks(const std::vector<Profile>& profiles, double height_m) {
  std::vector<double> all;
  for (const Profile& profile : profiles) {
    for (const Vector2d& p : profile.outline) {
      if (p.y() > 1.5 * kFootShare * height_m && p.y() < (1.0 - kSameHeightShare) * height_m)
        all.push_back(p.y());
    }
  }
  std::sort(all.begin(), all.end());
  std::vector<std::vector<double>> clusters;
  for (const double z : all) {
    if (clusters.empty() || z - clusters.back().front() > kSameHeightShare * height_m)
      clusters.emplace_back();
    clusters.back().push_back(z);
  }
  std::stable_sort(clusters.begin(), clusters.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  if (clusters.size() > kMostBreaks) clusters.resize(kMostBreaks);
  std::vector<double> breaks;
  for (const auto& cluster : clusters) breaks.push_back(cluster[cluster.size() / 2]);
  std::sort(breaks.begin(), breaks.end());
  return breaks;
}

}  // namespace

std::vector<LevelGuess> GuessLevels(const Ring& outer, const std::vector<Profile>& profiles,
                                    double height_m) {
  std::vector<SideProfile> sides;
  for (std::size_t i = 0; i < outer.size(); ++i)
    sides.push_back(ProfileOf(Outward(outer, i), profiles, height_m));
  const std::vector<double> breaks = FindBreaks(profiles, height_m);
  std::vector<LevelGuess> guesses = {GuessWith(sides, height_m, {})};
  std::vector<LevelGuess> with_one, with_two;
  for (std::size_t i = 0; i < breaks.size(); ++i) {
    with_one.push_back(GuessWith(sides, height_m, {breaks[i]}));
    for (std::size_t j = i + 1; j < breaks.size(); ++j)
      with_two.push_back(GuessWith(sides, height_m, {breaks[i], breaks[j]}));
  }
  for (const std::vector<LevelGuess>* some : {&with_one, &with_two}) {
    const auto best =
        std::min_element(some->begin(), some->end(),
                         [](const LevelGuess& a, const LevelGuess& b) { return a.misfit_m < b.misfit_m; });
    if (best != some->end() && best->misfit_m < kBetterShare * guesses.back().misfit_m)
      guesses.push_back(*best);
  }
  return guesses;
}

}  // namespace soffit
