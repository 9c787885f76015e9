#pragma once

#include <vector>

#include "service/mission/mission.h"

namespace soffit {

/// Where a mission looks. Its vehicle has to be known, and its findings for all but the overview.
class ViewPlanner {
 public:
  ViewPlanner(const Mission& mission, const ViewpointOptions& viewpoints, const MissionOptions& options)
      : m_(mission), viewpoints_(viewpoints), options_(options) {}

  /// Of the whole area.
  Viewpoint Overview() const;

  /// Pictures from above that may tell the wanted building: one from higher, over the middle of all that was
  /// seen (walls lean less there, nothing is cut off, and heights follow from the two places); then one of
  /// each building from straight above, which shows the true shape of one that leans or hides its foot. Empty
  /// when all that was done.
  std::vector<Viewpoint> ToRecognize() const;

  Viewpoint Top(std::uint32_t object_id) const;
  std::vector<Viewpoint> Walls(std::uint32_t object_id) const;

  /// From so high that the building and the places of `walls` are in one picture.
  Viewpoint Around(std::uint32_t object_id, const std::vector<Viewpoint>& walls) const;

  /// Those for which the vehicle goes down over ground that a picture from above showed.
  std::vector<Viewpoint> OverSeenGround(const std::vector<Viewpoint>& views) const;

  Viewpoint Along(const Corridor& corridor) const;

  /// It is new, clear of every footprint, over ground that was seen, and there are pictures left.
  bool CanLookAt(const Viewpoint& view) const;

 private:
  Viewpoint OverDisc(const Eigen::Vector2d& center, double radius_m) const;
  Viewpoint FromHigher() const;
  std::vector<Viewpoint> EachFromAbove() const;
  Viewpoint Top(const Footprint& object) const;
  const Footprint& Find(std::uint32_t object_id) const;
  bool IsOverSeenGround(const Viewpoint& view) const;
  bool IsClearOf(const Footprint& object, const Eigen::Vector3d& place) const;
  double Radius_m() const;
  double KeepOff_m() const;

  const Mission& m_;
  const ViewpointOptions& viewpoints_;
  const MissionOptions& options_;
};

}  // namespace soffit
