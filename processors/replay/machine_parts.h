// A machine of many clusters timed by several threads, with the result that one thread has, bit for bit.
//
// Clusters share nothing but the host, so they are divided into parts, each with an engine of its own, and
// all parts go on to the end of a window that is no longer than the host's latency: what a node asks the host
// for reaches it in a later window. At its end the host answers all requests in the order of the whole
// machine's events, by time, class and number, as it does where one engine handles all of them. Where packets
// are assigned before the frame there is a single window.
//
// Windows are those of conservative simulations: Chandy, Misra, Distributed simulation, IEEE Trans. Software
// Engineering 5(5), 1979; Nicol, The cost of conservative synchronization in parallel discrete event
// simulations, Journal of the ACM 40(2), 1993.
#pragma once

#include <cstdint>
#include <optional>

#include "processors/node/host.h"
#include "processors/replay/replay.h"
#include "processors/walk/replay_input.h"

namespace marti::processors::replay {

/// How a machine is divided.
struct Division {
  unsigned parts = 1;
  unsigned threads = 1;   ///< at most as many
  sim::Ticks window = 0;  ///< at least 1
};

/// The division of a machine among so many threads, into so many parts (0: as many as pay); std::nullopt
/// where it is not divided, because why_no_parts() gives a reason or its nodes are walked by code that
/// cannot be (node::can_be_parts).
[[nodiscard]] std::optional<Division> division_of(const walk::ReplayInput& input, unsigned threads,
                                                  unsigned parts, std::uint32_t fewest_nodes);

/// Why a machine of this configuration is not divided, however many threads there are; null where it may be.
/// `fewest_nodes`: with fewer there are too few events in a window to pay for the threads to meet at its end.
[[nodiscard]] const char* why_no_parts(const machine::MachineConfig& config, std::uint32_t fewest_nodes);

/// Times the machine in parts. `input` and `host` are those of the whole machine. What the host and the
/// checks add to the result is left to the caller.
[[nodiscard]] MachineResult replay_parts(const walk::ReplayInput& input, node::Host& host,
                                         const Division& division, std::uint64_t start_seed);

}  // namespace marti::processors::replay
