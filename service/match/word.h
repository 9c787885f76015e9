#pragma once

#include <vector>

#include "shared/geometry/polygon.h"

namespace soffit {

/// One side of an outline and the corner after it.
struct Primitive {
  double length = 0.0;       ///< Over the perimeter.
  double turn_rad = 0.0;     ///< To the next side, counter-clockwise, (-pi, pi].
  double heading_rad = 0.0;  ///< Of the side; not compared.
};

/// A ring as a cyclic word: invariant to position and scale; a rotation only changes the headings.
using Word = std::vector<Primitive>;

/// The word of a counter-clockwise ring, sides shorter than about `tolerance` smoothed away.
Word Spell(const Ring& ring, double tolerance);

/// One way to lay word `b` on word `a`.
struct WordAlignment {
  double cost = 0.0;
  double rotation_ccw_rad =
      0.0;  ///< Turns a's headings into b's: length-weighted mean over the aligned sides.
};

/// The cheapest alignment for each start corner of `b`, cheapest first: cyclic edit distance, in which a side
/// may also stand for two or three (split or merged by noise) or be missing (H. Bunke and U. Buehler,
/// "Applications of approximate string matching to 2D shape recognition", Pattern Recognition 26(12), 1993).
/// O(|b|^2 |a|).
std::vector<WordAlignment> AlignWords(const Word& a, const Word& b);

}  // namespace soffit
