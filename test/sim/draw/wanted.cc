#include "test/sim/draw/wanted.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace soffit::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kEllFoot_m = 1.2;  // About how deep the passage of an L is.

/// Of the passage: it runs along y, from -depth / 2 to depth / 2.
struct Passage {
  Opening opening;
  double depth_m = 0.0;
  double Middle_m() const { return 0.5 * (opening.left_m + opening.right_m); }
  double Width_m() const { return opening.right_m - opening.left_m; }
};

Form DrawForm(Trouble trouble, Dice& dice) {
  const double chance = dice.Unit();
  if (chance < 0.25) return Form::kEll;
  if (chance < 0.40 && trouble == Trouble::kNone) return Form::kTable;
  if (chance < 0.55 && trouble == Trouble::kNone) return Form::kRoundArch;
  return chance < 0.65 ? Form::kWindow : Form::kArch;
}

Opening DrawOpening(const Order& order, const VehicleEnvelope& vehicle, double spare_m, Dice& dice) {
  const double need_width_m = vehicle.NeededWidth_m(), need_height_m = vehicle.NeededHeight_m();
  double width_m = need_width_m + spare_m + dice.Between(0.0, 0.6);
  double height_m = need_height_m + spare_m + dice.Between(0.1, 0.7);
  const double least_lack_m = order.is_tight ? 0.02 : 0.10;
  if (order.trouble == Trouble::kTooNarrow)
    width_m = need_width_m - dice.Between(least_lack_m, order.is_tight ? 0.10 : 0.5);
  if (order.trouble == Trouble::kTooLow)
    height_m = need_height_m - dice.Between(least_lack_m, order.is_tight ? 0.10 : 0.35);
  if (order.trouble == Trouble::kNone && order.is_tight) {
    const double little_m = dice.Between(0.03, 0.15);
    if (dice.Chance(0.5)) {
      width_m = need_width_m + little_m;
    } else {
      height_m = need_height_m + little_m;
    }
  }
  const double middle_m = dice.Between(-0.2, 0.2);
  return {middle_m - width_m / 2, middle_m + width_m / 2, 0.0, height_m, false};
}

/// A rope of square section across the passage, its ends at the walls.
Part RopePart(const Passage& passage, double ends_m, double sag_m, double thick_m, double at_m) {
  constexpr int kSteps = 12;
  Prism rope;
  rope.is_lying = true;
  rope.at = {passage.Middle_m(), 0.0};
  rope.low_m = at_m - thick_m / 2;
  rope.high_m = at_m + thick_m / 2;
  const double half_m = passage.Width_m() / 2 - 0.001;
  const auto add = [&](int i, double lift_m) {
    const double x = -1.0 + 2.0 * i / kSteps;
    rope.section.outer.emplace_back(half_m * x, ends_m - sag_m * (1.0 - x * x) + lift_m);
  };
  for (int i = 0; i <= kSteps; ++i) add(i, -thick_m / 2);
  for (int i = kSteps; i >= 0; --i) add(i, thick_m / 2);
  return {rope, {}};
}

/// What stands or hangs in the way.
class ObstacleDrawer {
 public:
  ObstacleDrawer(const Passage& passage, const Wanted& wanted, Dice& dice)
      : passage_(passage),
        wanted_(wanted),
        dice_(dice),
        middle_m_(passage.Middle_m()),
        width_m_(passage.Width_m()),
        high_m_(passage.opening.high_m),
        mouth_m_(passage.depth_m / 2),
        side_(dice.Chance(0.5) ? 1.0 : -1.0) {}

  Part Draw(const Order& order) {
    const auto thick_m = [&](const Range& usual) {
      const Range range = order.thick_m.value_or(usual);
      return dice_.Between(range.low, range.high);
    };
    switch (order.trouble) {
      case Trouble::kPole:
        return Pole(thick_m({0.08, 0.16}));
      case Trouble::kBeam:
        return Beam();
      case Trouble::kSill:
        return Sill();
      case Trouble::kCable:
        return Cable(thick_m({0.01, 0.02}));
      case Trouble::kRope:
        return Rope(thick_m({0.01, 0.02}));
      case Trouble::kBoxInside:
        return BoxInside();
      case Trouble::kBoxAway:
        return BoxAway();
      case Trouble::kWall:
        return Wall(dice_.Between(0.4, 1.6));
      case Trouble::kBackdrop:
        return Wall(dice_.Between(2.7, 4.8));
      default:
        return Crate();
    }
  }

 private:
  Part Pole(double thick_m) {
    return BoxPart({middle_m_ + dice_.Between(-0.15, 0.15), side_ * dice_.Between(0.0, mouth_m_ + 0.4)},
                   {thick_m, thick_m}, 0.0, high_m_ + dice_.Between(0.2, 0.6));
  }

