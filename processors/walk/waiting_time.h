// How much of a transaction a node waited for.
#pragma once

#include <algorithm>

#include "memory/interconnect.h"

namespace marti::processors {

/// The last `waited` ticks of a read's course: its wait for the interconnect, its transfer, its wait for the
/// bank and the bank's access count as if they came in this order, whole ones last. `waited` is at most their
/// sum.
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

}  // namespace marti::processors
