#pragma once

#include "service/edge/files/analysis.h"

namespace soffit {

/// The same in coordinates in which the map's origin lies at `origin_m`: all that files tell of places. Two
/// things stay as they are: the octree, whose keys do not reach far (its file tells where its origin is), and
/// the words of reasons and problems.
Analysis MoveMap(Analysis analysis, const Eigen::Vector3d& origin_m);

}  // namespace soffit
