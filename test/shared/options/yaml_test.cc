#include "shared/options/yaml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace soffit {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

struct Corner {
  double east_m = 0.0;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("east_m", self.east_m, OptionInfo{-100.0, 100.0, "m", ""});
  }
};

struct Inner {
  int tries = 3;
  bool loud = false;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("tries", self.tries, OptionInfo{1, 9, "", "How often"});
    field("loud", self.loud, OptionInfo{});
  }
};

struct Sample {
  double speed_mps = 2.0;
  std::string name = "a \"quoted\" name";
  std::vector<double> weights = {0.5, 1.0};
  std::vector<std::string> colors = {"red"};
  Inner inner;
  std::vector<Corner> corners;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("speed_mps", self.speed_mps, OptionInfo{0.1, 20.0, "m/s", "Greatest speed"});
    field("name", self.name, OptionInfo{});
    field("weights", self.weights, OptionInfo{0.0, 1.0, "", ""});
    field("colors", self.colors, OptionInfo{});
    field("inner", self.inner);
    field("corners", self.corners);
  }
};

std::string ProblemOf(const std::string& text) {
  const Result<Sample> result = ReadOptions<Sample>(text, "sample.yaml");
  return result.ok() ? "" : result.error().message;
}

TEST(ReadOptions, KeepsTheDefaultsOfAnEmptyText) {
  const Result<Sample> sample = ReadOptions<Sample>("# nothing\n", "sample.yaml");
  ASSERT_TRUE(sample.ok());
  EXPECT_EQ(sample.value().speed_mps, 2.0);
  EXPECT_EQ(sample.value().inner.tries, 3);
}

TEST(ReadOptions, TakesEveryKindOfField) {
  const Result<Sample> sample = ReadOptions<Sample>(
      "speed_mps: 4.5\nname: kite\nweights: [0, 0.25]\ncolors: [blue, red]\n"
      "inner: {tries: 7, loud: true}\ncorners: [{east_m: 1}, {east_m: -2}]\n",
      "sample.yaml");
  ASSERT_TRUE(sample.ok()) << sample.error().message;
  EXPECT_EQ(sample.value().speed_mps, 4.5);
  EXPECT_EQ(sample.value().name, "kite");
  EXPECT_THAT(sample.value().weights, ElementsAre(0.0, 0.25));
  EXPECT_THAT(sample.value().colors, ElementsAre("blue", "red"));
  EXPECT_EQ(sample.value().inner.tries, 7);
  EXPECT_TRUE(sample.value().inner.loud);
  ASSERT_THAT(sample.value().corners, SizeIs(2));
  EXPECT_EQ(sample.value().corners[1].east_m, -2.0);
}

TEST(ReadOptions, NamesFileLineKeyAndWhatIsAllowed) {
  EXPECT_THAT(ProblemOf("name: x\nspeed_mps: 99\n"),
              AllOf(HasSubstr("sample.yaml:2: speed_mps"), HasSubstr("99"), HasSubstr("0.1 to 20 m/s")));
}

struct Malformed {
  const char* text;
  const char* said;
};

class ReadOptionsRefuses : public ::testing::TestWithParam<Malformed> {};

TEST_P(ReadOptionsRefuses, SayingWhy) { EXPECT_THAT(ProblemOf(GetParam().text), HasSubstr(GetParam().said)); }

INSTANTIATE_TEST_SUITE_P(
    Malformed, ReadOptionsRefuses,
    ::testing::Values(
        Malformed{"speed: 1\n", "sample.yaml:1: speed: unknown key; known here: speed_mps, name"},
        Malformed{"inner:\n  trys: 2\n", "sample.yaml:2: inner.trys: unknown key"},
        Malformed{"corners:\n  - {east_m: 1}\n  - {east: 1}\n",
                  "sample.yaml:3: corners[1].east: unknown key"},
        Malformed{"corners: [{east_m: 500}]\n", "corners[0].east_m: is 500"},
        Malformed{"corners: 3\n", "corners: must be a list"},
        Malformed{"corners: [3]\n", "corners[0]: must be a block"},
        Malformed{"speed_mps: .nan\n", "speed_mps: is .nan, must be a number"},
        Malformed{"speed_mps: .inf\n", "speed_mps: is .inf, must be a number"},
        Malformed{"speed_mps: fast\n", "speed_mps: is 'fast', must be a number"},
        Malformed{"speed_mps: [1]\n", "speed_mps: must be a number"},
        Malformed{"speed_mps: 1\nspeed_mps: 2\n", "sample.yaml:2: speed_mps: given twice"},
        Malformed{"inner: {tries: 2.5}\n", "inner.tries: is '2.5', must be a whole number, 1 to 9"},
        Malformed{"inner: {tries: 99999999999}\n", "inner.tries: is '99999999999'"},
        Malformed{"inner: {loud: perhaps}\n", "inner.loud: is 'perhaps', must be true or false"},
        Malformed{"inner: 4\n", "inner: must be a block"},
        Malformed{"weights: [0.5, 2]\n", "weights[1]: is 2"},
        Malformed{"weights: 2\n", "weights: must be a list"}, Malformed{"name: [\n", "not YAML"},
        Malformed{"- a\n- b\n", "must be a list of 'key: value' lines"}));

TEST(ReadOptionsFile, SaysWhichFileIsMissing) {
  const Result<Sample> result = ReadOptionsFile<Sample>("/nowhere/sample.yaml");
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, Error::Code::kNotFound);
  EXPECT_THAT(result.error().message, HasSubstr("/nowhere/sample.yaml"));
}

TEST(DescribeOptions, WritesWhatReadOptionsTakes) {
  Sample sample;
  sample.speed_mps = 0.1 + 0.2;
  sample.corners = {Corner{1.0}, Corner{-3.5}};
  const std::string text = DescribeOptions(sample);
  EXPECT_THAT(text, HasSubstr("# Greatest speed: 0.1 to 20 m/s"));
  const Result<Sample> again = ReadOptions<Sample>(text, "again.yaml");
  ASSERT_TRUE(again.ok()) << again.error().message << "\n" << text;
  EXPECT_EQ(again.value().speed_mps, sample.speed_mps);
  EXPECT_EQ(again.value().name, sample.name);
  ASSERT_THAT(again.value().corners, SizeIs(2));
  EXPECT_EQ(again.value().corners[1].east_m, -3.5);
}

struct Plain {
  bool flag = true;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("flag", self.flag, OptionInfo{0, 0, "", "Help"});
  }
};

TEST(DescribeOptions, NamesNoBoundsWhereThereAreNone) {
  EXPECT_EQ(DescribeOptions(Plain{}), "flag: true  # Help\n");
}

TEST(FindOptionProblem, LooksIntoVectorsAndNestedStructs) {
  Sample sample;
  EXPECT_THAT(FindOptionProblem(sample), IsEmpty());
  sample.corners = {Corner{0.0}, Corner{std::nan("")}};
  EXPECT_THAT(FindOptionProblem(sample), HasSubstr("corners[1].east_m"));
  sample.corners.clear();
  sample.weights = {2.0};
  EXPECT_THAT(FindOptionProblem(sample), HasSubstr("weights[0]"));
}

}  // namespace
}  // namespace soffit
