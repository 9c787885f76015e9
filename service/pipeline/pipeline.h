#pragma once

#include <map>
#include <vector>

#include "service/clearance/clearance.h"
#include "service/corridor/corridor.h"
#include "service/facade/facade.h"
#include "service/footprint/footprint.h"
#include "service/image/image.h"
#include "service/mask/mask.h"
#include "service/match/match.h"
#include "service/outline/judge.h"
#include "service/outline/outline.h"
#include "service/scene/scene.h"
#include "service/solid/solid.h"
#include "service/viewpoint/viewpoint.h"

namespace soffit {

/// The options of all stages, in the order of the data flow.
struct PipelineOptions {
  ImageOptions image;
  MaskOptions mask;
  OutlineOptions outline;
  FootprintOptions footprint;
  MatchOptions match;
  ViewpointOptions viewpoint;
  FacadeOptions facade;
  SceneOptions scene;
  CorridorOptions corridor;
  ClearanceOptions clearance;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("image", self.image);
    field("mask", self.mask);
    field("outline", self.outline);
    field("footprint", self.footprint);
    field("match", self.match);
    field("viewpoint", self.viewpoint);
    field("facade", self.facade);
    field("scene", self.scene);
    field("corridor", self.corridor);
    field("clearance", self.clearance);
  }
};

/// What one picture shows by itself. Pictures are independent of each other, so this runs on any thread. All
/// but the footprints is of the picture as it is kept: see ImageOptions::kept_megapixels.
struct Observation {
  Image image;
  Mask mask;
  std::vector<Outline> outlines;        ///< From above: what may be buildings.
  std::vector<RefusedOutline> refused;  ///< From above: what has their colours only.
  std::vector<Footprint> footprints;    ///< Pictures from above.
  Sight sight;
};
Result<Observation> Observe(const Capture& capture, const PipelineOptions& options);

/// What all pictures together show.
struct Understanding {
  Scene scene;
  std::vector<Match> matches;                ///< Best first; `shapes` index `scene.objects`.
  std::vector<Facade> facades;               ///< Of the wanted objects.
  std::vector<ClearanceDecision> decisions;  ///< Of the wanted objects.
  std::map<std::uint32_t, View> views;       ///< By capture: adjusted to the wanted objects.
  std::vector<std::string> problems;         ///< For people: what could not be made, and why.
};
Understanding Understand(const std::vector<Observation>& observations, const Reference& reference,
                         const VehicleEnvelope& vehicle, std::uint64_t revision,
                         const PipelineOptions& options,
                         const Eigen::Vector3d& map_origin_m = Eigen::Vector3d::Zero());

}  // namespace soffit
