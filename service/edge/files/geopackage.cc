#include "service/edge/files/geopackage.h"

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <memory>
#include <stdexcept>

#include "service/edge/files/file.h"

namespace soffit {
namespace {

struct CloseDataset {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using Dataset = std::unique_ptr<GDALDataset, CloseDataset>;

void Require(bool is_done, const std::string& what) {
  if (!is_done) throw std::runtime_error("GDAL cannot " + what + ": " + CPLGetLastErrorMsg());
}

OGRSpatialReference FrameOf(const std::optional<GeodeticOrigin>& origin) {
  OGRSpatialReference frame;
  if (!origin) {
    frame.SetLocalCS("Soffit map, ENU about the home point");
    frame.SetLinearUnits("metre", 1.0);
    return frame;
  }
  frame.SetProjCS("Soffit map, ENU about the home point");
  frame.SetWellKnownGeogCS("WGS84");
  frame.SetTM(origin->latitude_deg, origin->longitude_deg, 1.0, 0.0, 0.0);
  frame.SetLinearUnits("metre", 1.0);
  return frame;
}

std::unique_ptr<OGRPolygon> ToPolygon(const std::vector<std::vector<Eigen::Vector3d>>& rings) {
  auto polygon = std::make_unique<OGRPolygon>();
  for (const std::vector<Eigen::Vector3d>& corners : rings) {
    auto ring = std::make_unique<OGRLinearRing>();
    for (const Eigen::Vector3d& p : corners) ring->addPoint(p.x(), p.y(), p.z());
    ring->closeRings();
    polygon->addRingDirectly(ring.release());
  }
  return polygon;
}

std::unique_ptr<OGRLineString> ToLine(const std::vector<Eigen::Vector3d>& points) {
  auto line = std::make_unique<OGRLineString>();
  for (const Eigen::Vector3d& p : points) line->addPoint(p.x(), p.y(), p.z());
  return line;
}

/// A layer to which features are added one after another.
class Layer {
 public:
  Layer(GDALDataset& dataset, const char* name, OGRSpatialReference& frame, OGRwkbGeometryType type,
        const std::vector<std::pair<const char*, OGRFieldType>>& fields)
      : layer_(dataset.CreateLayer(name, &frame, type, nullptr)) {
    Require(layer_ != nullptr, "make a layer");
    for (const auto& [field_name, field_type] : fields) {
      OGRFieldDefn field(field_name, field_type);
      Require(layer_->CreateField(&field) == OGRERR_NONE, "make a field");
    }
  }

  /// `values` in the order of the fields.
  template <class... Values>
  void Add(std::unique_ptr<OGRGeometry> geometry, const Values&... values) {
    OGRFeature feature(layer_->GetLayerDefn());
    int field = 0;
    (feature.SetField(field++, values), ...);
    if (geometry) Require(feature.SetGeometryDirectly(geometry.release()) == OGRERR_NONE, "set a geometry");
    Require(layer_->CreateFeature(&feature) == OGRERR_NONE, "write a feature");
  }

