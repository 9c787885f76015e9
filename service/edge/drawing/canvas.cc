#include "service/edge/drawing/canvas.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <sstream>

namespace soffit {
namespace {

constexpr int kShift = 4;  // Fractional bits of OpenCV's drawing coordinates.
constexpr double kFarOutside_px = 1e5;
constexpr double kNear_m = 0.05;
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontScale = 0.5;

cv::Point Fixed(const Eigen::Vector2d& p) {
  const auto fixed = [](double v) {
    return static_cast<int>(std::lround(std::clamp(v, -kFarOutside_px, kFarOutside_px) * (1 << kShift)));
  };
  return {fixed(p.x()), fixed(p.y())};
}

cv::Point ToPixel(const Eigen::Vector2d& p) { return {cvRound(p.x()), cvRound(p.y())}; }

/// The pieces of a line that dashes show, each `dash_px` long with a gap of the same length.
std::vector<PixelLine> CutToDashes(const PixelLine& line, double dash_px) {
  std::vector<PixelLine> dashes;
  double done_px = 0.0;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const double length_px = std::min((line[i + 1] - line[i]).norm(), kFarOutside_px);
    const Eigen::Vector2d along =
        length_px > 0.0 ? Eigen::Vector2d((line[i + 1] - line[i]) / length_px) : Eigen::Vector2d::Zero();
    for (double t = 0.0; t < length_px;) {
      const double phase = std::fmod(done_px + t, 2.0 * dash_px);
      const double step = std::min(length_px - t, (phase < dash_px ? dash_px : 2.0 * dash_px) - phase + 1e-6);
      if (phase < dash_px) dashes.push_back({line[i] + t * along, line[i] + (t + step) * along});
      t += step;
    }
    done_px += length_px;
  }
  return dashes;
}

void Polyline(cv::Mat3b& picture, const PixelLine& line, const cv::Scalar& color, double width_px,
              bool is_closed) {
  std::vector<cv::Point> points;
  for (const Eigen::Vector2d& p : line) points.push_back(Fixed(p));
  cv::polylines(picture, points, is_closed, color, std::max(1, cvRound(width_px)), cv::LINE_AA, kShift);
}

}  // namespace

Canvas::Canvas(const cv::Mat3b& picture)
    : picture_(picture.clone()), unit_(std::max(0.5, picture.cols / 1280.0)) {}

void Canvas::DrawLine(const PixelLine& line, const Stroke& stroke, bool is_closed) {
  if (line.size() < 2) return;
  PixelLine whole = line;
  if (is_closed && stroke.is_dashed) whole.push_back(line.front());
  const std::vector<PixelLine> pieces =
      stroke.is_dashed ? CutToDashes(whole, 9.0 * unit_) : std::vector<PixelLine>{whole};
  const bool closes = is_closed && !stroke.is_dashed;
  if (stroke.is_cased) {
    const cv::Scalar casing = stroke.color == ink::kBlack ? ink::kWhite : ink::kBlack;
    for (const PixelLine& piece : pieces)
      Polyline(picture_, piece, casing, (stroke.width_px + 2.0) * unit_, closes);
  }
  for (const PixelLine& piece : pieces)
    Polyline(picture_, piece, stroke.color, stroke.width_px * unit_, closes);
}

void Canvas::DrawArrow(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Stroke& stroke) {
  const double length_px = (to - from).norm();
  if (!(length_px > 1.0)) return;
  const Eigen::Vector2d along = (to - from) / length_px;
  const Eigen::Vector2d across(-along.y(), along.x());
  const double head_px = std::min(length_px, (6.0 + 3.0 * stroke.width_px) * unit_);
  const Eigen::Vector2d neck = to - head_px * along;
  DrawLine({from, neck}, stroke);
  const PixelLine head = {to, neck + 0.5 * head_px * across, neck - 0.5 * head_px * across};
  Fill({head}, stroke.color, 1.0);
  Polyline(picture_, head, ink::kBlack, 1.0, true);
}

