#pragma once

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <cstdint>

namespace soffit::test {

/// Runs each of its tests once with every instruction set that this processor has: instantiate a class
/// derived from it over AllInstructionSets(), named by NameOfSet().
class WithInstructionSet : public ::testing::TestWithParam<std::int64_t> {
 protected:
  void SetUp() override { Use(GetParam()); }
  void TearDown() override { Use(0); }

 private:
  static void Use(std::int64_t targets) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().DeInit();
  }
};

inline auto AllInstructionSets() { return ::testing::ValuesIn(hwy::SupportedAndGeneratedTargets()); }

inline const char* NameOfSet(const ::testing::TestParamInfo<std::int64_t>& set) {
  return hwy::TargetName(set.param);
}

}  // namespace soffit::test
