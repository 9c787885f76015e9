#include "shared/geometry/heights.h"

#include <algorithm>

namespace soffit {

void Span::Include(double value) {
  low = std::min(low, value);
  high = std::max(high, value);
}

Span HeightsAt(const Ring& ring, double u) {
  Span heights;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d& a = ring[i];
    const Eigen::Vector2d& b = ring[(i + 1) % ring.size()];
    if ((a.x() < u && b.x() < u) || (a.x() > u && b.x() > u)) continue;
    if (a.x() == b.x()) {
      heights.Include(a.y());
      heights.Include(b.y());
    } else {
      heights.Include(a.y() + (u - a.x()) / (b.x() - a.x()) * (b.y() - a.y()));
    }
  }
  return heights;
}

}  // namespace soffit
