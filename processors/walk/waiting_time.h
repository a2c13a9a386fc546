// How much of a transaction a node waited for.
#pragma once

#include <algorithm>

#include "memory/interconnect.h"

namespace marti::processors::walk {

/// The last `waited` ticks of a read. Its parts count as if they came in this order: wait for the
/// interconnect, transfer, wait for the bank, access of the bank; whole parts are counted from the end.
/// `waited` is at most their sum.
[[nodiscard]] inline memory::Service last_part(const memory::Service& service, sim::Ticks waited) {
  memory::Service part;
  part.done = service.done;
  part.bank = std::min(service.bank, waited);
  waited -= part.bank;
  part.wait_bank = std::min(service.wait_bank, waited);
  waited -= part.wait_bank;
  part.transfer = std::min(service.transfer, waited);
  part.wait_interconnect = waited - part.transfer;
  return part;
}

/// A line that the node's own second level has at `done`: it uses no part of the memory, so a wait for it is
/// cache access.
[[nodiscard]] inline memory::Service cache_access_until(sim::Ticks done) {
  memory::Service service;
  service.done = done;
  return service;
}
/// Whether the node waited for a cache access as above: of these alone all four parts are 0.
[[nodiscard]] inline bool is_cache_access(const memory::Service& service) {
  return service.wait_interconnect + service.transfer + service.wait_bank + service.bank == 0;
}

}  // namespace marti::processors::walk
