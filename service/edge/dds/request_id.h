#pragma once

#include "service/edge/dds/messages.h"
#include "shared/wire/fields.h"

namespace soffit {

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::RequestId>& m, ValueOf<Io, RequestId>& v) {
  io("client", m.client(), v.client);
  io("sequence_number", m.sequence_number(), v.sequence);
}

}  // namespace soffit