  Part Beam() {
    const double middle_z_m = high_m_ * dice_.Between(0.45, 0.6);
    return BoxPart({middle_m_, side_ * dice_.Between(0.0, mouth_m_ - 0.1)},
                   {width_m_ - 0.002, dice_.Between(0.06, 0.15)}, middle_z_m - dice_.Between(0.04, 0.08),
                   middle_z_m + dice_.Between(0.04, 0.08));
  }

  Part Crate() {
    const double long_m = dice_.Between(0.5, 0.9);
    return BoxPart({middle_m_, side_ * (mouth_m_ + long_m / 2 + dice_.Between(0.1, 0.4))},
                   {dice_.Between(0.6, width_m_), long_m}, 0.0, high_m_ * dice_.Between(0.6, 0.95));
  }

  Part Sill() {
    const double at_m = side_ * dice_.Between(0.0, mouth_m_), long_m = dice_.Between(0.05, 0.4);
    return BoxPart({middle_m_, at_m}, {width_m_ - 0.002, long_m}, 0.0, dice_.Between(0.08, 0.5));
  }

  Part Cable(double thick_m) {
    const double x = middle_m_ + width_m_ * dice_.Between(-0.25, 0.25);
    const double y = side_ * dice_.Between(0.0, mouth_m_ - 0.1);
    return BoxPart({x, y}, {thick_m, thick_m}, high_m_ * dice_.Between(0.0, 0.55), high_m_);
  }

  Part Rope(double thick_m) {
    const double ends_m = high_m_ * dice_.Between(0.45, 0.65), sag_m = dice_.Between(0.0, 0.2);
    return RopePart(passage_, ends_m, sag_m, thick_m, side_ * dice_.Between(0.0, mouth_m_ - 0.1));
  }

  Part BoxInside() {
    const double x = middle_m_ + width_m_ * dice_.Between(-0.2, 0.2);
    const double y = side_ * mouth_m_ * dice_.Between(0.0, 0.5);
    const double wide_m = width_m_ * dice_.Between(0.3, 0.7), long_m = mouth_m_ * dice_.Between(0.4, 1.0);
    return BoxPart({x, y}, {wide_m, long_m}, 0.0, high_m_ * dice_.Between(0.4, 0.9));
  }

  Part BoxAway() {
    const double x = middle_m_ + dice_.Between(-0.3, 0.3), long_m = dice_.Between(0.4, 0.9);
    const double y = side_ * (mouth_m_ + long_m / 2 + dice_.Between(0.5, 1.2));
    const double wide_m = dice_.Between(0.5, 1.2);
    return BoxPart({x, y}, {wide_m, long_m}, 0.0, high_m_ * dice_.Between(0.6, 1.1));
  }

  Part Wall(double away_m) {
    const double wide_m = wanted_.size_m.x() * dice_.Between(0.8, 1.6);
    return BoxPart({middle_m_, side_ * (mouth_m_ + away_m)}, {wide_m, 0.2}, 0.0,
                   wanted_.height_m * dice_.Between(0.7, 1.3));
  }

  const Passage& passage_;
  const Wanted& wanted_;
  Dice& dice_;
  double middle_m_;
  double width_m_;
  double high_m_;
  double mouth_m_;
  double side_;
};

Bush DrawBush(const Passage& passage, Dice& dice) {
  const double radius_m = dice.Between(0.25, 0.5), side = dice.Chance(0.5) ? 1.0 : -1.0;
  const double x = passage.Middle_m() + dice.Between(-0.3, 0.3);
  return {{x, side * (passage.depth_m / 2 + radius_m + dice.Between(0.1, 1.0))}, radius_m};
}

/// The colours at hand.
struct Palette {
  Guise guise;
  Finish building;
  Finish ground;

  Finish Mix(const Finish& grey, Dice& dice) const {
    switch (guise) {
      case Guise::kDark:
        return {Vector3d::Constant(dice.Between(0.03, 0.10)), Pattern::kMottled, 0.3, 0.1};
      case Guise::kGround:
        return ground;
      case Guise::kBuilding:
        return building;
      case Guise::kSky:
        return {dice.Between(0.95, 1.05) * Vector3d(0.78, 0.83, 0.89), Pattern::kPlain, 1.0, 0.02};
      case Guise::kGrey:
        break;
    }
    return grey;
  }
};

