#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "shared/capture/capture.h"
#include "shared/flight/flight.h"
#include "shared/geometry/polygon.h"
#include "shared/result/result.h"

namespace soffit::sim {

/// How a surface is painted. Lengths of the pattern scale with `grain_m`.
enum class Pattern { kPlain, kMottled, kPanels, kBricks, kSlabs, kGrass };

struct Finish {
  Eigen::Vector3d color_srgb = {0.5, 0.5, 0.5};  ///< 0 to 1.
  Pattern pattern = Pattern::kMottled;
  double grain_m = 0.4;    ///< Size of the pattern's features.
  double contrast = 0.12;  ///< 0: even; 1: as strong as it gets.
};

/// A polygon moved along a straight line, in the frame of its structure; an upright one may change on its
/// way.
struct Prism {
  Polygon section;  ///< Upright: (x, y). Lying: (right, up) as seen by who looks along `axis` from `at`.
  Ring top;  ///< Upright, without holes: what the section's corners become on the way up; empty: the same.
  double low_m = 0.0;  ///< Upright: z of the lower face. Lying: distance along `axis` from `at`.
  double high_m = 0.0;
  bool is_lying = false;
  Eigen::Vector2d axis = Eigen::Vector2d::UnitY();  ///< Lying: its horizontal direction, a unit vector.
  Eigen::Vector2d at = Eigen::Vector2d::Zero();     ///< Lying: the section's origin.
};

struct Mesh {
  std::vector<Eigen::Vector3d> vertices_m;
  std::vector<std::array<int, 3>> triangles;  ///< Counter-clockwise seen from outside.
};

/// Triangles from a file, and which of them.
struct MeshFile {
  std::string file;  ///< As written in the world file, relative to it: OBJ, or CityGML 2 or 3.
  std::optional<Eigen::Vector3d>
      origin;                        ///< Of the structure's frame, in the file's coordinates. None: that of
                                     ///< the file (OBJ); the middle of all, where it is lowest (CityGML).
  std::vector<std::string> only;     ///< Kinds and ids of surfaces (CityGML); empty: all.
  std::vector<std::string> without;  ///< The same. ClosureSurface, where nothing is, is always left out.
  std::vector<Prism> cuts;           ///< What lies in one of them is taken away.
  Mesh mesh;                         ///< What is left, in the structure's frame.
};

struct Part {
  std::variant<Prism, MeshFile> shape;
  std::optional<Finish> finish;  ///< Instead of the structure's own.
};

/// A building, an obstacle or a thing at the horizon. Parts may touch and overlap.
struct Structure {
  std::string id;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< Of its frame's origin, on the ground.
  double yaw_rad = 0.0;
  bool is_absent = false;  ///< Known to the reference only: it is not there.
  Finish finish;
  std::vector<Part> parts;
};

struct Bush {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  double radius_m = 0.3;
};

struct Sun {
  double yaw_rad = 0.9;  ///< Towards the sun, counter-clockwise from east.
  double elevation_rad = 0.8;
  double strength = 1.0;  ///< 0: overcast.
};

struct Sky {
  double cloud_ratio = 0.3;  ///< 0 clear, 1 overcast.
  double haze_m = 400.0;     ///< Distance at which things have faded to 37 %.
};

struct Wind {
  Eigen::Vector2d mean_mps = Eigen::Vector2d::Zero();  ///< Blowing towards.
  double gust_std_mps = 0.0;
};

/// Error of what the estimator reports, per axis.
struct PoseNoise {
  double position_std_m = 0.0;
  double orientation_std_rad = 0.0;
};

struct CameraModel {
  Intrinsics intrinsics;
  double exposure_s = 0.004;
  double exposure_ev = 0.0;   ///< Brighter (+) or darker (-) than the automatic exposure.
  double noise_levels = 1.5;  ///< Standard deviation, of 255.
  double blur_px = 0.5;       ///< Standard deviation of the lens blur.
  double vignetting = 0.15;   ///< Loss of light in the corners.
  int jpeg_quality = 90;
};

/// The wanted building or group, as the reference bitmap shows it.
struct MissionPlan {
  std::vector<std::string> wanted;  ///< Ids of buildings.
  double reference_m_per_px = 0.025;
  double reference_rotation_cw_rad =
      0.0;  ///< The reference, north up, has to be turned clockwise by this to lie like the buildings.
  Eigen::Vector2d area_center_m = Eigen::Vector2d::Zero();  ///< Over which the overview is taken: home.
  double overview_altitude_m = 9.0;                         ///< From which the whole area is seen.
};

/// Everything that is there, in the map frame: ENU metres, the origin is the vehicle's home on flat ground at
/// z = 0.
struct World {
  std::string name;
  std::string title;
  GeodeticOrigin origin{47.397742, 8.545594, 488.0};
  double home_yaw_rad = 0.0;
  Sun sun;
  Sky sky;
  Finish ground{{0.42, 0.42, 0.40}, Pattern::kSlabs, 2.0, 0.12};
  Wind wind;
  PoseNoise pose_noise;
  CameraModel camera;
  VehicleEnvelope vehicle;
  MissionPlan mission;
  std::vector<Structure> buildings;
  std::vector<Structure> obstacles;
  std::vector<Structure> scenery;
  std::vector<Bush> bushes;
};

/// Reads a world from YAML (every key: test/sim/scenarios/README.md). An unknown key, a number that is not
/// finite or out of range, a polygon that crosses itself, or a name that does not exist is an error that
/// names file and line.
Result<World> LoadWorld(const std::filesystem::path& file);
Result<World> ParseWorld(const std::string& yaml, const std::string& name,
                         const std::filesystem::path& folder);

/// The world as YAML; ParseWorld gives an equal world back. Meshes stay references to their files.
std::string FormatWorld(const World& world);

}  // namespace soffit::sim