void Canvas::DrawDot(const Eigen::Vector2d& center, double radius_px, const cv::Scalar& color) {
  const auto radius = static_cast<int>(std::lround(radius_px * unit_ * (1 << kShift)));
  cv::circle(picture_, Fixed(center), radius + (1 << kShift), ink::kBlack, cv::FILLED, cv::LINE_AA, kShift);
  cv::circle(picture_, Fixed(center), radius, color, cv::FILLED, cv::LINE_AA, kShift);
}

void Canvas::Fill(const std::vector<PixelLine>& rings, const cv::Scalar& color, double opacity) {
  std::vector<std::vector<cv::Point>> contours;
  cv::Rect box;
  for (const PixelLine& ring : rings) {
    if (ring.size() < 3) continue;
    std::vector<cv::Point> contour;
    for (const Eigen::Vector2d& p : ring) contour.push_back(Fixed(p));
    const cv::Rect around = cv::boundingRect(contour);
    box |= cv::Rect((around.x >> kShift) - 1, (around.y >> kShift) - 1, (around.width >> kShift) + 3,
                    (around.height >> kShift) + 3);
    contours.push_back(std::move(contour));
  }
  box &= cv::Rect({0, 0}, picture_.size());
  if (contours.empty() || box.empty()) return;
  for (std::vector<cv::Point>& contour : contours) {
    for (cv::Point& p : contour) p -= box.tl() * (1 << kShift);
  }
  cv::Mat3b ground = picture_(box);
  cv::Mat3b painted = ground.clone();
  cv::fillPoly(painted, contours, color, cv::LINE_AA, kShift);
  cv::addWeighted(painted, opacity, ground, 1.0 - opacity, 0.0, ground);
}

void Canvas::Write(const cv::Point& left_of_baseline, const std::string& text, int font, double scale,
                   int thickness) {
  cv::putText(picture_, text, left_of_baseline, font, scale, ink::kBlack, thickness, cv::LINE_AA);
}

void Canvas::DrawLabel(const Eigen::Vector2d& anchor, const std::string& text, const cv::Scalar& color,
                       double size) {
  const double scale = size * kFontScale * std::max(1.0, unit_);
  const int thickness = std::max(1, cvRound(1.2 * size * unit_));
  int baseline = 0;
  const cv::Size extent = cv::getTextSize(text, kFont, scale, thickness, &baseline);
  const int pad = cvRound(4 * unit_);
  cv::Rect plate(ToPixel(anchor) - cv::Point(extent.width / 2 + pad, extent.height + baseline + 2 * pad),
                 extent + cv::Size(2 * pad, baseline + 2 * pad));
  plate.x = std::clamp(plate.x, 0, std::max(0, picture_.cols - plate.width));
  plate.y = std::clamp(plate.y, 0, std::max(0, picture_.rows - plate.height));
  const cv::Rect seen = plate & cv::Rect({0, 0}, picture_.size());
  if (seen.empty()) return;
  cv::Mat3b ground = picture_(seen);
  cv::addWeighted(ground, 0.15, cv::Mat3b(ground.size(), cv::Vec3b(255, 255, 255)), 0.85, 0.0, ground);
  cv::rectangle(picture_, seen, color, std::max(1, cvRound(1.5 * unit_)));
  Write(plate.tl() + cv::Point(pad, pad + extent.height), text, kFont, scale, thickness);
}

namespace {

std::vector<std::string> Wrap(const std::vector<std::string>& lines, double scale, int thickness,
                              int width_px) {
  std::vector<std::string> wrapped;
  const auto fits = [&](const std::string& text) {
    int baseline = 0;
    return cv::getTextSize(text, kFont, scale, thickness, &baseline).width <= width_px;
  };
  for (const std::string& line : lines) {
    std::istringstream words(line);
    std::string row;
    for (std::string word; words >> word;) {
      const std::string longer = row.empty() ? word : row + " " + word;
      if (!row.empty() && !fits(longer)) {
        wrapped.push_back(row);
        row = "    " + word;
      } else {
        row = longer;
      }
    }
    wrapped.push_back(row);
  }
  return wrapped;
}

}  // namespace

