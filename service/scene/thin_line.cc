#include "service/scene/thin_line.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

#include "service/scene/ground_check.h"
#include "service/scene/labels.h"
#include "service/scene/ridge.h"
#include "shared/result/result.h"

namespace soffit {
namespace {

constexpr double kMaxWidth_px = 1600.0;
constexpr double kDownward = -0.9;   // Of the optical axis' rise.
constexpr int kBeside_px = 3;        // Of the model's edge, where colours mix.
constexpr int kHorizon_px = 6;       // Ground fades into sky.
constexpr double kSameLine = 0.995;  // Cosine between the parts of a line that the model interrupts.
constexpr double kLeastHidden_px = 10.0;
constexpr double kBesideShare = 0.03;  // Of the way between the parts.
constexpr double kStraight = 0.97;     // Cosine to what is level or upright.
constexpr std::size_t kLeastPixels = 12;
constexpr double kLeastLong = 0.03;       // Over the picture's width, of what begins at the model,
constexpr double kLeastUpright = 0.045;   // and of what stands free.
constexpr double kLeastUnseen_px = 12.0;  // By which a line may go on unseen; or by half its length.
constexpr int kFaintEnd_px = 10;
constexpr double kOnGround = 0.9;     // Of a line's pixels.
constexpr double kReach_px = 2.0;     // By which a mark may lie beside in another picture,
constexpr double kReachSigmas = 2.0;  // and by its pose.
constexpr double kMostReach_px = 16.0;
constexpr double kKnown = 0.5;  // Of a mark's pixels that others show,
constexpr double kShown = 0.6;  // and of these, that are lines there.
constexpr double kThick_px = 3.0;
constexpr int kTrace_px = 1;

cv::Point Round(const cv::Point2d& pixel) {
  return {static_cast<int>(std::lround(pixel.x)), static_cast<int>(std::lround(pixel.y))};
}

cv::Rect Square(const cv::Point& middle, int reach) {
  return {middle.x - reach, middle.y - reach, 2 * reach + 1, 2 * reach + 1};
}

/// Ridges of the whole picture, found in a smaller one.
std::vector<Ridge> FindRidgesInSmaller(const cv::Mat1b& picture, double scale) {
  cv::Mat1b small = picture;
  if (scale < 1.0) cv::resize(picture, small, cv::Size(), scale, scale, cv::INTER_AREA);
  std::vector<Ridge> ridges = FindRidges(small);
  const cv::Point2d middle(0.5, 0.5);
  for (Ridge& ridge : ridges) {
    for (cv::Point& pixel : ridge.pixels) pixel = Round((cv::Point2d(pixel) + middle) / scale - middle);
    for (cv::Point2d& end : ridge.ends_px) end = (end + middle) / scale - middle;
  }
  return ridges;
}

/// Where a picture may show what hangs or stands before background.
class Backdrop {
 public:
  Backdrop(const Sight& sight, const Prediction& prediction)
      : shown_(sight.shown),
        label_(prediction.label),
        model_(Grow(Only(label_, Seen::kStructure), kBeside_px)),
        horizon_(Both(Grow(Only(label_, Seen::kGround), kHorizon_px),
                      Grow(Only(label_, Seen::kSky), kHorizon_px))) {}

  /// Whether the model hides a part of the ridge, and it goes on beyond: it lies behind.
  bool IsInterrupted(const Ridge& ridge, const std::vector<Ridge>& others, double pixel) const {
    return std::any_of(others.begin(), others.end(), [&](const Ridge& other) {
      if (!other.is_clear || std::abs(ridge.along.dot(other.along)) < kSameLine) return false;
      const bool is_after = (other.ends_px[0] - ridge.ends_px[0]).dot(ridge.along) > 0.0;
      const cv::Point2d& end = ridge.ends_px[is_after ? 1 : 0];
      const bool is_first_nearer = cv::norm(other.ends_px[0] - end) < cv::norm(other.ends_px[1] - end);
      const cv::Point2d& begin = other.ends_px[is_first_nearer ? 0 : 1];
      const double away_px = (begin - end).dot(ridge.along) * (is_after ? 1.0 : -1.0);
      const double beside_px = std::abs((begin - end).cross(ridge.along));
      return away_px > kLeastHidden_px * pixel && beside_px < kBeside_px * pixel + kBesideShare * away_px &&
             IsHidden(end, begin) && Keep(other).size() >= kLeastPixels;
    });
  }

