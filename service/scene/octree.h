#pragma once

#include <octomap/OcTree.h>

#include <memory>

#include "service/scene/voxels.h"

namespace soffit {

/// The voxels as an OctoMap, pruned: surely free, surely occupied, or no node where unknown. Built from the
/// root down, so that it never holds the nodes of a uniform block one by one.
std::shared_ptr<const octomap::OcTree> PlantTree(const Voxels& voxels);

}  // namespace soffit