cv::Mat3b AddCaption(const Drawing& drawing) {
  const auto& [picture, title, lines, legend] = drawing;
  const double unit = std::max(0.7, picture.cols / 1280.0);
  const double scale = kFontScale * unit;
  const int thickness = std::max(1, cvRound(unit));
  const int line_px = cvRound(24 * unit);
  const int column_px = cvRound(300 * unit);
  const int columns = std::max(1, (picture.cols - line_px) / column_px);
  const std::vector<std::string> rows = Wrap(lines, scale, thickness, picture.cols - line_px);
  const int legend_rows = (static_cast<int>(legend.size()) + columns - 1) / columns;
  const int strip_px = line_px * (2 + static_cast<int>(rows.size()) + legend_rows);
  cv::Mat3b sheet(picture.rows + strip_px, picture.cols, cv::Vec3b(255, 255, 255));
  picture.copyTo(sheet(cv::Rect({0, 0}, picture.size())));
  Canvas canvas(sheet);

  const int left = line_px / 2;
  int y = picture.rows + line_px;
  canvas.Write({left, y}, title, cv::FONT_HERSHEY_DUPLEX, 1.1 * scale, thickness);
  for (const std::string& row : rows) canvas.Write({left, y += line_px}, row, kFont, scale, thickness);
  for (std::size_t i = 0; i < legend.size(); ++i) {
    const int row_y = y + line_px * (static_cast<int>(i) / columns + 1);
    const int x = left + static_cast<int>(i) % columns * column_px;
    const double middle_y = row_y - 0.25 * line_px;
    canvas.DrawLine({{x, middle_y}, {x + 1.4 * line_px, middle_y}}, legend[i].stroke);
    canvas.Write({x + 2 * line_px, row_y}, legend[i].text, kFont, scale, thickness);
  }
  return canvas.picture();
}

cv::Mat3b PlaceSideBySide(const std::vector<cv::Mat3b>& pictures, int height_px) {
  std::vector<cv::Mat> scaled;
  for (const cv::Mat3b& picture : pictures) {
    const int width_px = std::max(1, cvRound(picture.cols * static_cast<double>(height_px) / picture.rows));
    cv::Mat one;
    cv::resize(picture, one, {width_px, height_px}, 0, 0, cv::INTER_AREA);
    if (!scaled.empty()) scaled.emplace_back(height_px, std::max(2, height_px / 60), CV_8UC3, ink::kWhite);
    scaled.push_back(one);
  }
  cv::Mat3b row;
  cv::hconcat(scaled, row);
  return row;
}

std::vector<PixelLine> ProjectLine(const View& view, const std::vector<Eigen::Vector3d>& line_in_map_m,
                                   bool is_closed) {
  const Eigen::Vector3d forward = view.map_from_camera.rotation * Eigen::Vector3d::UnitZ();
  const auto depth_m = [&](const Eigen::Vector3d& p) {
    return forward.dot(p - view.map_from_camera.translation_m) - kNear_m;
  };
  std::vector<PixelLine> pieces;
  const std::size_t n = line_in_map_m.size();
  for (std::size_t i = 0; i + (is_closed ? 0 : 1) < n; ++i) {
    Eigen::Vector3d a = line_in_map_m[i];
    Eigen::Vector3d b = line_in_map_m[(i + 1) % n];
    const double da = depth_m(a);
    const double db = depth_m(b);
    if (da <= 0.0 && db <= 0.0) continue;
    if (da <= 0.0) a += (b - a) * (da / (da - db));
    if (db <= 0.0) b += (a - b) * (db / (db - da));
    const auto pa = Project(view, a);
    const auto pb = Project(view, b);
    if (!pa || !pb) continue;
    if (pieces.empty() || pieces.back().back() != *pa) pieces.push_back({*pa});
    pieces.back().push_back(*pb);
  }
  return pieces;
}

PixelLine ProjectPolygon(const View& view, const std::vector<Eigen::Vector3d>& ring_in_map_m) {
  PixelLine polygon;
  for (const PixelLine& piece : ProjectLine(view, ring_in_map_m, true)) {
    polygon.insert(polygon.end(), piece.begin(), piece.end());
  }
  return polygon;
}

std::string FormatNumber(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

}  // namespace soffit
