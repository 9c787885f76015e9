#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "service/solid/solid.h"

namespace soffit {

/// One opening of one wall.
struct Mouth {
  std::size_t facade = 0;  ///< Index.
  std::size_t opening = 0;
  auto operator<=>(const Mouth&) const = default;
};

/// A way through a building. `sections` are two at least, with as many corners each; between two of them it
/// is spanned by straight lines from corner to corner. It bends at those between the first and the last.
struct Tunnel {
  Mouth entry;
  std::optional<Mouth> exit;  ///< None: it is supposed, for its wall was not seen.
  int exit_wall = -1;
  std::vector<Section> sections_in_map_m;
};

/// Which openings are the two ends of one passage, and how that runs: straight, slanted to its walls, wider
/// at one end, or with one bend on either side. Where the pictures show the feet of the jambs, the passage
/// runs along them, and bends where those of its two ends meet. Each opening is used once; those that fit
/// best are joined first.
///
/// Two openings that lie opposite each other are joined when both show something beyond, others when that
/// proves that both lead through. When two that hang above the ground, or whose jambs do not lead to each
/// other, differ in size, something beyond one of them that looks like the building hides a part of it, and
/// the larger one is the passage's. An opening that is left, and shows something beyond, leads along its
/// jambs to the wall opposite when that was not seen.
std::vector<Tunnel> FindTunnels(const Polygon& footprint, const std::vector<Facade>& facades);

}  // namespace soffit
