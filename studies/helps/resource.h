// A resource of a machine that can be made better.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "studies/helps/change.h"

namespace marti::studies::helps {

/// The part of a machine that a resource belongs to, by which a verdict says how busy it is.
enum class Part : std::uint8_t {
  nodes,
  caches,
  second_level,
  local_memory,
  interconnect,
  banks,
  network,
  messages,
  queues,
  host,
  building,
  regions
};

struct Resource {
  std::string name;  ///< the key that is changed, as results for programs name the resource
  Part part = Part::nodes;
  /// The resource a tenth better, or, where its key does not allow that value, better by the next larger
  /// amount that it allows. Empty where its key allows nothing better.
  std::optional<Change> step;
  /// As good as it can be: it costs no time, or there is as much of it as can be used. Empty where that is
  /// not defined.
  std::optional<Change> best;
  /// Whether every step of a ray still takes the same number of cycles of a node.
  bool same_work = true;
  /// Nothing in the frame has ever waited for this resource, so improving it cannot change the frame time.
  bool same_frame = false;
};

}  // namespace marti::studies::helps
