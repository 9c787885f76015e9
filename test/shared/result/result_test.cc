#include "shared/result/result.h"

#include <gtest/gtest.h>

namespace soffit {
namespace {

double InverseOf(double x) {
  SOFFIT_EXPECT(x != 0.0);
  return 1.0 / x;
}

TEST(Result, HoldsEitherAValueOrAnError) {
  const Result<int> value = 7;
  EXPECT_TRUE(value.ok());
  EXPECT_EQ(value.value(), 7);
  const Result<int> failed = InvalidInput("a.yaml:3: radius_m: must be positive");
  EXPECT_FALSE(failed.ok());
  EXPECT_EQ(failed.error().code, Error::Code::kInvalidInput);
}

TEST(Result, ThrowsRatherThanGiveAValueThatIsNotThere) {
  const Result<int> failed = InvalidInput("no");
  EXPECT_THROW(failed.value(), std::bad_variant_access);
}

TEST(SoffitExpect, NamesTheFunctionAndTheBrokenCondition) {
  EXPECT_DOUBLE_EQ(InverseOf(4.0), 0.25);
  try {
    InverseOf(0.0);
    FAIL();
  } catch (const ContractViolation& violation) {
    EXPECT_STREQ(violation.what(), "InverseOf: x != 0.0");
  }
}

}  // namespace
}  // namespace soffit