  /// 255 where no line would show, were there one.
  const cv::Mat1b& Horizon() const { return horizon_; }

  /// None when the ridge is too short, or neither upright nor from one edge of the model to another: where it
  /// shows before ground alone, one end at the model is not enough.
  std::optional<ThinLine> Pick(const Ridge& ridge) const {
    ThinLine line;
    line.pixels = Keep(ridge);
    int held = 0;  // Ends at the model.
    const double most_px = std::max(kLeastUnseen_px, ridge.length_px() / 2.0);
    for (const auto& [end, step] :
         {std::pair(ridge.ends_px[0], -ridge.along), {ridge.ends_px[1], ridge.along}}) {
      std::vector<cv::Point2d> way = ReachModel(end, step, most_px);
      held += way.empty() ? 0 : 1;
      if (way.empty()) way = Walk(end, step, kFaintEnd_px);
      line.extended.insert(line.extended.end(), way.begin(), way.end());
    }
    line.is_on_ground = AreOnGround(line.pixels);
    const double length = ridge.length_px() / label_.cols;
    const bool is_upright = std::abs(ridge.along.y) > kStraight;
    if (line.pixels.size() < kLeastPixels || length < (held == 0 ? kLeastUpright : kLeastLong))
      return std::nullopt;
    if (!is_upright && held < (line.is_on_ground ? 2 : 1)) return std::nullopt;
    return line;
  }

 private:
  std::vector<cv::Point2d> Keep(const Ridge& ridge) const {
    const bool is_level = std::abs(ridge.along.x) > kStraight;
    std::vector<cv::Point2d> kept;
    for (const cv::Point& pixel : ridge.pixels) {
      const bool is_horizon = is_level && horizon_(pixel) != 0;
      if (shown_.contains(pixel) && model_(pixel) == 0 && !is_horizon) kept.emplace_back(pixel);
    }
    return kept;
  }

  /// The end of a line is fainter than its middle.
  std::vector<cv::Point2d> Walk(cv::Point2d at, const cv::Point2d& step, int steps) const {
    std::vector<cv::Point2d> way;
    for (int i = 0; i < steps && shown_.contains(Round(at)); ++i, at += step) way.push_back(at);
    return way;
  }

  /// Whether most of what is between two places is the model.
  bool IsHidden(const cv::Point2d& from, const cv::Point2d& to) const {
    const int steps = static_cast<int>(cv::norm(to - from));
    int hidden = 0;
    for (int i = 0; i < steps; ++i) {
      const cv::Point pixel = Round(from + (to - from) * (static_cast<double>(i) / steps));
      if (cv::Rect({}, label_.size()).contains(pixel))
        hidden += label_(pixel) == static_cast<uchar>(Seen::kStructure) ? 1 : 0;
    }
    return 2 * hidden > steps;
  }

  bool AreOnGround(const std::vector<cv::Point2d>& pixels) const {
    const auto count = std::count_if(pixels.begin(), pixels.end(), [&](const cv::Point2d& pixel) {
      return label_(Round(pixel)) == static_cast<uchar>(Seen::kGround);
    });
    return static_cast<double>(count) > kOnGround * static_cast<double>(pixels.size());
  }

  /// Pixels from the end of a ridge on to the model's edge; none when it is too far.
  std::vector<cv::Point2d> ReachModel(cv::Point2d at, const cv::Point2d& step, double most_px) const {
    std::vector<cv::Point2d> way;
    for (; static_cast<double>(way.size()) <= most_px; at += step) {
      if (!shown_.contains(Round(at))) return {};
      way.push_back(at);
      if (label_(Round(at)) == static_cast<uchar>(Seen::kStructure)) return way;
    }
    return {};
  }

