#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "service/edge/files/gis_layers.h"
#include "shared/flight/flight.h"

class GDALDataset;
class OGRLayer;
class OGRSpatialReference;

namespace soffit {

/// In which coordinates the map's points are written.
class GisFrame {
 public:
  /// Metres about the home point: a transverse Mercator projection where that is known, else a local frame.
  static GisFrame InMetres(const std::optional<GeodeticOrigin>& origin);
  /// WGS 84 longitude and latitude, heights above the sea.
  static GisFrame InDegrees(const GeodeticOrigin& origin);

  ~GisFrame();
  GisFrame(GisFrame&&) noexcept;
  GisFrame& operator=(GisFrame&&) noexcept;

  Eigen::Vector3d Place(const Eigen::Vector3d& in_map_m) const;
  const OGRSpatialReference& reference() const { return *reference_; }

 private:
  GisFrame();
  std::unique_ptr<OGRSpatialReference> reference_;
  std::optional<GeodeticOrigin> degrees_about_;
};

/// A GeoPackage file, or a PostGIS database, through GDAL. Every function throws std::runtime_error, with
/// what GDAL says of it, when it fails; nothing is changed then but by what was committed before. Not
/// thread-safe.
class GisDataset {
 public:
  /// A GeoPackage that is made anew.
  static GisDataset CreateFile(const std::string& file);
  /// @param place  A GeoPackage's file, or "PG:" and a connection string.
  static GisDataset Open(const std::string& place, bool is_read_only);
  ~GisDataset();
  GisDataset(GisDataset&&) noexcept;
  GisDataset& operator=(GisDataset&&) noexcept;

  void Begin();
  void Commit();
  void Rollback() noexcept;

  bool Has(const std::string& layer) const;
  std::size_t CountLayers() const;
  /// Makes the layer if there is none of that name, with its style, and adds the features to it.
  void Add(const GisLayer& layer, const GisFrame& frame = GisFrame::InMetres(std::nullopt));
  void Execute(const std::string& sql);
  /// The columns of each row, as they are declared in the database.
  std::vector<std::vector<GisValue>> Select(const std::string& sql);

 private:
  explicit GisDataset(GDALDataset* dataset);
  OGRLayer& Find(const GisLayer& layer, const GisFrame& frame);
  void AddStyle(const GisLayer& layer);

  struct Close {
    void operator()(GDALDataset* dataset) const;
  };
  std::unique_ptr<GDALDataset, Close> dataset_;
};

}  // namespace soffit
