// Divides the time that a node waited for a transaction.
#pragma once

#include <algorithm>

#include "memory/interconnect.h"
#include "processors/accounting.h"

namespace marti::processors {

/// Adds the last `waited` ticks of a read's course to `time`: its waits for the interconnect, its transfer,
/// its wait for the bank and the bank's access count as if they came in this order, whole ones last. `waited`
/// is at most their sum.
inline void add_waiting(const memory::Service& service, sim::Ticks waited, TimeDivision& time) {
  const auto take = [&](Activity activity, sim::Ticks phase) {
    const sim::Ticks part = std::min(phase, waited);
    time[static_cast<std::size_t>(activity)] += part;
    waited -= part;
  };
  take(Activity::bank_access, service.bank);
  take(Activity::bank_wait, service.wait_bank);
  take(Activity::transfer, service.transfer);
  take(Activity::interconnect_wait, service.wait_interconnect);
}

}  // namespace marti::processors
