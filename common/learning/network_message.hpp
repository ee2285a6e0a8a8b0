#pragma once

#include "common/learning/network.hpp"
#include "common/proto/network.pb.h"

namespace prehend::learning {

/// A network's layers as they lie on disk, and back; reading refuses what is no sound network.
using LayerMessages = google::protobuf::RepeatedPtrField<messages::NetworkLayer>;
void write(const Network& network, LayerMessages& to);
Expected<Network> read_network(const LayerMessages& from, Wiring wiring = Wiring::layered);

}  // namespace prehend::learning
