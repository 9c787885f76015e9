#include "service/edge/files/gis_dataset.h"

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <stdexcept>

#include "service/edge/files/geodetic.h"

namespace soffit {
namespace {

constexpr char kStyles[] = "layer_styles";
constexpr char kGeometryColumn[] = "geom";

[[noreturn]] void Throw(const std::string& what) {
  const std::string why = CPLGetLastErrorMsg();
  throw std::runtime_error(what + (why.empty() ? "" : ": " + why));
}

void Require(bool is_done, const std::string& what) {
  if (!is_done) Throw("cannot " + what);
}

/// What GDAL says goes into messages here, not to standard error.
class Quietly {
 public:
  Quietly() {
    CPLErrorReset();
    CPLPushErrorHandler(CPLQuietErrorHandler);
  }
  ~Quietly() { CPLPopErrorHandler(); }
  Quietly(const Quietly&) = delete;
  Quietly& operator=(const Quietly&) = delete;
};

OGRwkbGeometryType TypeOf(GisShape shape) {
  switch (shape) {
    case GisShape::kPoint:
      return wkbPoint25D;
    case GisShape::kLine:
      return wkbLineString25D;
    case GisShape::kPolygon:
      return wkbPolygon25D;
    case GisShape::kNone:
      break;
  }
  return wkbNone;
}

OGRFieldType TypeOf(GisType type) {
  switch (type) {
    case GisType::kReal:
      return OFTReal;
    case GisType::kText:
      return OFTString;
    case GisType::kBytes:
      return OFTBinary;
    case GisType::kBoolean:
      return OFTInteger;
    case GisType::kInteger:
      break;
  }
  return OFTInteger64;
}

std::unique_ptr<OGRGeometry> GeometryOf(GisShape shape,
                                        const std::vector<std::vector<Eigen::Vector3d>>& parts,
                                        const GisFrame& frame) {
  if (shape == GisShape::kNone || parts.empty() || parts.front().empty()) return nullptr;
  const auto add = [&](OGRSimpleCurve& curve, const std::vector<Eigen::Vector3d>& points) {
    for (const Eigen::Vector3d& point : points) {
      const Eigen::Vector3d p = frame.Place(point);
      curve.addPoint(p.x(), p.y(), p.z());
    }
  };
  if (shape == GisShape::kPoint) {
    const Eigen::Vector3d p = frame.Place(parts.front().front());
    return std::make_unique<OGRPoint>(p.x(), p.y(), p.z());
  }
  if (shape == GisShape::kLine) {
    auto line = std::make_unique<OGRLineString>();
    add(*line, parts.front());
    return line;
  }
  auto polygon = std::make_unique<OGRPolygon>();
  for (const auto& part : parts) {
    auto ring = std::make_unique<OGRLinearRing>();
    add(*ring, part);
    ring->closeRings();
    polygon->addRingDirectly(ring.release());
  }
  return polygon;
}

void SetField(OGRFeature& feature, int field, const GisValue& value) {
  std::visit(
      [&](const auto& v) {
        using T = std::decay_t<decltype(v)>;
        if constexpr (std::is_same_v<T, std::monostate>) {
          feature.SetFieldNull(field);
        } else if constexpr (std::is_same_v<T, std::int64_t>) {
          feature.SetField(field, static_cast<GIntBig>(v));
        } else if constexpr (std::is_same_v<T, bool>) {
          feature.SetField(field, v ? 1 : 0);
        } else if constexpr (std::is_same_v<T, std::string>) {
          feature.SetField(field, v.c_str());
        } else if constexpr (std::is_same_v<T, double>) {
          feature.SetField(field, v);
        } else {
          feature.SetField(field, static_cast<int>(v.size()), static_cast<const void*>(v.data()));
        }
      },
      value);
}

GisValue ValueOf(const OGRFeature& feature, int field) {
  if (!feature.IsFieldSetAndNotNull(field)) return {};
  const OGRFieldDefn& definition = *feature.GetFieldDefnRef(field);
  switch (definition.GetType()) {
    case OFTInteger:
      if (definition.GetSubType() == OFSTBoolean) return feature.GetFieldAsInteger(field) != 0;
      return std::int64_t{feature.GetFieldAsInteger(field)};
    case OFTInteger64:
      return static_cast<std::int64_t>(feature.GetFieldAsInteger64(field));
    case OFTReal:
      return feature.GetFieldAsDouble(field);
    case OFTBinary: {
      int size = 0;
      const GByte* bytes = feature.GetFieldAsBinary(field, &size);
      return std::vector<std::uint8_t>(bytes, bytes + size);
    }
    default:
      return std::string(feature.GetFieldAsString(field));
  }
}

bool IsDatabase(const std::string& place) { return place.starts_with("PG:"); }

/// Write-ahead: who reads meanwhile is not locked out, and what was committed is on the disk.
void ConfigureGdal() {
  GDALAllRegister();
  CPLSetConfigOption("OGR_SQLITE_JOURNAL", "WAL");
  CPLSetConfigOption("PG_USE_COPY", "YES");
}

}  // namespace

// ---- Where it lies ----

GisFrame::GisFrame() : reference_(std::make_unique<OGRSpatialReference>()) {}
GisFrame::~GisFrame() = default;
GisFrame::GisFrame(GisFrame&&) noexcept = default;
GisFrame& GisFrame::operator=(GisFrame&&) noexcept = default;

GisFrame GisFrame::InMetres(const std::optional<GeodeticOrigin>& origin) {
  GisFrame frame;
  if (origin) {
    frame.reference_->SetProjCS("Soffit map, ENU about the home point");
    frame.reference_->SetWellKnownGeogCS("WGS84");
    frame.reference_->SetTM(origin->latitude_deg, origin->longitude_deg, 1.0, 0.0, 0.0);
  } else {
    frame.reference_->SetLocalCS("Soffit map, ENU about the home point");
  }
  frame.reference_->SetLinearUnits("metre", 1.0);
  return frame;
}

GisFrame GisFrame::InDegrees(const GeodeticOrigin& origin) {
  GisFrame frame;
  frame.reference_->importFromEPSG(4326);
  frame.reference_->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  frame.degrees_about_ = origin;
  return frame;
}

Eigen::Vector3d GisFrame::Place(const Eigen::Vector3d& in_map_m) const {
  if (!degrees_about_) return in_map_m;
  const GeodeticPoint p = GeodeticFrame(*degrees_about_).Place(in_map_m);
  return {p.longitude_deg, p.latitude_deg, p.altitude_amsl_m};
}

// ---- The dataset ----

void GisDataset::Close::operator()(GDALDataset* dataset) const {
  const Quietly quietly;
  GDALClose(dataset);
}

GisDataset::GisDataset(GDALDataset* dataset) : dataset_(dataset) {}
GisDataset::~GisDataset() = default;
GisDataset::GisDataset(GisDataset&&) noexcept = default;
GisDataset& GisDataset::operator=(GisDataset&&) noexcept = default;

GisDataset GisDataset::CreateFile(const std::string& file) {
  const Quietly quietly;
  ConfigureGdal();
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GPKG");
  Require(driver != nullptr, "write GeoPackages with this GDAL");
  GDALDataset* dataset = driver->Create(file.c_str(), 0, 0, 0, GDT_Unknown, nullptr);
  Require(dataset != nullptr, "make it");
  return GisDataset(dataset);
}

GisDataset GisDataset::Open(const std::string& place, bool is_read_only) {
  const Quietly quietly;
  ConfigureGdal();
  const char* const drivers[] = {IsDatabase(place) ? "PostgreSQL" : "GPKG", nullptr};
  const unsigned access = is_read_only ? GDAL_OF_READONLY : GDAL_OF_UPDATE;
  const char* const options[] = {"LIST_ALL_TABLES=YES", nullptr};
  GDALDataset* dataset = GDALDataset::Open(place.c_str(), GDAL_OF_VECTOR | access, drivers, options);
  Require(dataset != nullptr, IsDatabase(place) ? "connect" : "open it as a GeoPackage");
  return GisDataset(dataset);
}

void GisDataset::Begin() {
  const Quietly quietly;
  Require(dataset_->StartTransaction() == OGRERR_NONE, "begin a transaction");
}

void GisDataset::Commit() {
  const Quietly quietly;
  dataset_->FlushCache();  // Extents and indices, which GDAL would write when it closes.
  Require(CPLGetLastErrorType() < CE_Failure, "finish a transaction");
  Require(dataset_->CommitTransaction() == OGRERR_NONE, "commit");
}

void GisDataset::Rollback() noexcept {
  const Quietly quietly;
  dataset_->RollbackTransaction();
}

bool GisDataset::Has(const std::string& layer) const {
  const Quietly quietly;
  return dataset_->GetLayerByName(layer.c_str()) != nullptr;
}

std::size_t GisDataset::CountLayers() const { return static_cast<std::size_t>(dataset_->GetLayerCount()); }

OGRLayer& GisDataset::Find(const GisLayer& layer, const GisFrame& frame) {
  if (OGRLayer* known = dataset_->GetLayerByName(layer.name.c_str())) return *known;
  const bool has_shape = layer.shape != GisShape::kNone;
  const std::string geometry = "GEOMETRY_NAME=" + std::string(kGeometryColumn);
  const char* const options[] = {has_shape ? geometry.c_str() : nullptr, nullptr};
  OGRSpatialReference reference(frame.reference());
  OGRLayer* made = dataset_->CreateLayer(layer.name.c_str(), has_shape ? &reference : nullptr,
                                         TypeOf(layer.shape), const_cast<char**>(options));
  Require(made != nullptr, "make the layer " + layer.name);
  for (const GisColumn& column : layer.columns) {
    OGRFieldDefn field(column.name.c_str(), TypeOf(column.type));
    if (column.type == GisType::kBoolean) field.SetSubType(OFSTBoolean);
    Require(made->CreateField(&field) == OGRERR_NONE, "make the column " + column.name);
  }
  AddStyle(layer);
  return *made;
}

/// QGIS draws a layer as the default style in this table says.
void GisDataset::AddStyle(const GisLayer& layer) {
  const std::string style = StyleOf(layer);
  if (style.empty()) return;
  Add({kStyles,
       GisShape::kNone,
       {{"f_table_catalog", GisType::kText},
        {"f_table_schema", GisType::kText},
        {"f_table_name", GisType::kText},
        {"f_geometry_column", GisType::kText},
        {"styleName", GisType::kText},
        {"styleQML", GisType::kText},
        {"styleSLD", GisType::kText},
        {"useAsDefault", GisType::kBoolean},
        {"description", GisType::kText},
        {"owner", GisType::kText}},
       {{{},
         {std::string(), std::string(), layer.name, std::string(kGeometryColumn), layer.name, style,
          std::string(), true, std::string("Soffit"), std::string()}}}},
      GisFrame::InMetres(std::nullopt));
}

void GisDataset::Add(const GisLayer& layer, const GisFrame& frame) {
  const Quietly quietly;
  OGRLayer& target = Find(layer, frame);
  std::vector<int> fields;
  for (const GisColumn& column : layer.columns) {
    fields.push_back(target.GetLayerDefn()->GetFieldIndex(column.name.c_str()));
    Require(fields.back() >= 0, "find the column " + column.name + " of " + layer.name);
  }
  for (const GisFeature& feature : layer.features) {
    OGRFeature row(target.GetLayerDefn());
    for (std::size_t i = 0; i < fields.size(); ++i) SetField(row, fields[i], feature.values.at(i));
    if (auto geometry = GeometryOf(layer.shape, feature.parts_in_map_m, frame))
      Require(row.SetGeometryDirectly(geometry.release()) == OGRERR_NONE, "set a geometry");
    Require(target.CreateFeature(&row) == OGRERR_NONE, "write to " + layer.name);
  }
}

void GisDataset::Execute(const std::string& sql) {
  const Quietly quietly;
  OGRLayer* result = dataset_->ExecuteSQL(sql.c_str(), nullptr, nullptr);
  const bool has_failed = CPLGetLastErrorType() >= CE_Failure;
  if (result != nullptr) dataset_->ReleaseResultSet(result);
  Require(!has_failed, "change what is kept");
}

std::vector<std::vector<GisValue>> GisDataset::Select(const std::string& sql) {
  const Quietly quietly;
  OGRLayer* result = dataset_->ExecuteSQL(sql.c_str(), nullptr, nullptr);
  Require(result != nullptr && CPLGetLastErrorType() < CE_Failure, "read what is kept");
  std::vector<std::vector<GisValue>> rows;
  while (const OGRFeatureUniquePtr feature{result->GetNextFeature()}) {
    std::vector<GisValue>& row = rows.emplace_back();
    for (int field = 0; field < feature->GetFieldCount(); ++field) row.push_back(ValueOf(*feature, field));
  }
  const bool has_failed = CPLGetLastErrorType() >= CE_Failure;
  dataset_->ReleaseResultSet(result);
  Require(!has_failed, "read what is kept");
  return rows;
}

}  // namespace soffit
