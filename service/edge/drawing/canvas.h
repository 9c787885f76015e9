#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "shared/capture/capture.h"

namespace soffit {

/// Colours that colour-blind people can tell apart, also on grey (Okabe and Ito 2008), as OpenCV takes them
/// (BGR).
namespace ink {
inline const cv::Scalar kBlack(0, 0, 0);
inline const cv::Scalar kWhite(255, 255, 255);
inline const cv::Scalar kGrey(120, 120, 120);
inline const cv::Scalar kPale(225, 225, 225);
inline const cv::Scalar kOrange(0, 159, 230);
inline const cv::Scalar kSky(233, 180, 86);
inline const cv::Scalar kGreen(115, 158, 0);
inline const cv::Scalar kYellow(66, 228, 240);
inline const cv::Scalar kBlue(178, 114, 0);
inline const cv::Scalar kVermilion(0, 94, 213);
inline const cv::Scalar kPurple(167, 121, 204);
}  // namespace ink

/// How a line looks. Solid and dashed lines stay apart without colour too.
struct Stroke {
  cv::Scalar color = ink::kBlack;
  double width_px = 2.0;
  bool is_dashed = false;
  bool is_cased = true;  ///< With a thin border that sets it off from any ground.
};

struct LegendEntry {
  Stroke stroke;
  std::string text;
};

using PixelLine = std::vector<Eigen::Vector2d>;

/// A picture to draw on. Sizes are given for a picture of 1280 pixels' width and grow with the picture.
class Canvas {
 public:
  explicit Canvas(const cv::Mat3b& picture);

  void DrawLine(const PixelLine& line, const Stroke& stroke, bool is_closed = false);
  void DrawArrow(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Stroke& stroke);
  void DrawDot(const Eigen::Vector2d& center, double radius_px, const cv::Scalar& color);
  void Fill(const std::vector<PixelLine>& rings, const cv::Scalar& color, double opacity);
  /// Text on a plate that keeps inside the picture; `anchor` is the middle of its lower edge.
  void DrawLabel(const Eigen::Vector2d& anchor, const std::string& text,
                 const cv::Scalar& color = ink::kBlack, double size = 1.0);

  void Write(const cv::Point& left_of_baseline, const std::string& text, int font, double scale,
             int thickness);

  double unit_px() const { return unit_; }
  cv::Size size() const { return picture_.size(); }
  const cv::Mat3b& picture() const { return picture_; }

 private:
  cv::Mat3b picture_;
  double unit_;
};

/// A picture and what there is to say about it.
struct Drawing {
  cv::Mat3b picture;
  std::string title;
  std::vector<std::string> lines;
  std::vector<LegendEntry> legend;
};

/// The picture above a white strip with title, text and legend, so that these hide nothing.
cv::Mat3b AddCaption(const Drawing& drawing);

/// Pictures of any size side by side at the same height.
cv::Mat3b PlaceSideBySide(const std::vector<cv::Mat3b>& pictures, int height_px);

/// What of a line in the map lies before the camera, in pixels: none or more connected pieces.
std::vector<PixelLine> ProjectLine(const View& view, const std::vector<Eigen::Vector3d>& line_in_map_m,
                                   bool is_closed);

/// The part of a planar polygon that lies before the camera, in pixels; empty when none does.
PixelLine ProjectPolygon(const View& view, const std::vector<Eigen::Vector3d>& ring_in_map_m);

/// A number for people: "1.65".
std::string FormatNumber(double value, int decimals);

}  // namespace soffit
