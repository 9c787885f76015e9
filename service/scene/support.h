#pragma once

#include "service/scene/voxels.h"

namespace soffit {

/// Nothing hovers: unknown voxels that free ones enclose on all sides, corners included, become free. A group
/// stays unknown when it reaches the ground (the lowest layer), another face of the grid, or anything that is
/// occupied: it may stand there, hang or lean. So does one with a thin line, whose ends may be too faint to
/// be seen. O(voxels).
void FreeUnsupported(Voxels& voxels);

}  // namespace soffit
