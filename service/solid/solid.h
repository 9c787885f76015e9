#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "service/facade/facade.h"
#include "service/footprint/footprint.h"
#include "shared/geometry/polygon.h"
#include "shared/result/result.h"

namespace soffit {

/// Triangles with outward normals.
struct Mesh {
  std::vector<Eigen::Vector3d> vertices_in_map_m;
  std::vector<std::array<int, 3>> triangles;
};

/// An opening as a planar polygon in the map.
struct SolidOpening {
  int wall = -1;  ///< Side of the footprint; -1: the roof.
  std::vector<Eigen::Vector3d> polygon_in_map_m;
  bool is_through = false;
  double depth_m = 0.0;
  double std_m = 0.0;
};

/// An upright planar polygon across a passage: its lower corners from left to right as seen by who enters,
/// then the upper ones back.
using Section = std::vector<Eigen::Vector3d>;

/// A way through the building, from mouth to mouth.
struct Passage {
  int entry_wall = -1;
  int exit_wall = -1;
  std::size_t entry_opening = 0;  ///< Index into Solid::openings.
  std::size_t exit_opening = 0;
  std::vector<Section> sections_in_map_m;  ///< As of FindTunnels(): more than two when it bends.
  double std_m = 0.0;                      ///< Of the sides of its sections.
};

enum class FaceKind { kGround, kRoof, kWall, kCeiling, kFloor, kBack };  ///< kBack: of a recess.
const char* ToString(FaceKind kind);  ///< As CityGML names such a surface: "GroundSurface", ..., "Window".

/// Where a face is in the picture that it came from.
struct FacePicture {
  std::uint32_t capture_id = 0;
  /// The face's outline, cut off at the picture's edge, in pixels of the picture as it was taken. Its rings
  /// turn as they happen to; parts of one that the picture's edge separates hang together along that edge.
  Polygon outline_px;
  double shown_ratio = 0.0;  ///< Share of the face that the picture shows; the rest is cut off or hidden.
};

/// A part of the surface that came about as a whole, and hangs together. It is planar, but where a passage
/// twists.
struct Face {
  FaceKind kind = FaceKind::kWall;
  int wall = -1;     ///< The side of the footprint that it stands on or belongs to; -1: none.
  int opening = -1;  ///< The passage or recess that it is inside of, by its first mouth in Solid::openings.
  std::vector<std::size_t> triangles;  ///< Of the mesh.
  std::optional<FacePicture> picture;  ///< As FindFacePictures() says.
};

/// Closed, oriented 2-manifold model of one building.
struct Solid {
  Footprint footprint;  ///< As adjusted to all pictures.
  Mesh mesh;            ///< Passed IsClosedManifold().
  double volume_m3 = 0.0;
  std::vector<SolidOpening> openings;
  std::vector<Passage> passages;
  std::vector<Face> faces;        ///< Each triangle is in one.
  std::vector<int> unseen_walls;  ///< Nothing is known of openings in these.
};

/// The solid of one building: the footprint raised to its height, less its recesses and passages; in other
/// words the common part of what the pictures show (paper, section 2.6). An error when the result is not a
/// closed 2-manifold.
///
/// A passage is cut for each way that FindTunnels() gives; an opening whose opposite wall was seen closed
/// does not lead through, whatever is seen in it. A passage is a proposal: whether it is free is for the
/// scene to say.
Result<Solid> RaiseSolid(const Footprint& footprint, const std::vector<Facade>& facades);

/// Every edge has exactly two triangles in opposite directions, and the volume is positive.
bool IsClosedManifold(const Mesh& mesh);
double VolumeM3(const Mesh& mesh);

}  // namespace soffit
