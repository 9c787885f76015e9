#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shared/frames/frames.h"

namespace soffit {

/// Pinhole intrinsics with OpenCV's `plumb_bob` distortion. Pixel centres are at integer coordinates.
struct Intrinsics {
  int width_px = 0;
  int height_px = 0;
  double fx_px = 0.0;
  double fy_px = 0.0;
  double cx_px = 0.0;
  double cy_px = 0.0;
  std::array<double, 5> distortion{};  ///< k1, k2, p1, p2, k3.
};

/// Finite, with positive size and focal lengths. A default object is not valid.
bool IsValid(const Intrinsics& intrinsics);

/// Why a picture is taken. The zero value serves nothing.
enum class Purpose { kUnknown, kOverview, kTop, kWall, kCorridor };

const char* ToString(Purpose purpose);  ///< "overview", "top", ...
std::optional<Purpose> PurposeFromString(const std::string& text);

/// One picture as it was taken: compressed bytes and all that is known of the moment of exposure.
struct Capture {
  std::uint32_t vehicle_id = 0;
  std::uint64_t mission_id = 0;
  std::uint32_t capture_id = 0;  ///< Unique within the mission.
  std::string name;              ///< File name for people, without folders; may be empty.
  Purpose purpose = Purpose::kUnknown;
  std::int64_t exposure_utc_ns = 0;
  Intrinsics intrinsics;
  Pose<Map, Camera> map_from_camera;  ///< Interpolated at the exposure.
  bool has_trusted_pose = false;      ///< False: never used as evidence for CLEAR.
  double position_std_m = 0.0;        ///< Per axis.
  double orientation_std_rad = 0.0;   ///< Per axis.
  std::vector<std::uint8_t> bytes;    ///< JPEG or PNG.
};

/// An ideal (undistorted) pinhole camera somewhere in the map.
struct View {
  Intrinsics intrinsics;  ///< `distortion` is zero.
  Pose<Map, Camera> map_from_camera;
  double position_std_m = 0.0;
  double orientation_std_rad = 0.0;
};

/// Pixel of a point of the map; none when it is not in front of the camera (depth < 1 mm). May lie outside
/// the picture.
std::optional<Eigen::Vector2d> Project(const View& view, const Eigen::Vector3d& in_map_m);

/// Pixel at which a lens shows what lies in the direction (x, y, 1) of the camera, distortion included.
Eigen::Vector2d PixelOf(const Intrinsics& intrinsics, const Eigen::Vector2d& direction);

/// Unit direction, in the map, of the ray through a pixel.
Eigen::Vector3d RayDirection(const View& view, const Eigen::Vector2d& pixel);

/// Where the ray through a pixel meets the plane z = `height_m`; none when it runs away from it.
std::optional<Eigen::Vector2d> MeetHorizontalPlane(const View& view, const Eigen::Vector2d& pixel,
                                                   double height_m);

}  // namespace soffit
