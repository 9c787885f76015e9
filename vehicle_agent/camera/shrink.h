#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "shared/capture/capture.h"
#include "shared/result/result.h"

namespace soffit {

/// Makes the picture of `capture` fit into `max_bytes`, with the intrinsics of its new size.
///
/// One that fits stays as it is. Else it is encoded again at `quality`, at the largest of the sizes 1, 3/4,
/// 1/2, 3/8 and 1/4 that fits; at the smallest when none does. EXIF data are lost. An error when it is no
/// JPEG that can be decoded. Pure; tens of milliseconds per megapixel.
Result<Capture> ShrinkCapture(Capture capture, std::size_t max_bytes, int quality);

}  // namespace soffit
