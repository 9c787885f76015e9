#pragma once

#include <array>
#include <vector>

#include "shared/geometry/polygon.h"

namespace soffit {

/// The outline of any shape, curved ones too, as a cyclic word of steps of equal length. The letter of a step
/// tells how the rest of the outline lies as seen from there: mean heights over its tangent of as many
/// stretches, near ones with more weight (J. Wang, X. Bai, X. You, W. Liu and L. J. Latecki, "Shape matching
/// and classification using height functions", Pattern Recognition Letters 33(2), 2012). Invariant to
/// position and scale; another starting point turns the word round.
struct OutlineWord {
  static constexpr int kSteps = 97;
  static constexpr int kStretches = 16;

  std::array<std::array<float, kSteps>, kStretches> letters{};
  double complexity = 0.0;         ///< How much the letters differ from each other.
  std::vector<double> hole_areas;  ///< Over that of the outer ring, greatest first.
};

/// ContractViolation when the outer ring has fewer than three corners or no area. Pure.
OutlineWord SpellOutline(const Polygon& polygon);

/// The word of the mirror image.
OutlineWord Mirror(const OutlineWord& word);

/// How different two shapes are, >= 0, about 0 for similar ones: cyclic edit distance of their words, in
/// which a step may also stand for several or be missing, over their complexity; and the difference of their
/// holes. From any of the steps as start, steps are aligned that lie no farther than a sixth of the outline
/// from where they would be without edits. Pure; O(kSteps^3), some 50 us.
double WordDistance(const OutlineWord& a, const OutlineWord& b);

}  // namespace soffit
