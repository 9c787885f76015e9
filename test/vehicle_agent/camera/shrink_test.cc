#include "vehicle_agent/camera/shrink.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/support/test_jpeg.h"
#include "vehicle_agent/camera/jpeg.h"

namespace soffit {
namespace {

Capture MakeCapture() {
  Capture capture;
  capture.intrinsics = {640, 480, 500.0, 510.0, 319.5, 200.0, {-0.1, 0.01, 0.0, 0.0, 0.0}};
  capture.bytes = MakeNoiseJpeg(640, 480);
  return capture;
}

TEST(ShrinkCapture, LeavesAloneWhatFits) {
  const Capture capture = MakeCapture();
  const Capture same = ShrinkCapture(capture, capture.bytes.size(), 10).value();
  EXPECT_EQ(same.bytes, capture.bytes);
  EXPECT_EQ(same.intrinsics.width_px, 640);
}

TEST(ShrinkCapture, FitsThePictureWithTheLensOfItsNewSize) {
  const Capture capture = MakeCapture();
  const std::size_t full = ShrinkCapture(capture, capture.bytes.size() - 1, 70).value().bytes.size();
  const Capture smaller = ShrinkCapture(capture, full - 1, 70).value();
  const JpegInfo info = CheckJpeg(smaller.bytes).value();
  EXPECT_LT(smaller.bytes.size(), full);
  EXPECT_EQ(info.width_px, 480);
  EXPECT_EQ(info.height_px, 360);
  EXPECT_EQ(smaller.intrinsics.width_px, 480);
  EXPECT_EQ(smaller.intrinsics.height_px, 360);
  EXPECT_DOUBLE_EQ(smaller.intrinsics.fx_px, 375.0);
  EXPECT_DOUBLE_EQ(smaller.intrinsics.fy_px, 382.5);
  EXPECT_DOUBLE_EQ(smaller.intrinsics.cx_px, 239.5) << "the middle stays the middle";
  EXPECT_DOUBLE_EQ(smaller.intrinsics.cy_px, 200.5 * 0.75 - 0.5);
  EXPECT_EQ(smaller.intrinsics.distortion, capture.intrinsics.distortion);
}

TEST(ShrinkCapture, GivesTheSmallestWhenNothingFits) {
  const Capture smallest = ShrinkCapture(MakeCapture(), 1, 50).value();
  EXPECT_EQ(CheckJpeg(smallest.bytes).value().width_px, 160);
  EXPECT_EQ(smallest.intrinsics.width_px, 160);
}

TEST(ShrinkCapture, RefusesWhatCannotBeDecoded) {
  Capture capture = MakeCapture();
  capture.bytes.assign(1000, 7);
  EXPECT_THAT(ShrinkCapture(capture, 10, 50).error().message, testing::HasSubstr("cannot be made smaller"));
}

}  // namespace
}  // namespace soffit
