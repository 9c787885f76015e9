#pragma once

#include <embree3/rtcore.h>

#include "test/sim/world/world.h"

namespace soffit::sim {

/// An Embree scene of triangle meshes; geometry i is the i-th mesh that was added. Building runs on one
/// thread.
class EmbreeScene {
 public:
  EmbreeScene();
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  void Add(const Mesh& mesh);
  void Commit();  ///< After the last mesh, before the first query.
  RTCScene get() const { return scene_; }

 private:
  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace soffit::sim
