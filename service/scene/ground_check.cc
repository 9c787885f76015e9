#include "service/scene/ground_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "shared/result/result.h"

namespace soffit {
namespace {

constexpr int kMaxWidth_px = 800;  // Pictures are compared at no more.
constexpr double kLevels = 60.0;   // Per unit of the natural logarithm of brightness: 8 bits hold all of it.
constexpr double kDarkest = 4.0;  // Added to a brightness of 0 to 255, so that noise in the dark weighs less.
constexpr int kMaxDispute = 13;   // Levels: 0.22 of the logarithm.
constexpr int kMinDisputed_px = 5;  // Of the 25 about a pixel: single ones are noise, a rope makes a line.
constexpr int kMinCommon_px = 400;  // That two pictures must share to be compared.
constexpr std::array<int, 4> kReaches_px = {2, 4, 8,
                                            14};  // By which two pictures may lie beside each other; worse
constexpr double kReachSigmas = 1.5;              // known places are not compared.
constexpr double kOtherDirection =
    0.94;  // Cosine (20 degrees): views that are nearer to each other see a thing alike.
constexpr double kSameAzimuth = 0.966;  // Cosine (15 degrees): they see an upright thing alike,
constexpr double kSteep = 0.82;         // unless one looks down steeply (sine).

}  // namespace

/// The logarithm of its colours, at a size that all have about.
struct GroundPicture {
  double scale = 1.0;  ///< Small pixels per pixel.
  cv::Mat3b logs;
  cv::Mat1b ground;                   ///< 255 where ground is predicted and no building is seen.
  Eigen::Matrix3d pixel_from_ground;  ///< Homogeneous; the third coordinate is the depth.
  Eigen::Matrix3d ground_from_pixel;
  Eigen::Vector3d camera_m;
  double focal_px = 0.0;
  double position_std_m = 0.0;
  double orientation_std_rad = 0.0;
};

namespace {

cv::Mat3b Logarithm(const cv::Mat3b& bgr) {
  cv::Mat1b table(1, 256);
  for (int value = 0; value < 256; ++value) {
    table(0, value) = cv::saturate_cast<uchar>(kLevels * std::log((value + kDarkest) / kDarkest));
  }
  cv::Mat3b logs;
  cv::LUT(bgr, table, logs);
  return logs;
}

GroundPicture Shrink(const Sight& sight, const Prediction& prediction) {
  GroundPicture small;
  const cv::Size full = sight.bgr.size();
  small.scale = std::min(1.0, static_cast<double>(kMaxWidth_px) / full.width);
  const cv::Size size(std::max(1, static_cast<int>(std::lround(full.width * small.scale))),
                      std::max(1, static_cast<int>(std::lround(full.height * small.scale))));
  cv::Mat3b bgr;
  cv::resize(sight.bgr, bgr, size, 0.0, 0.0, cv::INTER_AREA);
  cv::GaussianBlur(bgr, bgr, cv::Size(3, 3), 0.0);
  small.logs = Logarithm(bgr);
  cv::Mat1b may_be_ground;
  cv::compare(prediction.label, static_cast<double>(Seen::kGround), may_be_ground, cv::CMP_EQ);
  may_be_ground.setTo(0, sight.seen == static_cast<uchar>(Seen::kStructure));
  cv::Mat1b shown(full, uchar{0});
  may_be_ground(sight.shown).copyTo(shown(sight.shown));
  cv::resize(shown, small.ground, size, 0.0, 0.0, cv::INTER_NEAREST);

  const Pose<Camera, Map> camera_from_map = sight.view.map_from_camera.Inverse();
  const Eigen::Matrix3d rotation = camera_from_map.rotation.toRotationMatrix();
  Eigen::Matrix3d camera_from_ground;
  camera_from_ground << rotation.col(0), rotation.col(1), camera_from_map.translation_m;
  const Intrinsics& k = sight.view.intrinsics;
  const double s = small.scale;  // Pixel centres are at integer coordinates.
  Eigen::Matrix3d pixel_from_camera;
  pixel_from_camera << s * k.fx_px, 0.0, s * (k.cx_px + 0.5) - 0.5, 0.0, s * k.fy_px,
      s * (k.cy_px + 0.5) - 0.5, 0.0, 0.0, 1.0;
  small.pixel_from_ground = pixel_from_camera * camera_from_ground;
  small.ground_from_pixel = small.pixel_from_ground.inverse();
  small.camera_m = sight.view.map_from_camera.translation_m;
  small.focal_px = s * k.fx_px;
  small.position_std_m = sight.view.position_std_m;
  small.orientation_std_rad = sight.view.orientation_std_rad;
  return small;
}

/// Another picture laid over this one along the ground.
struct Overlay {
  cv::Mat3b logs;
  cv::Mat1b is_known;      ///< 255 where the other picture shows this place of the ground.
  cv::Mat1b is_elsewhere;  ///< 255 where it sees it from another direction.
  cv::Mat1b reach;         ///< Index into `kReaches_px`: how far it may lie beside.
  int blur_px = 1;         ///< How many pixels of this picture one of the other covers.
};

/// By how many pixels of `base` the place of a point of the ground is uncertain between the two pictures.
double Misfit_px(const GroundPicture& other, const GroundPicture& base, const Eigen::Vector3d& from,
                 const Eigen::Vector3d& to) {
  const double base_m = from.norm();
  const double other_m = to.norm();
  const double fall = std::max(1e-3, to.z() / other_m);  // A flat ray meets the ground the farther off.
  const double along_m = other.position_std_m + other_m * other.orientation_std_rad / fall;
  const double cross = std::abs(from.x() * to.y() - from.y() * to.x()) /
                       std::max(1e-9, from.head<2>().norm() * to.head<2>().norm());
  const double seen_m = along_m * std::max(cross, from.z() / base_m) + other.position_std_m +
                        other_m * other.orientation_std_rad;
  return base.focal_px * (base.orientation_std_rad + (base.position_std_m + seen_m) / base_m);
}

Overlay Lay(const GroundPicture& other, const GroundPicture& base) {
  Overlay overlay;
  const cv::Size size = base.logs.size();
  cv::Mat2f source(size, cv::Vec2f(-1e4F, -1e4F));
  overlay.is_elsewhere = cv::Mat1b(size, uchar{0});
  overlay.reach = cv::Mat1b(size, uchar{0});
  std::vector<float> coarseness;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      if (base.ground(y, x) == 0) continue;
      Eigen::Vector3d place = base.ground_from_pixel * Eigen::Vector3d(x, y, 1.0);
      place /= place.z();
      const Eigen::Vector3d pixel = other.pixel_from_ground * place;
      if (!(pixel.z() > 0.0)) continue;
      source(y, x) = {static_cast<float>(pixel.x() / pixel.z()), static_cast<float>(pixel.y() / pixel.z())};
      const Eigen::Vector3d ground(place.x(), place.y(), 0.0);
      const double misfit_px =
          kReachSigmas * Misfit_px(other, base, base.camera_m - ground, other.camera_m - ground);
      std::size_t reach = 0;
      while (reach + 1 < kReaches_px.size() && kReaches_px[reach] < kReaches_px[0] + misfit_px) ++reach;
      if (kReaches_px[reach] < misfit_px) source(y, x) = {-1e4F, -1e4F};
      overlay.reach(y, x) = static_cast<uchar>(reach);
      if (SeeFromElsewhere(base.camera_m, other.camera_m, ground)) overlay.is_elsewhere(y, x) = 255;
    }
  }
  cv::remap(other.logs, overlay.logs, source, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  cv::remap(other.ground, overlay.is_known, source, cv::noArray(), cv::INTER_NEAREST, cv::BORDER_CONSTANT);
  for (int y = 1; y + 1 < size.height; y += 8) {
    for (int x = 1; x + 1 < size.width; x += 8) {
      if (overlay.is_known(y, x) == 0 || overlay.is_known(y + 1, x) == 0 || overlay.is_known(y, x + 1) == 0)
        continue;
      const cv::Vec2f down = source(y + 1, x) - source(y, x);
      const cv::Vec2f right = source(y, x + 1) - source(y, x);
      coarseness.push_back(
          static_cast<float>(1.0 / std::max(1e-3, std::min(cv::norm(down), cv::norm(right)))));
    }
  }
  if (!coarseness.empty()) {
    const auto middle = coarseness.begin() + static_cast<std::ptrdiff_t>(coarseness.size() / 2);
    std::nth_element(coarseness.begin(), middle, coarseness.end());
    overlay.blur_px = std::clamp(static_cast<int>(std::lround(*middle)), 1, 15) | 1;
  }
  return overlay;
}

/// Least and greatest of a picture's known pixels about each pixel.
struct Range {
  cv::Mat3b low;
  cv::Mat3b high;
};

Range RangeAbout(const Overlay& overlay, int reach) {
  const cv::Mat window = cv::getStructuringElement(cv::MORPH_RECT, cv::Size(2 * reach + 1, 2 * reach + 1));
  cv::Mat1b is_unknown;
  cv::compare(overlay.is_known, 0.0, is_unknown, cv::CMP_EQ);
  Range range{overlay.logs.clone(), overlay.logs.clone()};
  range.low.setTo(cv::Scalar::all(255), is_unknown);
  range.high.setTo(cv::Scalar::all(0), is_unknown);
  cv::erode(range.low, range.low, window);
  cv::dilate(range.high, range.high, window);
  return range;
}

/// By how much brighter this picture was exposed, in levels: the median over what both show, for each
/// channel.
std::array<int, 3> MedianGain(const cv::Mat3b& logs, const Overlay& overlay, int& common) {
  std::array<std::array<int, 511>, 3> histogram{};
  common = 0;
  for (int y = 0; y < logs.rows; ++y) {
    for (int x = 0; x < logs.cols; ++x) {
      if (overlay.is_known(y, x) == 0) continue;
      ++common;
      for (int c = 0; c < 3; ++c) {
        ++histogram[static_cast<std::size_t>(c)]
                   [static_cast<std::size_t>(logs(y, x)[c] - overlay.logs(y, x)[c] + 255)];
      }
    }
  }
  std::array<int, 3> gain{};
  for (std::size_t c = 0; c < 3; ++c) {
    int below = 0;
    while (gain[c] < 510 && below + histogram[c][static_cast<std::size_t>(gain[c])] <= common / 2) {
      below += histogram[c][static_cast<std::size_t>(gain[c]++)];
    }
    gain[c] -= 255;
  }
  return gain;
}

/// 1 where this picture shows something else than the other does anywhere about that place.
cv::Mat1b FindDisputed(const cv::Mat3b& logs, const Overlay& overlay, const std::array<int, 3>& gain) {
  std::array<Range, kReaches_px.size()> ranges;
  cv::Mat1b disputed(logs.size(), uchar{0});
  for (int y = 0; y < logs.rows; ++y) {
    for (int x = 0; x < logs.cols; ++x) {
      if (overlay.is_known(y, x) == 0) continue;
      int apart = 0;
      Range& range = ranges[overlay.reach(y, x)];
      if (range.low.empty()) range = RangeAbout(overlay, kReaches_px[overlay.reach(y, x)]);
      for (int c = 0; c < 3; ++c) {
        const int value = logs(y, x)[c] - gain[static_cast<std::size_t>(c)];
        apart = std::max({apart, range.low(y, x)[c] - value, value - range.high(y, x)[c]});
      }
      if (apart > kMaxDispute) disputed(y, x) = 1;
    }
  }
  cv::Mat1b around, lone;
  cv::boxFilter(disputed, around, CV_8U, cv::Size(5, 5), cv::Point(-1, -1), false, cv::BORDER_CONSTANT);
  cv::compare(around, static_cast<double>(kMinDisputed_px), lone, cv::CMP_LT);
  disputed.setTo(0, lone);
  return disputed;
}

/// How many pictures agree with a pixel, seen from another direction, and how many show something else.
struct Votes {
  cv::Mat1b agree;
  cv::Mat1b differ;
};

void Compare(const GroundPicture& base, const GroundPicture& other, Votes& votes) {
  const Overlay overlay = Lay(other, base);
  cv::Mat3b logs = base.logs;
  if (overlay.blur_px > 1) cv::blur(base.logs, logs, cv::Size(overlay.blur_px, overlay.blur_px));
  int common = 0;
  const std::array<int, 3> gain = MedianGain(logs, overlay, common);
  if (common < kMinCommon_px) return;
  const cv::Mat1b disputed = FindDisputed(logs, overlay, gain);
  for (int y = 0; y < disputed.rows; ++y) {
    for (int x = 0; x < disputed.cols; ++x) {
      if (overlay.is_known(y, x) == 0) continue;
      if (disputed(y, x) != 0) {
        ++votes.differ(y, x);
      } else if (overlay.is_elsewhere(y, x) != 0) {
        ++votes.agree(y, x);
      }
    }
  }
}

GroundVote Count(int agree, int differ) {
  if (differ > agree) return GroundVote::kDenied;
  return agree > 0 ? GroundVote::kConfirmed : GroundVote::kNone;
}

/// Relabels the picture by the votes, and tells for each pixel how they went.
cv::Mat1b Relabel(const Votes& votes, double scale, const Prediction& prediction, Sight& sight) {
  constexpr int kEnough = 2;
  cv::Mat1b told(sight.seen.size(), uchar{0});
  for (int y = 0; y < sight.seen.rows; ++y) {
    const int row =
        std::clamp(static_cast<int>(std::lround((y + 0.5) * scale - 0.5)), 0, votes.agree.rows - 1);
    for (int x = 0; x < sight.seen.cols; ++x) {
      if (prediction.label(y, x) != static_cast<uchar>(Seen::kGround)) continue;
      const int column =
          std::clamp(static_cast<int>(std::lround((x + 0.5) * scale - 0.5)), 0, votes.agree.cols - 1);
      const int agree = votes.agree(row, column);
      const int differ = votes.differ(row, column);
      const GroundVote vote = Count(agree, differ);
      told(y, x) = static_cast<uchar>(vote);
      uchar& seen = sight.seen(y, x);
      if (seen == static_cast<uchar>(Seen::kGround) && vote == GroundVote::kDenied)
        seen = static_cast<uchar>(Seen::kUnexplained);
      const bool is_mark = seen == static_cast<uchar>(Seen::kUnexplained) && agree >= kEnough && differ == 0;
      if (is_mark) seen = static_cast<uchar>(Seen::kGround);
    }
  }
  return told;
}

}  // namespace

