#include "test/sim/world/geos.h"

#include <geos_c.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>

namespace soffit::sim {
namespace {

constexpr double kGrid_m = 1e-6;

class Geos {
 public:
  Geos() : handle_(GEOS_init_r()) {}
  ~Geos() { GEOS_finish_r(handle_); }
  Geos(const Geos&) = delete;
  Geos& operator=(const Geos&) = delete;

  GEOSContextHandle_t get() const { return handle_; }

  struct Free {
    GEOSContextHandle_t handle;
    void operator()(GEOSGeometry* geometry) const { GEOSGeom_destroy_r(handle, geometry); }
  };
  using Geometry = std::unique_ptr<GEOSGeometry, Free>;
  Geometry Own(GEOSGeometry* geometry, const char* what) const {
    if (geometry == nullptr) throw std::runtime_error(std::string("GEOS: ") + what + " failed");
    return Geometry(geometry, Free{handle_});
  }

  GEOSGeometry* MakeRing(const Ring& ring) const {
    GEOSCoordSequence* corners = GEOSCoordSeq_create_r(handle_, static_cast<unsigned>(ring.size()) + 1, 2);
    for (std::size_t i = 0; i <= ring.size(); ++i) {
      const Eigen::Vector2d& corner = ring[i % ring.size()];
      GEOSCoordSeq_setXY_r(handle_, corners, static_cast<unsigned>(i), corner.x(), corner.y());
    }
    return GEOSGeom_createLinearRing_r(handle_, corners);
  }

  Geometry MakePolygon(const Polygon& polygon) const {
    std::vector<GEOSGeometry*> holes;
    for (const Ring& hole : polygon.holes) holes.push_back(MakeRing(hole));
    return Own(GEOSGeom_createPolygon_r(handle_, MakeRing(polygon.outer), holes.data(),
                                        static_cast<unsigned>(holes.size())),
               "making a polygon");
  }

  Ring ReadRing(const GEOSGeometry* ring) const {
    const GEOSCoordSequence* corners = GEOSGeom_getCoordSeq_r(handle_, ring);
    unsigned size = 0;
    GEOSCoordSeq_getSize_r(handle_, corners, &size);
    Ring result;
    for (unsigned i = 0; i + 1 < size; ++i) {
      Eigen::Vector2d corner;
      GEOSCoordSeq_getXY_r(handle_, corners, i, &corner.x(), &corner.y());
      result.push_back(corner);
    }
    return result;
  }

 private:
  GEOSContextHandle_t handle_;
};

Ring WithoutCollinear(Ring ring) {
  for (std::size_t i = 0; i < ring.size() && ring.size() > 2;) {
    const std::size_t n = ring.size();
    if (DistanceToSegment(ring[i], ring[(i + n - 1) % n], ring[(i + 1) % n]) > 10.0 * kGrid_m) {
      ++i;
    } else {
      ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(i));
      i = i == 0 ? 0 : i - 1;  // The corner before may be collinear now.
    }
  }
  return ring;
}

Ring Oriented(Ring ring, bool counter_clockwise) {
  if ((SignedArea(ring) > 0.0) != counter_clockwise) std::reverse(ring.begin(), ring.end());
  return ring;
}

/// Adds the polygons of any geometry; lines and points in it are left out.
void AddPolygons(const Geos& geos, const GEOSGeometry* geometry, std::vector<Polygon>& polygons) {
  const int type = GEOSGeomTypeId_r(geos.get(), geometry);
  if (type == GEOS_POLYGON && GEOSisEmpty_r(geos.get(), geometry) == 0) {
    Polygon polygon{Oriented(geos.ReadRing(GEOSGetExteriorRing_r(geos.get(), geometry)), true), {}};
    for (int h = 0; h < GEOSGetNumInteriorRings_r(geos.get(), geometry); ++h) {
      polygon.holes.push_back(
          Oriented(geos.ReadRing(GEOSGetInteriorRingN_r(geos.get(), geometry, h)), false));
    }
    polygons.push_back(polygon);
  } else if (type == GEOS_MULTIPOLYGON || type == GEOS_GEOMETRYCOLLECTION) {
    for (int i = 0; i < GEOSGetNumGeometries_r(geos.get(), geometry); ++i)
      AddPolygons(geos, GEOSGetGeometryN_r(geos.get(), geometry, i), polygons);
  }
}

}  // namespace

std::vector<std::array<Eigen::Vector2d, 3>> Triangulate(const Polygon& polygon) {
  const Geos geos;
  const auto shape = geos.MakePolygon(polygon);
  if (GEOSisValid_r(geos.get(), shape.get()) != 1) throw std::runtime_error("the polygon is not valid");
  const auto tiles =
      geos.Own(GEOSConstrainedDelaunayTriangulation_r(geos.get(), shape.get()), "triangulation");
  std::vector<std::array<Eigen::Vector2d, 3>> triangles;
  for (int i = 0; i < GEOSGetNumGeometries_r(geos.get(), tiles.get()); ++i) {
    const GEOSGeometry* tile = GEOSGetGeometryN_r(geos.get(), tiles.get(), i);
    const Ring ring = Oriented(geos.ReadRing(GEOSGetExteriorRing_r(geos.get(), tile)), true);
    triangles.push_back({ring.at(0), ring.at(1), ring.at(2)});
  }
  return triangles;
}

std::vector<Polygon> MakeValid(const Polygon& polygon) {
  const Geos geos;
  const auto shape = geos.MakePolygon(polygon);
  if (GEOSisValid_r(geos.get(), shape.get()) == 1) return {polygon};
  const auto valid = geos.Own(GEOSMakeValid_r(geos.get(), shape.get()), "making valid");
  std::vector<Polygon> polygons;
  AddPolygons(geos, valid.get(), polygons);
  return polygons;
}

std::vector<Polygon> Union(const std::vector<std::array<Eigen::Vector2d, 3>>& triangles) {
  const Geos geos;
  std::vector<GEOSGeometry*> tiles;
  for (const auto& triangle : triangles) {
    const Ring ring(triangle.begin(), triangle.end());
    if (std::abs(SignedArea(ring)) > 1e-9) tiles.push_back(geos.MakePolygon({ring, {}}).release());
  }
  const auto all = geos.Own(GEOSGeom_createCollection_r(geos.get(), GEOS_MULTIPOLYGON, tiles.data(),
                                                        static_cast<unsigned>(tiles.size())),
                            "collecting");
  const auto merged = geos.Own(GEOSUnaryUnionPrec_r(geos.get(), all.get(), kGrid_m), "union");
  std::vector<Polygon> polygons;
  AddPolygons(geos, merged.get(), polygons);
  for (Polygon& polygon : polygons) {
    polygon.outer = WithoutCollinear(polygon.outer);
    for (Ring& hole : polygon.holes) hole = WithoutCollinear(hole);
    std::erase_if(polygon.holes, [](const Ring& hole) { return hole.size() < 3; });
  }
  std::erase_if(polygons, [](const Polygon& polygon) { return polygon.outer.size() < 3; });
  std::stable_sort(polygons.begin(), polygons.end(),
                   [](const Polygon& a, const Polygon& b) { return Area(a) > Area(b); });
  return polygons;
}

}  // namespace soffit::sim