std::vector<Part> BuildRecess(const Vector2d& size_m, double height_m, const Opening& opening,
                              const Palette& palette, Dice& dice) {
  const double depth_m = size_m.y() * dice.Between(0.35, 0.7), side = dice.Chance(0.5) ? 1.0 : -1.0;
  const double rest_m = size_m.y() - depth_m;
  Part front = WallPart(WallWithOpening(size_m.x(), height_m, opening), depth_m);
  auto& prism = std::get<Prism>(front.shape);
  const double shift_m = side * rest_m / 2;
  prism.low_m += shift_m;
  prism.high_m += shift_m;
  Part back = BoxPart({0.0, -side * depth_m / 2}, {size_m.x(), rest_m}, 0.0, height_m);
  Part lining = BoxPart({(opening.left_m + opening.right_m) / 2, side * (rest_m - size_m.y() / 2 + 0.005)},
                        {opening.right_m - opening.left_m - 0.004, 0.01}, 0.0, opening.high_m - 0.002);
  const Finish grey{Vector3d::Constant(dice.Between(0.08, 0.3)), Pattern::kMottled, 0.3, 0.1};
  lining.finish = palette.Mix(grey, dice);
  return {front, back, lining};
}

/// Paint where an opening might be, on the long wall at `y_m`.
Part PaintPart(const Opening& opening, double y_m, double low_m, double high_m, const Finish& finish) {
  Part paint = BoxPart({(opening.left_m + opening.right_m) / 2, y_m},
                       {opening.right_m - opening.left_m, 0.002}, low_m, high_m);
  paint.finish = finish;
  return paint;
}

std::vector<Part> BuildPaintedDoor(const Vector2d& size_m, double height_m, const Opening& opening,
                                   Dice& dice) {
  const double side = dice.Chance(0.5) ? 1.0 : -1.0, shade = dice.Between(0.05, 0.3);
  const Finish dark{{shade, shade, 1.05 * shade}, Pattern::kMottled, 0.3, 0.1};
  return {BoxPart(Vector2d::Zero(), size_m, 0.0, height_m),
          PaintPart(opening, side * size_m.y() / 2, 0.0, opening.high_m, dark)};
}

/// What would be seen through a passage from half the building's height: ground, far things, sky. On one wall
/// or on both.
std::vector<Part> BuildPicture(const Vector2d& size_m, double height_m, const Opening& opening,
                               const Finish& ground, Dice& dice) {
  const double horizon_m = std::min(0.5 * height_m, 0.85 * opening.high_m);
  const double far_m = std::min(horizon_m + dice.Between(0.02, 0.25), 0.95 * opening.high_m);
  const double grey = dice.Between(0.25, 0.65);
  const Finish far{{grey, grey, 0.95 * grey}, Pattern::kMottled, 0.3, 0.2};
  const Finish sky{{0.75, 0.81, 0.88}, Pattern::kPlain, 1.0, 0.02};
  std::vector<Part> parts = {BoxPart(Vector2d::Zero(), size_m, 0.0, height_m)};
  const int walls = 1 + dice.Pick(2);
  for (int i = 0; i < walls; ++i) {
    const double y = (i == 0 ? 0.5 : -0.5) * size_m.y();
    parts.push_back(PaintPart(opening, y, 0.0, horizon_m, ground));
    parts.push_back(PaintPart(opening, y, horizon_m, far_m, far));
    parts.push_back(PaintPart(opening, y, far_m, opening.high_m, sky));
  }
  return parts;
}

/// The parts of the building for its form; sizes and opening become what the form makes of them.
std::vector<Part> BuildForm(Form form, Opening& opening, Wanted& wanted, Dice& dice) {
  const double width_m = opening.right_m - opening.left_m;
  switch (form) {
    case Form::kEll: {
      const double foot_m = dice.Between(1.0, 1.3), stem_m = dice.Between(0.9, 1.2);
      wanted.size_m = {stem_m + width_m + dice.Between(0.9, 1.2), foot_m + dice.Between(0.8, 1.3)};
      const Ring ell = EllRing(wanted.size_m.x(), wanted.size_m.y(), foot_m, stem_m);
      opening.left_m = ell[0].x() + stem_m + 0.05;
      opening.right_m = opening.left_m + width_m;
      wanted.is_box = false;
      return EllWithPassage(ell, foot_m, stem_m, opening, wanted.height_m);
    }
    case Form::kTable:
      wanted.size_m = {dice.Between(2.5, 3.2), dice.Between(2.2, 2.5)};
      wanted.height_m = opening.high_m + dice.Between(0.2, 0.3);
      return TableParts(wanted.size_m, dice.Between(0.22, 0.3), opening.high_m, wanted.height_m);
    case Form::kSlanted: {
      const double slant_rad = (dice.Chance(0.5) ? 1.0 : -1.0) * dice.Between(0.17, 0.45);
      wanted.size_m.x() += wanted.size_m.y() * std::abs(std::tan(slant_rad));
      return SlantedParts(wanted.size_m, slant_rad, opening, wanted.height_m);
    }
    case Form::kRoundArch:
      opening.is_round = true;
      opening.high_m += 0.30 * width_m;
      break;
    case Form::kWindow: {
      const double sill_m = dice.Between(0.2, 0.6);
      opening.low_m += sill_m;
      opening.high_m += sill_m;
      break;
    }
    case Form::kArch:
      break;
  }
  wanted.height_m = std::max(opening.high_m + dice.Between(0.4, 0.7), 1.6);
  return {WallPart(WallWithOpening(wanted.size_m.x(), wanted.height_m, opening), wanted.size_m.y())};
}

