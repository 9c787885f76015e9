#pragma once

#include <optional>
#include <vector>

#include "test/sim/draw/dice.h"
#include "test/sim/draw/shapes.h"
#include "test/sim/world/world.h"

namespace soffit::sim {

/// What leads through the wanted building.
enum class Form { kArch, kRoundArch, kWindow, kEll, kTable, kSlanted };

/// What may be wrong with the way through it.
enum class Trouble {
  kNone,
  kAbsent,  ///< Only the reference knows the building.
  kTooLow,
  kTooNarrow,
  kRecess,
  kPaintedDoor,
  kPicture,  ///< Of the landscape, painted on the wall.
  kPole,
  kBeam,
  kSill,   ///< A threshold on the ground.
  kCable,  ///< Hangs from the lintel.
  kRope,   ///< Slack, from side to side.
  kBoxInside,
  kCrate,     ///< A box right before a mouth.
  kBoxAway,   ///< A box farther before a mouth.
  kWall,      ///< Across the way, where the vehicle has to come from or go to.
  kBackdrop,  ///< A wall behind that leaves enough room.
  kBush,      ///< Before a mouth.
};

/// What an obstacle looks like.
enum class Guise { kGrey, kDark, kGround, kBuilding, kSky };

struct Range {
  double low = 0.0;
  double high = 0.0;
};

/// What is asked of the wanted building; what is left open is drawn.
struct Order {
  Trouble trouble = Trouble::kNone;
  std::optional<Form> form = {};  ///< Recesses and paintings have none of their own.
  Guise guise = Guise::kGrey;
  std::optional<Range> thick_m = {};  ///< Of a pole, cable or rope.
  bool is_tight = false;         ///< What fits or does not fit does so by little.
};

/// The wanted building, what stands in its way, and its size. Its passage runs along y.
struct Wanted {
  Structure building;
  std::vector<Structure> obstacles;  ///< In the building's frame.
  std::vector<Bush> bushes;          ///< In the building's frame.
  Eigen::Vector2d size_m;
  double height_m = 0.0;
  bool is_box = true;  ///< Its outline is a rectangle.
};

/// @param spare_m  By how much a passage that is large enough exceeds the need, at least; not when tight.
Wanted DrawWanted(const Order& order, const VehicleEnvelope& vehicle, double spare_m, const Finish& ground,
                  Dice& dice);

/// Red, blue or yellow, as buildings are.
Finish DrawFinish(Dice& dice);

}  // namespace soffit::sim