  cv::Rect shown_;
  cv::Mat1b label_;
  cv::Mat1b model_;
  cv::Mat1b horizon_;
};

}  // namespace

void ThinLines::Add(const Sight& sight, const Prediction& prediction) {
  SOFFIT_EXPECT(sight.bgr.size() == prediction.label.size());
  Picture& picture = pictures_.emplace_back();
  picture.view = sight.view;
  if ((sight.view.map_from_camera.rotation * Eigen::Vector3d::UnitZ()).z() < kDownward) return;
  picture.scale = std::min(1.0, kMaxWidth_px / sight.bgr.cols);
  cv::resize(Only(prediction.label, Seen::kGround), picture.ground, cv::Size(), picture.scale, picture.scale,
             cv::INTER_NEAREST);
  picture.clear = cv::Mat1b(picture.ground.size(), uchar{0});
  cv::Mat1b grey;
  cv::cvtColor(sight.bgr, grey, cv::COLOR_BGR2GRAY);
  const Backdrop backdrop(sight, prediction);
  cv::resize(backdrop.Horizon(), picture.traces, picture.ground.size(), 0.0, 0.0, cv::INTER_NEAREST);
  const cv::Rect all({}, picture.ground.size());
  for (const double scale : {picture.scale, picture.scale / 2.0}) {
    const std::vector<Ridge> ridges = FindRidgesInSmaller(grey, scale);
    for (const Ridge& ridge : ridges) {
      for (const cv::Point& pixel : ridge.pixels) {
        const cv::Point at = Round(cv::Point2d(pixel) * picture.scale);
        picture.traces(Square(at, kTrace_px) & all) = 255;
        if (ridge.is_clear) picture.clear(Square(at, 0) & all) = 255;
      }
    }
    for (const Ridge& ridge : ridges) {
      if (!ridge.is_clear) continue;
      const Ridge joined = JoinRidges(ridge, ridges, 1.0 / scale);
      if (backdrop.IsInterrupted(joined, ridges, 1.0 / scale)) continue;
      if (auto line = backdrop.Pick(joined)) picture.lines.push_back(std::move(*line));
    }
  }
}

ThinLines::Shows ThinLines::Look(const Picture& picture, const Eigen::Vector3d& on_ground) {
  const auto pixel = Project(picture.view, on_ground);
  if (!pixel || picture.clear.empty()) return Shows::kNothing;
  const cv::Point at = Round({pixel->x() * picture.scale, pixel->y() * picture.scale});
  if (!cv::Rect({}, picture.ground.size()).contains(at) || picture.ground(at) == 0) return Shows::kNothing;
  const double away_m = (picture.view.map_from_camera.translation_m - on_ground).norm();
  const double std_px = picture.scale * picture.view.intrinsics.fx_px *
                        (picture.view.orientation_std_rad + picture.view.position_std_m / away_m);
  const int reach = static_cast<int>(std::min(kMostReach_px, kReach_px + kReachSigmas * std_px));
  const cv::Rect about = Square(at, reach) & cv::Rect({}, picture.clear.size());
  return cv::countNonZero(picture.clear(about)) > 0 ? Shows::kLine : Shows::kGround;
}

bool ThinLines::IsMark(const Picture& picture, const ThinLine& line) const {
  if (!line.is_on_ground) return false;
  const Eigen::Vector3d& camera_m = picture.view.map_from_camera.translation_m;
  int known = 0;
  int shown = 0;
  for (const cv::Point2d& pixel : line.pixels) {
    const auto place = MeetHorizontalPlane(picture.view, {pixel.x, pixel.y}, 0.0);
    if (!place) continue;
    const Eigen::Vector3d on_ground(place->x(), place->y(), 0.0);
    Shows best = Shows::kNothing;
    for (const Picture& other : pictures_) {
      if (SeeFromElsewhere(camera_m, other.view.map_from_camera.translation_m, on_ground))
        best = std::max(best, Look(other, on_ground));
    }
    known += best != Shows::kNothing ? 1 : 0;
    shown += best == Shows::kLine ? 1 : 0;
  }
  return known >= kKnown * static_cast<double>(line.pixels.size()) && shown >= kShown * known;
}

cv::Mat1b ThinLines::Settle(std::size_t number) const {
  SOFFIT_EXPECT(number < pictures_.size());
  const Picture& picture = pictures_[number];
  if (picture.traces.empty()) return {};
  const Intrinsics& k = picture.view.intrinsics;
  cv::Mat1b marks(cv::Size(k.width_px, k.height_px), static_cast<uchar>(LineMark::kNone));
  cv::Mat1b traces;
  cv::resize(picture.traces, traces, marks.size(), 0.0, 0.0, cv::INTER_NEAREST);
  marks.setTo(static_cast<uchar>(LineMark::kTrace), traces);
  const int reach = static_cast<int>(std::lround(kThick_px / picture.scale)) / 2;
  for (const ThinLine& line : picture.lines) {
    if (IsMark(picture, line)) continue;
    for (const auto* pixels : {&line.pixels, &line.extended}) {
      for (const cv::Point2d& pixel : *pixels)
        marks(Square(Round(pixel), reach) & cv::Rect({}, marks.size())) = static_cast<uchar>(LineMark::kLine);
    }
  }
  return marks;
}

}  // namespace soffit
