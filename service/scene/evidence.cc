#include "service/scene/evidence.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "service/facade/median.h"
#include "service/scene/bar.h"
#include "service/scene/continuation.h"
#include "service/scene/ground_check.h"
#include "service/scene/labels.h"
#include "service/scene/thin_line.h"

namespace soffit {
namespace {

constexpr int kEdge_px = 2;     // How far a predicted edge and a seen one may lie apart.
constexpr int kMixed_px = 3;    // How far the colours of both sides of an edge mix: half the median filter.
constexpr int kHorizon_px = 6;  // Ground fades into sky.
constexpr int kMisfit_px = 6;   // Contradictions that stay so close to a predicted edge are no things.
constexpr int kMostMisfit_px = 40;
constexpr double kMisfitSigmas = 2.0;
constexpr int kMinThing_px = 20;
constexpr int kSeam_px = 3;          // Within which a model's edge is not looked at.
constexpr int kSameColor = 12;       // Of 255, in each channel.
constexpr double kShade = 0.6;       // Of the brightness that half of the ground has.
constexpr int kMinCovered_px = 12;   // Of the model: less does not tell that a thing is before it.
constexpr double kFootShare = 0.12;  // Of the depth of a thing's foot: how well it is known.

/// 1 where a pixel has this mark.
cv::Mat1b OnesWhere(const cv::Mat1b& lines, LineMark wanted) {
  cv::Mat1b ones;
  cv::compare(lines, static_cast<double>(wanted), ones, cv::CMP_EQ);
  cv::threshold(ones, ones, 0.0, 1.0, cv::THRESH_BINARY);
  return ones;
}

int Brightness(const cv::Vec3b& color) { return color[0] + color[1] + color[2]; }

double MedianGroundBrightness(const Sight& sight) {
  std::vector<double> values;
  for (int y = 0; y < sight.seen.rows; ++y) {
    for (int x = 0; x < sight.seen.cols; ++x) {
      if (sight.seen(y, x) == static_cast<uchar>(Seen::kGround))
        values.push_back(Brightness(sight.bgr(y, x)));
    }
  }
  return values.empty() ? 0.0 : Median(std::move(values));
}

/// How far the model's edges may lie beside the true ones.
int MisfitReach(const View& view, const Prediction& prediction) {
  double nearest = 0.0;
  cv::minMaxLoc(prediction.depth_m, &nearest);
  const double std_px =
      view.intrinsics.fx_px * (view.orientation_std_rad + view.position_std_m / std::max(0.5, nearest));
  return std::min(kMostMisfit_px, kMisfit_px + static_cast<int>(std::ceil(kMisfitSigmas * std_px)));
}

/// Number of a region's pixels that lie beside predicted background.
int Contact(const cv::Mat1i& regions, int region, const cv::Rect& bounds,
            const cv::Mat1b& beside_background) {
  int contact = 0;
  for (int y = bounds.y; y < bounds.y + bounds.height; ++y) {
    for (int x = bounds.x; x < bounds.x + bounds.width; ++x)
      contact += regions(y, x) == region && beside_background(y, x) != 0 ? 1 : 0;
  }
  return contact;
}

/// The first pixel of a region in the row of its middle.
cv::Point SomePixel(const cv::Mat1i& regions, int region, const cv::Rect& bounds) {
  for (int i = 0; i < bounds.height; ++i) {
    const int y = bounds.y + (bounds.height / 2 + i) % bounds.height;
    for (int x = bounds.x; x < bounds.x + bounds.width; ++x) {
      if (regions(y, x) == region) return {x, y};
    }
  }
  return bounds.tl();
}

/// What is before an opening may be coloured like ground or sky; it is no background where it goes on before
/// the model, farther than it is wide or than a wrong model would show background along its edge. 255 there
/// and wherever it goes on in the same colour.
cv::Mat1b FindDisguised(const Sight& sight, const Prediction& prediction) {
  const cv::Mat1b within = Shrink(Only(prediction.label, Seen::kStructure), kSeam_px);
  const cv::Mat1b background = Either(Only(sight.seen, Seen::kGround), Only(sight.seen, Seen::kSky));
  cv::Mat1b beside;
  cv::bitwise_not(within, beside);
  beside = Grow(beside, 1);
  cv::Mat1i regions;
  cv::Mat stats, centers;
  const int count =
      cv::connectedComponentsWithStats(Both(within, background), regions, stats, centers, 4, CV_32S);
  cv::Mat3b smooth;
  cv::GaussianBlur(sight.bgr, smooth, cv::Size(3, 3), 0.0);
  cv::Mat1b filled(sight.seen.rows + 2, sight.seen.cols + 2, uchar{0});  // With a border, as floodFill wants.
  for (int i = 1; i < count; ++i) {
    const int area = stats.at<int>(i, cv::CC_STAT_AREA);
    const cv::Rect bounds(stats.at<int>(i, cv::CC_STAT_LEFT), stats.at<int>(i, cv::CC_STAT_TOP),
                          stats.at<int>(i, cv::CC_STAT_WIDTH), stats.at<int>(i, cv::CC_STAT_HEIGHT));
    if (area < kMinThing_px) continue;
    const int contact = Contact(regions, i, bounds, beside);
    if (contact == 0 || area < contact * std::min(contact, kMisfit_px)) continue;
    cv::floodFill(smooth, filled, SomePixel(regions, i, bounds), cv::Scalar(), nullptr,
                  cv::Scalar::all(kSameColor), cv::Scalar::all(kSameColor),
                  4 | cv::FLOODFILL_FIXED_RANGE | cv::FLOODFILL_MASK_ONLY | 255 << 8);
  }
  return filled(cv::Rect(1, 1, sight.seen.cols, sight.seen.rows)).clone();
}

}  // namespace

Evidence::Evidence(const Sight& sight, const Prediction& prediction, const cv::Mat1b& votes,
                   const cv::Mat1b& lines, const Eigen::AlignedBox2d& region)
    : capture_id_(sight.capture_id),
      view_(sight.view),
      turn_(sight.view.map_from_camera.rotation.toRotationMatrix().transpose()) {
  SOFFIT_EXPECT(sight.seen.size() == prediction.label.size() && votes.size() == prediction.label.size() &&
                (lines.empty() || lines.size() == prediction.label.size()));
  is_doubtful_ = cv::Mat1b(sight.seen.size(), uchar{0});
  Compare(sight, prediction);
  is_disguised_ = FindDisguised(sight, prediction);
  fails_.setTo(1, is_disguised_);
  FindThings(sight, prediction, votes);
  FollowThingsDown(sight, prediction, region);
  if (!lines.empty()) fails_.setTo(1, OnesWhere(lines, LineMark::kLine));
  NoteUnconfirmedGround(sight, prediction, votes, region);
  const int edge = 2 * kEdge_px + 1;
  cv::Mat1f least;
  cv::erode(reach_m_, least, cv::getStructuringElement(cv::MORPH_RECT, cv::Size(edge, edge)));
  reach_m_ = least;
  SumUp(prediction, lines);
}

void Evidence::SumUp(const Prediction& prediction, const cv::Mat1b& lines) {
  cv::Mat1b is_ground;
  cv::threshold(Only(prediction.label, Seen::kGround), is_ground, 0.0, 1.0, cv::THRESH_BINARY);
  cv::Mat1b is_thing(component_.size(), uchar{0});
  std::transform(component_.begin(), component_.end(), is_thing.begin(), [&](int component) {
    return things_[static_cast<std::size_t>(component)].far_m > 0.0F ? uchar{1} : uchar{0};
  });
  is_thing.setTo(1, is_disguised_);
  if (!lines.empty()) {
    const cv::Mat1b is_line = OnesWhere(lines, LineMark::kLine);
    is_thing.setTo(1, is_line);
    cv::integral(is_line, line_sum_, CV_32S);
    cv::integral(Either(is_line, OnesWhere(lines, LineMark::kTrace)), trace_sum_, CV_32S);
  }
  cv::integral(fails_, fail_sum_, CV_32S);
  cv::integral(is_doubtful_, doubt_sum_, CV_32S);
  cv::integral(is_ground, ground_sum_, CV_32S);
  cv::integral(is_thing, thing_sum_, CV_32S);
  cv::Mat1b is_bar(component_.size(), uchar{0});
  std::transform(component_.begin(), component_.end(), is_bar.begin(), [&](int component) {
    const auto number = static_cast<std::size_t>(component);
    return number >= first_bar_ && things_[number].near_m > 0.0F ? uchar{1} : uchar{0};
  });
  cv::integral(is_bar, bar_sum_, CV_32S);
  cv::Mat1f free_m = reach_m_.clone();
  free_m.setTo(0.0F, fails_);
  free_.emplace(reach_m_, free_m);
}

void Evidence::Compare(const Sight& sight, const Prediction& prediction) {
  const cv::Mat1b structure = Only(prediction.label, Seen::kStructure);
  const cv::Mat1b ground = Only(prediction.label, Seen::kGround);
  const cv::Mat1b sky = Only(prediction.label, Seen::kSky);
  const double tilt_px = kMisfitSigmas * sight.view.intrinsics.fx_px * sight.view.orientation_std_rad;
  const int mixed_px = std::min(kHorizon_px, kEdge_px + static_cast<int>(std::ceil(tilt_px)));
  const cv::Mat1b edge =
      Either(Border(structure, kEdge_px + kMixed_px), Both(Grow(ground, mixed_px), Grow(sky, mixed_px)));
  const cv::Mat1b horizon = Both(Grow(ground, kHorizon_px), Grow(sky, kHorizon_px));
  const cv::Mat1b seen_ground = Only(sight.seen, Seen::kGround);
  const cv::Mat1b seen_sky = Only(sight.seen, Seen::kSky);
  cv::Mat1b agrees = Both(Only(sight.seen, Seen::kStructure), Grow(structure, kEdge_px));
  agrees = Either(agrees, Both(seen_ground, Either(Grow(ground, kEdge_px), horizon)));
  agrees = Either(agrees, Both(seen_sky, Either(Grow(sky, kEdge_px), horizon)));
  agrees = Either(agrees, Both(Only(sight.seen, Seen::kUnexplained), edge));  // Mixed pixels.
  cv::threshold(agrees, fails_, 0.0, 1.0, cv::THRESH_BINARY_INV);
  reach_m_ = prediction.depth_m.clone();
}

/// Tells how far each connected thing that was not predicted can be: before the nearest part of the model
/// that it covers, and where it meets the ground.
void Evidence::FindThings(const Sight& sight, const Prediction& prediction, const cv::Mat1b& votes) {
  cv::Mat stats, centers;
  cv::Mat1b is_strange = fails_.clone();
  is_strange.setTo(0, Border(Only(prediction.label, Seen::kStructure), MisfitReach(sight.view, prediction)));
  is_strange.setTo(
      0, Either(Only(sight.seen, Seen::kGround), Only(sight.seen, Seen::kSky)));  // The model's fault.
  const int count = cv::connectedComponentsWithStats(is_strange, component_, stats, centers, 8, CV_32S);
  struct Trace {
    std::vector<float> covered_m;  ///< Depths of the model that it covers.
    int foot_y = -1;
    int foot_x = 0;
    int on_ground = 0;  ///< Pixels that are ground, if nothing stands there,
    int denied = 0;     ///< and those where other pictures deny that.
  };
  std::vector<Trace> traces(static_cast<std::size_t>(count));
  for (int y = 0; y < component_.rows; ++y) {
    for (int x = 0; x < component_.cols; ++x) {
      if (component_(y, x) == 0) continue;
      Trace& trace = traces[static_cast<std::size_t>(component_(y, x))];
      const bool is_on_model = prediction.label(y, x) == static_cast<uchar>(Seen::kStructure);
      if (is_on_model) trace.covered_m.push_back(prediction.depth_m(y, x));
      trace.on_ground += prediction.label(y, x) == static_cast<uchar>(Seen::kGround) ? 1 : 0;
      trace.denied += votes(y, x) == static_cast<uchar>(GroundVote::kDenied) ? 1 : 0;
      const bool is_on_ground =
          y + 1 < component_.rows && sight.seen(y + 1, x) == static_cast<uchar>(Seen::kGround);
      if (is_on_ground) trace.foot_y = y, trace.foot_x = x;
    }
  }
  things_.assign(traces.size(), Thing{});
  for (int i = 1; i < count; ++i) {
    Trace& trace = traces[static_cast<std::size_t>(i)];
    Thing& thing = things_[static_cast<std::size_t>(i)];
    if (stats.at<int>(i, cv::CC_STAT_AREA) < kMinThing_px) continue;
    thing.is_raised = trace.denied >= kMinThing_px && 2 * trace.denied > trace.on_ground;
    if (trace.covered_m.size() >= kMinCovered_px) {
      thing.far_m = *std::max_element(trace.covered_m.begin(), trace.covered_m.end());
      continue;
    }
    const bool is_whole =
        trace.foot_y == stats.at<int>(i, cv::CC_STAT_TOP) + stats.at<int>(i, cv::CC_STAT_HEIGHT) - 1;
    const auto foot =
        MeetHorizontalPlane(view_, {static_cast<double>(trace.foot_x), trace.foot_y + 0.5}, 0.0);
    if (trace.foot_y < 0 || !is_whole || !foot) continue;
    const double depth_m = InCamera({foot->x(), foot->y(), 0.0}).z();
    const double width_m = stats.at<int>(i, cv::CC_STAT_WIDTH) * depth_m / view_.intrinsics.fx_px;
    thing.near_m = static_cast<float>((1.0 - kFootShare) * depth_m);
    thing.far_m = static_cast<float>((1.0 + kFootShare) * depth_m + width_m);
  }
  first_bar_ = things_.size();
  for (const Bar& bar : FindBars(sight, prediction)) {
    for (const cv::Rect& run : bar.runs_px) {
      fails_(run).setTo(1);
      component_(run).setTo(static_cast<int>(things_.size()));
    }
    things_.push_back({bar.near_m, bar.far_m});
  }
}

/// A thing may end at far ground because it goes on in the ground's colours. These prove nothing then; nor do
/// they in other pictures, if it stands within the region or before the model.
void Evidence::FollowThingsDown(const Sight& sight, const Prediction& prediction,
                                const Eigen::AlignedBox2d& region) {
  cv::Mat1b strange(component_.size(), uchar{0});
  std::vector<int> area(things_.size(), 0);
  for (const int component : component_) ++area[static_cast<std::size_t>(component)];
  std::transform(component_.begin(), component_.end(), strange.begin(), [&](int component) {
    return component != 0 && area[static_cast<std::size_t>(component)] >= kMinThing_px ? uchar{255}
                                                                                       : uchar{0};
  });
  for (const Continuation& body : FollowDown(sight, strange, MisfitReach(sight.view, prediction))) {
    const auto is_within = [&](const Continuation::Row& row) {
      const auto ground = MeetHorizontalPlane(view_, {0.5 * (row.left + row.right), row.y + 0.5}, 0.0);
      return ground && region.contains(*ground);
    };
    if (is_within(body.rows.front())) continue;
    const bool is_near = body.meets_structure || is_within(body.rows.back());
    for (const Continuation::Row& row : body.rows) {
      const cv::Rect covered(row.left, row.y, row.right - row.left + 1, 1);
      fails_(covered) = 1;
      if (is_near) is_disguised_(covered) = 255;
    }
  }
}

void Evidence::NoteUnconfirmedGround(const Sight& sight, const Prediction& prediction, const cv::Mat1b& votes,
                                     const Eigen::AlignedBox2d& region) {
  const Intrinsics& k = view_.intrinsics;
  const Eigen::Matrix3d rotation = view_.map_from_camera.rotation.toRotationMatrix();
  const int darkest = static_cast<int>(kShade * MedianGroundBrightness(sight));
  for (int y = 0; y < fails_.rows; ++y) {
    for (int x = 0; x < fails_.cols; ++x) {
      if (prediction.label(y, x) != static_cast<uchar>(Seen::kGround) ||
          votes(y, x) == static_cast<uchar>(GroundVote::kConfirmed))
        continue;
      const Eigen::Vector3d in_camera((x - k.cx_px) / k.fx_px, (y - k.cy_px) / k.fy_px, 1.0);
      const Eigen::Vector3d place = camera_in_map_m() + rotation * (prediction.depth_m(y, x) * in_camera);
      if (region.contains(place.head<2>()) || Brightness(sight.bgr(y, x)) < darkest) is_doubtful_(y, x) = 1;
    }
  }
}

std::optional<cv::Point> Evidence::PixelAt(const Eigen::Vector3d& point_in_camera_m) const {
  const Eigen::Vector3d& p = point_in_camera_m;
  if (!(p.z() > 0.0)) return std::nullopt;
  const Intrinsics& k = view_.intrinsics;
  const cv::Point at(static_cast<int>(std::lround(k.fx_px * p.x() / p.z() + k.cx_px)),
                     static_cast<int>(std::lround(k.fy_px * p.y() / p.z() + k.cy_px)));
  if (at.x < 0 || at.y < 0 || at.x >= component_.cols || at.y >= component_.rows) return std::nullopt;
  return at;
}

bool Evidence::ShowsThingAt(const Eigen::Vector3d& point_in_map_m) const {
  const Eigen::Vector3d p = InCamera(point_in_map_m);
  const auto pixel = PixelAt(p);
  if (!pixel) return false;
  return things_[static_cast<std::size_t>(component_(*pixel))].MayBeAt(p.z());
}

bool Evidence::ShowsBarWithin(const Eigen::Vector3d& center_in_map_m, double radius_m) const {
  const std::optional<Target> target = About(center_in_map_m, radius_m);
  if (!target || Count(bar_sum_, target->window) == 0) return false;
  const double depth_m = InCamera(center_in_map_m).z();
  const Window& w = target->window;
  for (int y = w.y0; y <= w.y1; ++y) {
    for (int x = w.x0; x <= w.x1; ++x) {
      const auto number = static_cast<std::size_t>(component_(y, x));
      if (number < first_bar_) continue;
      const Thing& bar = things_[number];
      if (bar.near_m > 0.0F && depth_m + radius_m >= bar.near_m && depth_m - radius_m <= bar.far_m)
        return true;
    }
  }
  return false;
}

bool Evidence::ShowsLineWithin(const Eigen::Vector3d& center_in_map_m, double radius_m) const {
  const std::optional<Target> target = About(center_in_map_m, radius_m);
  return target && MayShowLines() && Count(line_sum_, target->window) > 0;
}

bool Evidence::ShowsTraceWithin(const Eigen::Vector3d& center_in_map_m, double radius_m) const {
  const std::optional<Target> target = About(center_in_map_m, radius_m);
  return target && MayShowLines() && Count(trace_sum_, target->window) > 0;
}

bool Evidence::DistrustsColorAt(const Eigen::Vector3d& point_in_map_m) const {
  const Eigen::Vector3d p = InCamera(point_in_map_m);
  const auto pixel = PixelAt(p);
  if (!pixel) return false;
  const Thing& thing = things_[static_cast<std::size_t>(component_(*pixel))];
  return is_disguised_(*pixel) != 0 || (thing.is_raised && thing.MayBeAt(p.z()));
}

std::optional<Evidence::Target> Evidence::About(const Eigen::Vector3d& center_in_map_m,
                                                double radius_m) const {
  const Eigen::Vector3d p = InCamera(center_in_map_m);
  if (p.z() <= 2.0 * radius_m) return std::nullopt;
  const Intrinsics& k = view_.intrinsics;
  const double x = k.fx_px * p.x() / p.z() + k.cx_px;
  const double y = k.fy_px * p.y() / p.z() + k.cy_px;
  const double half_x = k.fx_px * radius_m / (p.z() - radius_m);
  const double half_y = k.fy_px * radius_m / (p.z() - radius_m);
  if (!(x - half_x >= 0.0 && y - half_y >= 0.0 && x + half_x <= fails_.cols - 1 &&
        y + half_y <= fails_.rows - 1)) {
    return std::nullopt;
  }
  return Target{{static_cast<int>(std::floor(x - half_x)), static_cast<int>(std::ceil(x + half_x)),
                 static_cast<int>(std::floor(y - half_y)), static_cast<int>(std::ceil(y + half_y))},
                static_cast<float>(p.z() - 0.5 * radius_m)};
}

int Evidence::Count(const cv::Mat1i& sum, const Window& w) {
  return sum(w.y1 + 1, w.x1 + 1) - sum(w.y0, w.x1 + 1) - sum(w.y1 + 1, w.x0) + sum(w.y0, w.x0);
}

Evidence::Sees Evidence::SeeThrough(const Eigen::Vector3d& center_in_map_m, double radius_m) const {
  const std::optional<Target> target = About(center_in_map_m, radius_m);
  if (!target || Count(fail_sum_, target->window) > 0) return Sees::kNothing;
  const Window& w = target->window;
  for (const int row : {w.y0, (w.y0 + w.y1) / 2, w.y1}) {
    for (const int column : {w.x0, (w.x0 + w.x1) / 2, w.x1}) {
      if (reach_m_(row, column) < target->beyond_m) return Sees::kNothing;
    }
  }
  if (Count(doubt_sum_, w) > 0) return Sees::kPerhaps;
  return Count(ground_sum_, w) > 0 ? Sees::kLikely : Sees::kSure;
}

bool Evidence::SeesPartly(const Eigen::Vector3d& center_in_map_m, double radius_m) const {
  const std::optional<Target> target = About(center_in_map_m, radius_m);
  if (!target) return false;
  const Window& w = target->window;
  for (const int row : {w.y0, (w.y0 + w.y1) / 2, w.y1}) {
    for (const int column : {w.x0, (w.x0 + w.x1) / 2, w.x1}) {
      if (fails_(row, column) == 0 && reach_m_(row, column) >= target->beyond_m) return true;
    }
  }
  return false;
}

Evidence::Window Evidence::Cover(const Eigen::Vector3d& center_in_camera_m, double radius_m) const {
  const Intrinsics& k = view_.intrinsics;
  const double depth_m = center_in_camera_m.z();
  const double x = center_in_camera_m.x() / depth_m;
  const double y = center_in_camera_m.y() / depth_m;
  const double half_x = std::hypot(1.0, x) * radius_m / (depth_m - radius_m);
  const double half_y = std::hypot(1.0, y) * radius_m / (depth_m - radius_m);
  const auto pixel = [](double at) { return static_cast<int>(std::clamp(at, -1e6, 1e6)); };
  return {pixel(std::floor(k.fx_px * (x - half_x) + k.cx_px)),
          pixel(std::ceil(k.fx_px * (x + half_x) + k.cx_px)),
          pixel(std::floor(k.fy_px * (y - half_y) + k.cy_px)),
          pixel(std::ceil(k.fy_px * (y + half_y) + k.cy_px))};
}

std::optional<Evidence::Sees> Evidence::SeesAlike(const Eigen::Vector3d& center_in_map_m,
                                                  double radius_m) const {
  const Eigen::Vector3d p = InCamera(center_in_map_m);
  const double near_m = p.z() - radius_m;
  const double far_m = p.z() + radius_m;
  if (far_m <= 0.0) return Sees::kNothing;
  if (near_m <= radius_m) return std::nullopt;
  const Window w = Cover(p, radius_m);
  if (w.x1 < 0 || w.y1 < 0 || w.x0 >= fails_.cols || w.y0 >= fails_.rows) return Sees::kNothing;
  if (w.x0 < 0 || w.y0 < 0 || w.x1 >= fails_.cols || w.y1 >= fails_.rows) return std::nullopt;
  const RangePyramid::Range free_m = free_->Bound(w.x0, w.y0, w.x1, w.y1);
  if (free_m.greatest < near_m && Count(thing_sum_, w) == 0) return Sees::kNothing;
  if (free_m.least < far_m || Count(fail_sum_, w) > 0 || Count(doubt_sum_, w) > 0 ||
      (MayShowLines() && Count(trace_sum_, w) > 0))
    return std::nullopt;
  const int ground = Count(ground_sum_, w);
  if (ground == 0) return Sees::kSure;
  return ground == (w.x1 - w.x0 + 1) * (w.y1 - w.y0 + 1) ? std::optional(Sees::kLikely) : std::nullopt;
}

}  // namespace soffit
