#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "service/footprint/level.h"
#include "service/image/image.h"
#include "service/outline/outline.h"
#include "shared/geometry/polygon.h"
#include "shared/options/options.h"

namespace soffit {

/// A building as one picture shows it: roof and visible walls in one outline.
struct Silhouette {
  std::uint32_t capture_id = 0;
  View view;
  Outline outline;
  bool holds_more = false;  ///< Other buildings, too: they look like one there.
};

/// Whether it shows all of the building, and nothing else.
inline bool IsWhole(const Silhouette& s) { return !s.outline.is_cut && !s.holds_more; }

/// One building of the vector map: the vertical projection of everything of it, in metres.
struct Footprint {
  std::uint32_t object_id = 0;  ///< Unique in the vector map; 0: not yet in a map.
  std::string color;
  Polygon polygon_in_map_m;          ///< Valid: outer ring counter-clockwise, holes clockwise, all simple.
  std::vector<double> corner_std_m;  ///< For each corner of the outer ring.
  double height_m = 0.0;      ///< Highest point above the ground; 0: not known, then the polygon is that of
                              ///< the silhouette on the ground, which is too large.
  double height_std_m = 0.0;  ///< 0 when the height is not known.
  /// Empty: plumb walls up to a level roof. Else how it goes up from the ground, where the polygon is; they
  /// rise to `height_m`, and two at one height make a ledge.
  std::vector<Level> levels;
  bool is_cut = false;  ///< Pictures do not show all of it, not even together: its shape is not known.
  std::vector<std::uint32_t> captures;  ///< The pictures that it was seen in.
  std::vector<Silhouette> silhouettes;  ///< How they show it; the polygon is drawn from these.
};

struct FootprintOptions {
  double min_area_m2 = 0.2;
  double max_height_m = 120.0;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("min_area_m2", self.min_area_m2, OptionInfo{0.0, 1e6, "m2", "Smaller shapes are not buildings"});
    field("max_height_m", self.max_height_m,
          OptionInfo{1.0, 1000.0, "m", "No building is taken to be higher"});
  }
};

/// Footprints of the outlines in a picture taken from above. Walls are taken as plumb and the roof as level,
/// so that what leans outward in perspective can be taken off; the height comes from the wall corners that
/// the picture shows. Throws ContractViolation when the camera looks less than 45 degrees down or stands
/// below the ground. Pure.
std::vector<Footprint> TraceFootprints(const Image& image, const std::vector<Outline>& outlines,
                                       const FootprintOptions& options);

/// The vector map of all that several pictures show: the same building is one entry, whole views win over cut
/// ones and steep views over slanted ones, and views from different places give the height (parallax). What
/// every picture cuts is put together from its parts, where these overlap. Ids are numbered from 1 by first
/// sight, and are kept from `map`. Pure.
std::vector<Footprint> MergeFootprints(const std::vector<Footprint>& map, const std::vector<Footprint>& seen);

/// The same building drawn again for a height that is known from elsewhere (wall pictures): scaled about the
/// points beneath the cameras. `height_m` > 0 and below every camera, else ContractViolation. Pure.
Footprint WithHeight(const Footprint& footprint, double height_m, double height_std_m);

}  // namespace soffit
