#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "service/facade/facade.h"
#include "service/scene/prediction.h"

namespace soffit {

/// What other pictures say of a pixel that is ground, if nothing stands before it.
enum class GroundVote : std::uint8_t {
  kNone,       ///< None shows its place from elsewhere.
  kConfirmed,  ///< At least one shows the same there.
  kDenied      ///< More of them show something else.
};

/// Whether two cameras see a place of the ground from directions so different that what stands or hangs
/// before it in one does not do so in the other: more than 20 degrees apart and, as an upright thing looks
/// alike from above and below, 15 degrees of azimuth, unless one looks down steeply.
bool SeeFromElsewhere(const Eigen::Vector3d& camera_in_map_m, const Eigen::Vector3d& other_in_map_m,
                      const Eigen::Vector3d& place_in_map_m);

struct GroundPicture;  ///< What is kept of a picture for comparison.

/// Compares what the pictures show of the ground by laying each over every other along the ground plane (the
/// plane sweep of R. Collins, 1996, for one plane). What lies on the ground looks alike in all of them,
/// shadows and marks included; what stands on it or hangs above it does not. Exposures are matched by the
/// median over all that two pictures share.
class GroundCheck {
 public:
  GroundCheck();
  ~GroundCheck();

  /// All pictures are added before any is settled. Of each only a small copy is kept.
  void Add(const Sight& sight, const Prediction& prediction);

  /// A pixel that is coloured like ground becomes kUnexplained when more pictures show something else at its
  /// place of the ground than agree with it from another direction. An unexplained pixel becomes kGround when
  /// at least two pictures from other directions agree with it and none shows something else. What no other
  /// picture shows stays as it is.
  ///
  /// @param number  Of the picture, from 0 in the order of Add(); sight and prediction are the same again.
  /// @return A GroundVote for each pixel.
  cv::Mat1b Settle(std::size_t number, const Prediction& prediction, Sight& sight) const;

 private:
  std::vector<GroundPicture> pictures_;
};

}  // namespace soffit
