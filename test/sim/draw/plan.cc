#include "test/sim/draw/plan.h"

namespace soffit::sim {
namespace {

constexpr bool kTight = true;
constexpr std::nullopt_t kAny = std::nullopt;

}  // namespace

Plan DrawPlan(Dice& dice) {
  constexpr Plan kOthers[] = {{"too low", {Trouble::kTooLow}}, {"too narrow", {Trouble::kTooNarrow}},
                              {"recess", {Trouble::kRecess}},  {"painted door", {Trouble::kPaintedDoor}},
                              {"pole", {Trouble::kPole}},      {"beam", {Trouble::kBeam}},
                              {"crate", {Trouble::kCrate}},    {"absent", {Trouble::kAbsent}}};
  return dice.Chance(0.52) ? Plan{"passage", {}} : kOthers[dice.Pick(8)];
}

const std::vector<Plan>& NastyPlans() {
  using enum Trouble;
  using enum Guise;
  static const std::vector<Plan> kPlans = {
      {"arch", {kNone, Form::kArch}},
      {"round arch", {kNone, Form::kRoundArch}},
      {"window", {kNone, Form::kWindow}},
      {"passage in an L", {kNone, Form::kEll}},
      {"table on legs", {kNone, Form::kTable}},
      {"slanted passage", {kNone, Form::kSlanted}},
      {"hardly large enough", {kNone, Form::kArch, kGrey, kAny, kTight}},
      {"low sun", {kNone}, Light::kLowSun},
      {"haze", {kNone}, Light::kHaze},
      {"glare", {kNone}, Light::kGlare},
      {"dusk", {kNone}, Light::kDusk},
      {"wall far behind", {kBackdrop}},
      {"wall far behind (ground colour)", {kBackdrop, kAny, kGround}},
      {"wall far behind (building colour)", {kBackdrop, kAny, kBuilding}},
      {"too low by little", {kTooLow, kAny, kGrey, kAny, kTight}},
      {"too narrow by little", {kTooNarrow, kAny, kGrey, kAny, kTight}},
      {"table too low by little", {kTooLow, Form::kTable, kGrey, kAny, kTight}},
      {"recess", {kRecess}},
      {"dark recess", {kRecess, kAny, kDark}},
      {"recess (ground colour)", {kRecess, kAny, kGround}},
      {"recess (sky colour)", {kRecess, kAny, kSky}},
      {"recess in low sun", {kRecess}, Light::kLowSun},
      {"painted door", {kPaintedDoor}},
      {"picture of the landscape", {kPicture}},
      {"pole", {kPole}},
      {"dark pole", {kPole, kAny, kDark}},
      {"pole (ground colour)", {kPole, kAny, kGround}},
      {"pole (building colour)", {kPole, kAny, kBuilding}},
      {"pole in low sun", {kPole}, Light::kLowSun},
      {"pole in haze", {kPole}, Light::kHaze},
      {"slim pole", {kPole, kAny, kGrey, Range{0.02, 0.05}}},
      {"pole under a table", {kPole, Form::kTable}},
      {"beam", {kBeam}},
      {"beam (ground colour)", {kBeam, kAny, kGround}},
      {"sill", {kSill, Form::kArch}},
      {"sill (ground colour)", {kSill, Form::kArch, kGround}},
      {"cable of 2 to 4 cm", {kCable, kAny, kDark, Range{0.02, 0.04}}},
      {"cable of 1 to 2 cm", {kCable, kAny, kDark, Range{0.01, 0.02}}},
      {"cable of 4 to 10 mm", {kCable, kAny, kDark, Range{0.004, 0.01}}},
      {"rope of 2 to 4 cm", {kRope, kAny, kGrey, Range{0.02, 0.04}}},
      {"rope of 1 to 2 cm", {kRope, kAny, kGrey, Range{0.01, 0.02}}},
      {"box inside", {kBoxInside}},
      {"dark box inside", {kBoxInside, kAny, kDark}},
      {"box inside (ground colour)", {kBoxInside, kAny, kGround}},
      {"box before a mouth", {kCrate}},
      {"box before a mouth (ground colour)", {kCrate, kAny, kGround}},
      {"box before a mouth (building colour)", {kCrate, kAny, kBuilding}},
      {"box away from a mouth", {kBoxAway}},
      {"box away from a mouth (ground colour)", {kBoxAway, kAny, kGround}},
      {"wall right behind", {kWall}},
      {"wall right behind (ground colour)", {kWall, kAny, kGround}},
      {"wall right behind (sky colour)", {kWall, kAny, kSky}},
      {"dark wall right behind", {kWall, kAny, kDark}},
      {"bush before a mouth", {kBush}},
      {"bush on a meadow", {kBush}, Light::kFair, true},
  };
  return kPlans;
}

}  // namespace soffit::sim