 private:
  OGRLayer* layer_;
};

void AddBuildings(GDALDataset& dataset, OGRSpatialReference& frame, const Scene& scene) {
  Layer layer(dataset, "buildings", frame, wkbPolygon25D,
              {{"object", OFTInteger},
               {"color", OFTString},
               {"height_m", OFTReal},
               {"height_std_m", OFTReal},
               {"matched", OFTInteger},
               {"score", OFTReal}});
  for (const SceneObject& object : scene.objects) {
    const Footprint& footprint = object.footprint;
    std::vector<std::vector<Eigen::Vector3d>> rings;
    const auto add = [&](const Ring& ring) {
      std::vector<Eigen::Vector3d> corners;
      for (const Eigen::Vector2d& p : ring) corners.emplace_back(p.x(), p.y(), 0.0);
      rings.push_back(corners);
    };
    add(footprint.polygon_in_map_m.outer);
    for (const Ring& hole : footprint.polygon_in_map_m.holes) add(hole);
    layer.Add(ToPolygon(rings), static_cast<int>(footprint.object_id), footprint.color.c_str(),
              footprint.height_m, footprint.height_std_m, object.is_matched ? 1 : 0,
              object.is_matched ? object.match.score : 0.0);
  }
}

void AddOpenings(GDALDataset& dataset, OGRSpatialReference& frame, const Scene& scene) {
  Layer layer(dataset, "openings", frame, wkbPolygon25D,
              {{"object", OFTInteger}, {"wall", OFTInteger}, {"through", OFTInteger}, {"depth_m", OFTReal}});
  for (const Solid& solid : scene.solids) {
    for (const SolidOpening& opening : solid.openings) {
      layer.Add(ToPolygon({opening.polygon_in_map_m}), static_cast<int>(solid.footprint.object_id),
                opening.wall, opening.is_through ? 1 : 0, opening.depth_m);
    }
  }
}

void AddDecisions(GDALDataset& dataset, OGRSpatialReference& frame,
                  const std::vector<ClearanceDecision>& decisions) {
  Layer layer(dataset, "decisions", frame, wkbLineString25D,
              {{"object", OFTInteger},
               {"side", OFTInteger},
               {"decision", OFTString},
               {"reason", OFTString},
               {"free_width_m", OFTReal},
               {"free_height_m", OFTReal}});
  for (const ClearanceDecision& decision : decisions) {
    const auto id = static_cast<int>(decision.object_id);
    const char* verdict = ToString(decision.verdict);
    if (decision.corridor) {
      const Corridor& corridor = *decision.corridor;
      layer.Add(ToLine({corridor.entry_in_map_m, corridor.exit_in_map_m}), id, decision.side, verdict,
                decision.reason.c_str(), corridor.free_width_m, corridor.free_height_m);
    } else {
      layer.Add(nullptr, id, decision.side, verdict, decision.reason.c_str());
    }
  }
}

void AddViewpoints(GDALDataset& dataset, OGRSpatialReference& frame,
                   const std::vector<Observation>& observations) {
  Layer layer(dataset, "viewpoints", frame, wkbPoint25D,
              {{"capture", OFTInteger}, {"file", OFTString}, {"purpose", OFTString}});
  for (const Observation& seen : observations) {
    const Eigen::Vector3d& p = seen.image.view.map_from_camera.translation_m;
    layer.Add(std::make_unique<OGRPoint>(p.x(), p.y(), p.z()), static_cast<int>(seen.image.capture_id),
              seen.image.name.c_str(), ToString(seen.image.purpose));
  }
}

void AddTrack(GDALDataset& dataset, OGRSpatialReference& frame, const std::vector<Eigen::Vector3d>& track) {
  Layer layer(dataset, "track", frame, wkbLineString25D, {});
  if (track.size() >= 2) layer.Add(ToLine(track));
}

}  // namespace

Status WriteGeoPackage(const std::filesystem::path& file, const Understanding& understanding,
                       const std::vector<Observation>& observations, const FlightRecord& flight) try {
  GDALAllRegister();
  // The format stores when it was written; without a fixed date the same scene would not give the same bytes.
  CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", "2000-01-01T00:00:00.000Z");
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GPKG");
  Require(driver != nullptr, "write GeoPackages");
  const std::filesystem::path part = PartOf(file);
  std::filesystem::remove(part);
  {
    const Dataset dataset(driver->Create(part.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
    Require(dataset != nullptr, "make " + part.string());
    OGRSpatialReference frame = FrameOf(flight.origin);
    Require(dataset->StartTransaction() == OGRERR_NONE, "begin");
    AddBuildings(*dataset, frame, understanding.scene);
    AddOpenings(*dataset, frame, understanding.scene);
    AddDecisions(*dataset, frame, understanding.decisions);
    AddViewpoints(*dataset, frame, observations);
    AddTrack(*dataset, frame, flight.track_in_map_m);
    Require(dataset->CommitTransaction() == OGRERR_NONE, "finish");
  }
  return CommitFile(file);
} catch (const std::exception& failure) {
  return Error{Error::Code::kUnavailable, file.string() + ": " + failure.what()};
}

}  // namespace soffit
