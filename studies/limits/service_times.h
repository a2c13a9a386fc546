// Times of the parts of a read that meets no other transaction, and what it occupies.
#pragma once

#include <vector>

#include "processors/machine/machine_config.h"
#include "studies/limits/queue_model.h"

namespace marti::studies::limits {

/// Of a machine with one shared memory a cluster; ps. Reads are lines, writes are pixels.
struct ServiceTimes {
  double address = 0.0;      ///< of a bus
  double data = 0.0;         ///< of a read
  double transfer = 0.0;     ///< of a read, outside of banks
  double held = 0.0;         ///< by a read while its bank works
  double write = 0.0;        ///< during which a write occupies the interconnect
  double bank_access = 0.0;  ///< of a read
  double bank_busy = 0.0;    ///< of an access; 0: there are no banks

  /// During which a read occupies the interconnect.
  [[nodiscard]] double read_busy() const { return address + data + held; }
};

[[nodiscard]] ServiceTimes service_times(const processors::machine::MachineConfig& machine);

/// What transactions queue for before and behind the banks: nothing, a bus, or a link for each bank, which
/// are taken to be equally busy. A cycle is one read and `writes` writes.
[[nodiscard]] std::vector<Station> interconnect_stations(const processors::machine::MachineConfig& machine,
                                                         double writes);

}  // namespace marti::studies::limits
