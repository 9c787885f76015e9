#pragma once

#include "service/edge/dds/messages.h"
#include "soffit.h"

namespace soffit {

wire::RequestId RequestIdToWire(const RequestId& id);
RequestId RequestIdFromWire(const wire::RequestId& id);

}  // namespace soffit
