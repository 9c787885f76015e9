#pragma once

#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "service/facade/facade.h"
#include "service/scene/prediction.h"
#include "service/scene/range_pyramid.h"

namespace soffit {

/// What one picture proves of the ray of each of its pixels: how far it is free, and where something stands
/// on it that the model does not have.
///
/// A pixel proves its ray free when it shows what the model predicts: structure where a solid is met (free up
/// to its surface), ground or sky where none is. Two pixels beside a predicted edge either side of it is
/// accepted. Anything else may stand anywhere on the ray, which then proves nothing. Ground that
/// no other picture confirms proves little where it lies within `region` or looks like shade: something near
/// that is coloured like ground, or dark, would look the same.
class Evidence {
 public:
  /// @param votes  GroundVote values of GroundCheck; size of the picture.
  /// @param lines  LineMark values of ThinLines; size of the picture, or empty.
  Evidence(const Sight& sight, const Prediction& prediction, const cv::Mat1b& votes, const cv::Mat1b& lines,
           const Eigen::AlignedBox2d& region);

  /// Whether every ray through the ball goes on free beyond it, and how sure that is. kSure: it ends on the
  /// model or in the sky, which colours tell. kLikely: on ground; something may be coloured like it.
  /// kPerhaps: on ground that no other picture confirms.
  enum class Sees { kNothing, kPerhaps, kLikely, kSure };
  Sees SeeThrough(const Eigen::Vector3d& center_in_map_m, double radius_m) const;

  /// False when no ray through the ball goes on free beyond it; some are tried.
  bool SeesPartly(const Eigen::Vector3d& center_in_map_m, double radius_m) const;

  /// What SeeThrough() says of each ball within this one, where one look tells that for all of them.
  /// kNothing: moreover none of them is seen partly, and no thing, line or disguise shows there; else no
  /// trace of a line does.
  std::optional<Sees> SeesAlike(const Eigen::Vector3d& center_in_map_m, double radius_m) const;

  /// Whether the picture was searched for thin lines; whether the ball is before or behind one that may hang
  /// or stand there, or before or behind a trace of one.
  bool MayShowLines() const { return !line_sum_.empty(); }
  bool ShowsLineWithin(const Eigen::Vector3d& center_in_map_m, double radius_m) const;
  bool ShowsTraceWithin(const Eigen::Vector3d& center_in_map_m, double radius_m) const;

  /// Whether something that the model does not have, and that is near, may stand at this point: it covers a
  /// part of the model that lies behind, or meets the ground here. What only shows before sky or far ground
  /// may be far away.
  bool ShowsThingAt(const Eigen::Vector3d& point_in_map_m) const;

  /// Whether a bar whose foot is seen may stand within the ball. Pictures that are farther off may not show
  /// it.
  bool ShowsBarWithin(const Eigen::Vector3d& center_in_map_m, double radius_m) const;

  /// Whether background's colour proves nothing at this point, in other pictures either: it is before or
  /// behind something that is coloured like background and yet covers a part of the model, or where something
  /// stands that other pictures deny to be a mark of the ground, and may be coloured like ground on its other
  /// sides.
  bool DistrustsColorAt(const Eigen::Vector3d& point_in_map_m) const;

  const Eigen::Vector3d& camera_in_map_m() const { return view_.map_from_camera.translation_m; }
  std::uint32_t capture_id() const { return capture_id_; }

 private:
  /// A connected part of the picture that neither the model nor a misfit of its edges explains, with the
  /// depths between which it may be.
  struct Thing {
    float near_m = 0.0F;
    float far_m = 0.0F;      ///< 0: it may be anywhere.
    bool is_raised = false;  ///< No mark of the ground.

    bool MayBeAt(double depth_m) const { return far_m > 0.0F && depth_m >= near_m && depth_m <= far_m; }
  };

  /// Pixels, up to and including the last ones.
  struct Window {
    int x0 = 0, x1 = 0, y0 = 0, y1 = 0;
  };
  /// The pixels about a ball, and the depth beyond which its rays have to be free.
  struct Target {
    Window window;
    float beyond_m = 0.0F;
  };
  Eigen::Vector3d InCamera(const Eigen::Vector3d& point_in_map_m) const {
    return turn_ * (point_in_map_m - camera_in_map_m());
  }

  std::optional<cv::Point> PixelAt(const Eigen::Vector3d& point_in_camera_m) const;

  /// None when the ball is not wholly in the picture.
  std::optional<Target> About(const Eigen::Vector3d& center_in_map_m, double radius_m) const;

  /// Pixels that hold the windows of all balls within this one, in camera coordinates; perhaps beyond the
  /// picture's edge. The camera is outside the ball.
  Window Cover(const Eigen::Vector3d& center_in_camera_m, double radius_m) const;
  static int Count(const cv::Mat1i& sum, const Window& window);

  void Compare(const Sight& sight, const Prediction& prediction);
  void NoteUnconfirmedGround(const Sight& sight, const Prediction& prediction, const cv::Mat1b& votes,
                             const Eigen::AlignedBox2d& region);
  void FindThings(const Sight& sight, const Prediction& prediction, const cv::Mat1b& votes);
  void FollowThingsDown(const Sight& sight, const Prediction& prediction, const Eigen::AlignedBox2d& region);
  void SumUp(const Prediction& prediction, const cv::Mat1b& lines);

  std::uint32_t capture_id_ = 0;
  View view_;
  Eigen::Matrix3d turn_;    ///< Turns vectors of the map into camera coordinates.
  cv::Mat1b fails_;         ///< 1: the pixel proves nothing.
  cv::Mat1b is_disguised_;  ///< 255: coloured like background, and yet part of a thing that is near.
  cv::Mat1b is_doubtful_;   ///< 1: what it proves is kPerhaps.
  cv::Mat1f reach_m_;       ///< Free depth, the least within the edge tolerance.
  cv::Mat1i fail_sum_;      ///< Integral picture of `fails_`.
  cv::Mat1i ground_sum_;    ///< Integral picture of where ground is predicted,
  cv::Mat1i doubt_sum_;     ///< and of what is kPerhaps.
  cv::Mat1i component_;     ///< Index into `things_`; 0: none.
  std::vector<Thing> things_;
  std::size_t first_bar_ = 0;  ///< From there on, `things_` are bars.
  cv::Mat1i thing_sum_;        ///< Integral picture of where a thing of known depth or a disguise shows.
  cv::Mat1i line_sum_;         ///< Of where a thin line may be, and
  cv::Mat1i trace_sum_;        ///< of where a trace of one shows.
  cv::Mat1i bar_sum_;          ///< And of where a bar shows whose foot is seen.
  std::optional<RangePyramid> free_;  ///< Of `reach_m_`; the greatest leaves out what fails.
};

}  // namespace soffit
