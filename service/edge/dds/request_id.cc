#include "service/edge/dds/request_id.h"

namespace soffit {

wire::RequestId RequestIdToWire(const RequestId& id) {
  wire::RequestId out;
  out.client(id.client);
  out.sequence_number(id.sequence);
  return out;
}

RequestId RequestIdFromWire(const wire::RequestId& id) { return {id.client(), id.sequence_number()}; }

}  // namespace soffit
