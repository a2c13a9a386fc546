// What a replay need not simulate because its outcome is known beforehand.
//
// A cache that has room for every line of the database in the line's own set never replaces one: a reference
// misses when it is the node's first to that line, whatever the ways and the replacement are. A bit for each
// line takes the place of the tags. Over an ideal interconnect a read always takes the same time and nobody
// waits: a node continues through its misses by itself, without an event.
#pragma once

#include <cstdint>
#include <optional>

#include "memory/layout.h"
#include "processors/machine/machine_config.h"

namespace marti::processors::walk {

/// What of a replay was left out.
struct LeftOut {
  bool lookups = false;      ///< tags and their replacement
  bool read_events = false;  ///< an event for each read
};

/// Why nodes of this machine are not the plain ones, of the image scheme, with one context, a given tree, and
/// without prefetches and detailed counts; null when they are.
[[nodiscard]] const char* why_other_nodes(const machine::MachineConfig& config);

/// Number of lines of the database, from line 0 on, that the machine's caches may be asked for.
[[nodiscard]] std::uint64_t lines_of(const memory::Layout& layout, std::uint32_t line_bytes);

/// Why tags must be looked up on this machine; null when they need not. Only plain nodes with a unified cache
/// can do without.
[[nodiscard]] const char* why_lookups(const machine::MachineConfig& config, const memory::Layout& layout);

/// Why reads must be events on this machine; null when they need not. Only plain nodes can do without.
[[nodiscard]] const char* why_read_events(const machine::MachineConfig& config);

}  // namespace marti::processors::walk
