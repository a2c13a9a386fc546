// SIMT nodes with ray-tracing units (docs/internals/rt-unit.md), as a kind of node of the image scheme.
#pragma once

#include <memory>

#include "processors/node/host.h"
#include "processors/node/node_array.h"
#include "processors/walk/replay_input.h"
#include "sim/engine.h"

namespace marti::processors::simt {

[[nodiscard]] std::unique_ptr<node::NodeArray> make_simt_nodes(const walk::ReplayInput& input,
                                                               sim::Engine& engine, node::Host& host);

}  // namespace marti::processors::simt
