#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "service/facade/facade.h"
#include "service/scene/prediction.h"

namespace soffit {

/// Whether a pixel shows a thin line.
enum class LineMark : std::uint8_t {
  kNone,
  kTrace,  ///< It looks like one, as noise, texture and edges do; or one would not show, as at the horizon.
  kLine    ///< One that may hang or stand before the background.
};

struct ThinLine {
  std::vector<cv::Point2d> pixels;
  std::vector<cv::Point2d> extended;  ///< Beyond its ends, up to the model's edge if that is near.
  bool is_on_ground = false;          ///< Or before it.
};

/// Finds thin lines before background that may be cables, ropes or slim poles: they begin at the model's
/// edge, or are long and about upright. One picture does not tell them from what lies far behind. So the rays
/// of such a line prove nothing, and what stands where it may be has to be seen through by another picture
/// that shows not even a trace of a line there. Lines that the model interrupts lie behind it, and lines that
/// other pictures show at the same place of the ground, from elsewhere, are marks of the ground.
///
/// Lines are half a pixel to about seven pixels wide in pictures of up to 1600 pixels across; larger ones are
/// looked at in that size.
class ThinLines {
 public:
  /// All pictures are added before any is settled. Those that look down show no passages and are not
  /// searched.
  void Add(const Sight& sight, const Prediction& prediction);

  /// @param number  Of the picture, from 0 in the order of Add().
  /// @return A LineMark for each pixel; empty when it was not searched.
  cv::Mat1b Settle(std::size_t number) const;

 private:
  struct Picture {
    View view;
    double scale = 1.0;  ///< Pixels of the masks per pixel.
    std::vector<ThinLine> lines;
    cv::Mat1b clear;   ///< 255 on every clear ridge, also where no cable can be,
    cv::Mat1b traces;  ///< and about any ridge.
    cv::Mat1b ground;  ///< 255 where ground is predicted.
  };
  /// How another picture shows a place of the ground.
  enum class Shows { kNothing, kGround, kLine };

  static Shows Look(const Picture& picture, const Eigen::Vector3d& on_ground);
  bool IsMark(const Picture& picture, const ThinLine& line) const;

  std::vector<Picture> pictures_;
};

}  // namespace soffit
