// What a timed machine counted, over all its nodes, clusters and banks.
#pragma once

#include <cstdint>
#include <optional>

#include "memory/wait_statistics.h"
#include "processors/replay/replay.h"

namespace marti::studies::figures {

/// Parts that a machine does not have have no value.
struct MachineTotals {
  std::optional<sim::Sums<memory::InterconnectStatistics>> interconnect;
  std::optional<sim::Sums<memory::BankStatistics>> bank;
  std::optional<sim::Sums<memory::DramStatistics>> dram;
  std::optional<sim::Sums<memory::DistributedStatistics>> distributed;
  std::optional<sim::Sums<memory::NetworkStatistics>> network;
  std::optional<sim::Sums<processors::cost::NodeStatistics>> node;
  std::optional<sim::Sums<processors::flow::FlowCounts>> flow;
  std::optional<memory::WaitStatistics> interconnect_waits;
  std::optional<memory::WaitStatistics> bank_waits;
  std::optional<memory::WaitStatistics> network_waits;
  std::optional<memory::WaitStatistics> l2_waits;  ///< for lines on their way to a shared second level
  std::int64_t banks = 0;
  sim::Sum most_interconnect_busy = 0;  ///< of the busiest cluster
  sim::Ticks most_bank_busy = 0;        ///< of the busiest bank
  sim::Sum most_network_busy = 0;       ///< of the busiest cluster
};

[[nodiscard]] MachineTotals totals_of(const processors::replay::MachineResult& result);

}  // namespace marti::studies::figures
