#include "service/footprint/wireframe.h"

#include <gtest/gtest.h>

namespace soffit {
namespace {

using Eigen::Vector3d;

const Ring kBox = {{0, 0}, {4, 0}, {4, 2}, {0, 2}};

Massing Mansard() {
  return {{kBox, {{1, 0.5}, {1, 1.5}, {2, 1.5}, {2, 0.5}}},
          {{2.0, {0, 0, 0, 0}}, {3.0, {0.3, 0.2, 0.3, 0}}},
          {{false, false, false, false}, {true, true, true, false}}};
}

/// All corners as numbers.
Eigen::VectorXd Places(const Massing& massing) {
  const Wireframe frame = FrameOf(massing);
  Eigen::VectorXd places(static_cast<Eigen::Index>(3 * frame.corners.size()));
  for (std::size_t i = 0; i < frame.corners.size(); ++i)
    places.segment<3>(static_cast<Eigen::Index>(3 * i)) = frame.corners[i].in_map_m;
  return places;
}

TEST(FrameOf, TellsHowItsCornersMoveWithEveryParameter) {
  const Massing massing = Mansard();
  const Layout layout(massing);
  ASSERT_EQ(layout.size, 2 * 8 + 2 + 3);
  const Wireframe frame = FrameOf(massing);
  Eigen::MatrixXd by =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(3 * frame.corners.size()), layout.size);
  for (std::size_t i = 0; i < frame.corners.size(); ++i) {
    for (const auto& [parameter, moved] : frame.corners[i].by)
      by.block<3, 1>(static_cast<Eigen::Index>(3 * i), parameter) += moved;
  }
  constexpr double kStep = 1e-4;
  for (Eigen::Index p = 0; p < layout.size; ++p) {
    const Eigen::VectorXd change = kStep * Eigen::VectorXd::Unit(layout.size, p);
    const Eigen::VectorXd moved = (Places(Changed(massing, change)) - Places(massing)) / kStep;
    EXPECT_LT((moved - by.col(p)).cwiseAbs().maxCoeff(), 1e-3) << "parameter " << p;
  }
}

TEST(Cover, LeavesTheCourtyardOpen) {
  View view;
  view.intrinsics = {640, 480, 300.0, 300.0, 320.0, 240.0, {}};
  view.map_from_camera = {CameraAttitude(0.0, -std::acos(0.0)), {2.0, 1.0, 9.0}};
  const Cover cover(FrameOf(Mansard()), view);
  EXPECT_FALSE(cover.Contains(*Project(view, {1.5, 1.0, 0.0})));
  EXPECT_TRUE(cover.Contains(*Project(view, {3.0, 1.0, 0.0})));
  EXPECT_FALSE(cover.Contains(*Project(view, {-1.5, 1.0, 0.0})));
}

}  // namespace
}  // namespace soffit
