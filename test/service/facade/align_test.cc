#include "service/facade/align.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "test/support/painted_world.h"

namespace soffit {
namespace {

using test::Arch;
using test::Look;

TEST(AlignSights, BringsNoisyPosesBackToTheBuilding) {
  const std::vector<View> views = {test::FromSouth(), test::FromNorth()};
  std::vector<View> reported = views;
  for (View& view : reported) {
    view.position_std_m = 0.08;
    view.orientation_std_rad = 0.014;
  }
  reported[0].map_from_camera.translation_m += Eigen::Vector3d(0.06, -0.05, 0.07);
  reported[1].map_from_camera.rotation =
      Eigen::AngleAxisd(0.015, Eigen::Vector3d(0.6, 0.5, 0.62).normalized()) *
      reported[1].map_from_camera.rotation;
  const auto seeing = Look(views, {Arch{}.thing()}, reported);
  const Alignment aligned = AlignSights(Arch{}.footprint(), seeing.masks, seeing.sights, {});
  EXPECT_NEAR(aligned.footprint.height_m, 2.3, 0.05);
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (const Eigen::Vector3d& corner : {Eigen::Vector3d(-2.0, 0.0, 0.0), Eigen::Vector3d(2.0, 0.0, 2.3)}) {
      const Eigen::Vector2d truly = *Project(views[i], corner);
      // The building itself is moved by the common part of the errors.
      const Eigen::Vector2d shift =
          aligned.footprint.polygon_in_map_m.outer[0] - Eigen::Vector2d(-2.0, -0.75);
      const Eigen::Vector2d now =
          *Project(aligned.sights[i].view, corner + Eigen::Vector3d(shift.x(), shift.y(), 0.0));
      EXPECT_LT((now - truly).norm(), 3.0);
    }
  }
}

/// A box as it is traced from above: the convex hull of its corners.
Silhouette Trace(const View& view, const Ring& ring, double height_m) {
  std::vector<cv::Point2f> corners, hull;
  for (const double z : {0.0, height_m}) {
    for (const Eigen::Vector2d& p : ring) {
      const Eigen::Vector2d pixel = *Project(view, {p.x(), p.y(), z});
      corners.emplace_back(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
    }
  }
  cv::convexHull(corners, hull);
  Silhouette silhouette;
  silhouette.view = view;
  for (const cv::Point2f& p : hull) silhouette.outline.polygon_px.outer.emplace_back(p.x, p.y);
  if (SignedArea(silhouette.outline.polygon_px.outer) < 0.0)
    std::reverse(silhouette.outline.polygon_px.outer.begin(), silhouette.outline.polygon_px.outer.end());
  return silhouette;
}

View FromAbove(const Eigen::Vector3d& position_m) {
  View view;
  view.intrinsics = {640, 480, 440.0, 440.0, 319.5, 239.5, {}};
  view.map_from_camera = {CameraAttitude(0.3, -0.5 * M_PI), position_m};
  return view;
}

/// Three pictures from above, whose places are reported with errors that cancel.
Footprint SeenFromAbove(const Ring& ring, double height_m, const std::vector<Eigen::Vector3d>& errors_m) {
  Footprint box;
  box.height_m = height_m;
  box.polygon_in_map_m.outer = ring;
  const std::vector<Eigen::Vector3d> places = {{-2.0, 1.0, 8.0}, {2.5, 0.5, 9.0}, {0.5, -2.0, 8.5}};
  for (std::size_t i = 0; i < places.size(); ++i) {
    box.silhouettes.push_back(Trace(FromAbove(places[i]), ring, height_m));
    View& view = box.silhouettes.back().view;
    view.map_from_camera.translation_m += errors_m[i];
    view.position_std_m = 0.2;
    view.orientation_std_rad = 0.005;
  }
  return box;
}

const Ring kBox = test::Box(-1.5, -1.0, 1.5, 1.0);

TEST(AlignSights, SharesTheErrorsOfPicturesFromAbove) {
  Footprint box = SeenFromAbove(kBox, 2.0, {{0.2, 0.1, 0.1}, {-0.3, 0.1, -0.1}, {0.1, -0.2, 0.0}});
  for (Eigen::Vector2d& corner : box.polygon_in_map_m.outer) corner += Eigen::Vector2d(0.2, -0.15);
  const Footprint adjusted = AlignSights(box, {}, {}, {}).footprint;
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_LT((adjusted.polygon_in_map_m.outer[i] - kBox[i]).norm(), 0.04) << i;
  EXPECT_NEAR(adjusted.height_m, 2.0, 0.05);
}

TEST(AlignSights, TellsThatThePlaceIsNoBetterThanThePoses) {
  const Footprint adjusted =
      AlignSights(SeenFromAbove(kBox, 2.0, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}), {}, {}, {}).footprint;
  for (const double std : adjusted.corner_std_m) {
    EXPECT_GT(std, 0.2 / std::sqrt(3.0) * 0.8);
    EXPECT_LT(std, 0.2);
  }
}

TEST(AlignSights, FindsAHeightThatIsNotKnown) {
  Footprint box = SeenFromAbove(kBox, 2.0, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}});
  box.height_m = 0.0;
  EXPECT_NEAR(AlignSights(box, {}, {}, {}).footprint.height_m, 2.0, 0.1);
  box.height_m = 0.3;
  box.height_std_m = 0.4;
  EXPECT_NEAR(AlignSights(box, {}, {}, {}).footprint.height_m, 2.0, 0.1);
}

TEST(AlignSights, LeavesABuildingWithoutHeightAndOutlinesAsItWas) {
  Footprint box;
  box.polygon_in_map_m.outer = kBox;
  EXPECT_EQ(AlignSights(box, {}, {}, {}).footprint.polygon_in_map_m.outer, kBox);
}

}  // namespace
}  // namespace soffit