bool IsObstacle(Trouble trouble) {
  switch (trouble) {
    case Trouble::kPole:
    case Trouble::kBeam:
    case Trouble::kSill:
    case Trouble::kCable:
    case Trouble::kRope:
    case Trouble::kBoxInside:
    case Trouble::kCrate:
    case Trouble::kBoxAway:
    case Trouble::kWall:
    case Trouble::kBackdrop:
      return true;
    default:
      return false;
  }
}

}  // namespace

Finish DrawFinish(Dice& dice) {
  const Eigen::Vector3d colors[] = {{0.72, 0.07, 0.06}, {0.09, 0.17, 0.62}, {0.88, 0.70, 0.08}};
  constexpr Pattern kPatterns[] = {Pattern::kPlain, Pattern::kMottled, Pattern::kMottled, Pattern::kPanels,
                                   Pattern::kBricks};
  Finish finish;
  finish.color_srgb = colors[dice.Pick(3)] * dice.Between(0.82, 1.1);
  for (int i = 0; i < 3; ++i)
    finish.color_srgb[i] = std::clamp(finish.color_srgb[i] + dice.Between(-0.02, 0.02), 0.0, 1.0);
  finish.pattern = kPatterns[dice.Pick(5)];
  finish.grain_m = dice.Between(0.25, 0.8);
  finish.contrast = dice.Between(0.04, 0.16);
  return finish;
}

Wanted DrawWanted(const Order& order, const VehicleEnvelope& vehicle, double spare_m, const Finish& ground,
                  Dice& dice) {
  Wanted wanted;
  wanted.building.id = "wanted";
  wanted.building.finish = DrawFinish(dice);
  wanted.building.is_absent = order.trouble == Trouble::kAbsent;
  const Palette palette{order.guise, wanted.building.finish, ground};
  Opening opening = DrawOpening(order, vehicle, spare_m, dice);
  const double pier_m = dice.Between(0.8, 1.2);
  wanted.size_m = {opening.right_m - opening.left_m + 2.0 * pier_m, dice.Between(1.1, 1.7)};
  wanted.height_m = std::max(opening.high_m + dice.Between(0.4, 0.8), 1.6);
  const Form drawn_form = DrawForm(order.trouble, dice);
  if (order.trouble == Trouble::kRecess) {
    wanted.building.parts = BuildRecess(wanted.size_m, wanted.height_m, opening, palette, dice);
  } else if (order.trouble == Trouble::kPaintedDoor) {
    wanted.building.parts = BuildPaintedDoor(wanted.size_m, wanted.height_m, opening, dice);
  } else if (order.trouble == Trouble::kPicture) {
    wanted.building.parts = BuildPicture(wanted.size_m, wanted.height_m, opening, ground, dice);
  } else {
    wanted.building.parts = BuildForm(order.form.value_or(drawn_form), opening, wanted, dice);
  }
  // The passage of an L is in its foot.
  const Passage passage{opening, wanted.is_box ? wanted.size_m.y() : kEllFoot_m};
  const Vector2d shift(0.0, wanted.is_box ? 0.0 : 0.5 * (kEllFoot_m - wanted.size_m.y()));
  if (IsObstacle(order.trouble)) {
    Structure obstacle;
    obstacle.id = "obstacle";
    obstacle.position_m = shift;
    const double grey = dice.Between(0.2, 0.5);
    const Finish plain{{grey, 0.97 * grey, 0.92 * grey}, Pattern::kMottled, 0.3, 0.1};
    obstacle.parts = {ObstacleDrawer(passage, wanted, dice).Draw(order)};
    obstacle.finish = palette.Mix(plain, dice);
    wanted.obstacles = {obstacle};
  }
  if (order.trouble == Trouble::kBush) {
    Bush bush = DrawBush(passage, dice);
    bush.position_m += shift;
    wanted.bushes = {bush};
  }
  return wanted;
}

}  // namespace soffit::sim
