#pragma once

#include "test/sim/draw/wanted.h"

namespace soffit::sim {

constexpr double kOverviewAltitude_m = 9.0;

Finish DrawGround(Dice& dice);
PoseNoise DrawPoseNoise(Dice& dice);
CameraModel DrawCamera(Dice& dice);
void DrawWeather(World& world, Dice& dice);

/// Home is free, and the whole building is in the overview picture, whatever its heading.
bool IsWellPlaced(const Structure& structure, const Eigen::Vector2d& size_m, double height_m);

/// Puts the building somewhere where it is well placed; false: it is too large for that.
bool Place(Structure& structure, const Eigen::Vector2d& size_m, double height_m, Dice& dice);

/// Other buildings and bushes, away from home and from the ways to the wanted building.
void AddDistractors(World& world, const Wanted& wanted, Dice& dice);

/// Trees and houses far around.
void AddHorizon(World& world, Dice& dice);

}  // namespace soffit::sim
