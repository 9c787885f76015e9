#include "shared/options/options.h"

#include <gmock/gmock.h>

#include <limits>

namespace soffit {
namespace {

using ::testing::HasSubstr;

struct Inner {
  double ratio = 0.5;
  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("ratio", self.ratio, OptionInfo{0.0, 1.0, "", "A share"});
  }
};

struct Outer {
  int count = 3;
  Inner inner;
  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("count", self.count, OptionInfo{1, 10, "pieces", "How many"});
    field("inner", self.inner);
  }
};

TEST(FindOptionProblem, FindsNothingInTheDefaults) { EXPECT_TRUE(IsValidOptions(Outer{})); }

TEST(FindOptionProblem, NamesTheFieldItsValueAndItsBounds) {
  Outer options;
  options.count = 11;
  EXPECT_EQ(FindOptionProblem(options), "count is 11 pieces, must be from 1 to 10");
}

TEST(FindOptionProblem, RefusesNaNInANestedField) {
  Outer options;
  options.inner.ratio = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(FindOptionProblem(options), HasSubstr("inner.ratio is nan"));
}

}  // namespace
}  // namespace soffit
