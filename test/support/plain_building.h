#pragma once

#include "service/footprint/footprint.h"

namespace soffit::test {

inline const Ring kBlock = {{0, 0}, {4, 0}, {4, 1.5}, {0, 1.5}};

/// A prism, 2 m high.
inline Footprint Building(const Ring& ring) {
  Footprint footprint;
  footprint.object_id = 1;
  footprint.polygon_in_map_m.outer = ring;
  footprint.height_m = 2.0;
  return footprint;
}

}  // namespace soffit::test