bool SeeFromElsewhere(const Eigen::Vector3d& camera_in_map_m, const Eigen::Vector3d& other_in_map_m,
                      const Eigen::Vector3d& place_in_map_m) {
  const Eigen::Vector3d from = (camera_in_map_m - place_in_map_m).normalized();
  const Eigen::Vector3d to = (other_in_map_m - place_in_map_m).normalized();
  const double level = from.head<2>().norm() * to.head<2>().norm();
  const bool is_steep = std::max(from.z(), to.z()) > kSteep;
  return from.dot(to) < kOtherDirection &&
         (is_steep || from.head<2>().dot(to.head<2>()) < kSameAzimuth * level);
}

GroundCheck::GroundCheck() = default;
GroundCheck::~GroundCheck() = default;

void GroundCheck::Add(const Sight& sight, const Prediction& prediction) {
  pictures_.push_back(Shrink(sight, prediction));
}

cv::Mat1b GroundCheck::Settle(std::size_t number, const Prediction& prediction, Sight& sight) const {
  SOFFIT_EXPECT(number < pictures_.size());
  const GroundPicture& picture = pictures_[number];
  Votes votes{cv::Mat1b(picture.ground.size(), uchar{0}), cv::Mat1b(picture.ground.size(), uchar{0})};
  for (std::size_t other = 0; other < pictures_.size(); ++other) {
    if (other != number) Compare(picture, pictures_[other], votes);
  }
  return Relabel(votes, picture.scale, prediction, sight);
}

}  // namespace soffit
