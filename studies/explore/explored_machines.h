// The machines that an exploration has simulated, and their figures.
#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "studies/run/run_result.h"
#include "studies/tables/table.h"

namespace marti::studies::explore {

/// Keys and their values, each as --set has them.
using Settings = std::vector<std::pair<std::string, std::string>>;

/// Thread-safe.
class ExploredMachines {
 public:
  /// Keeps the machine's figures, unless it is there already or there are too many.
  void add(const Settings& settings, const run::RunResult& result);

  /// "explored": a row for each machine, in the order in which they were simulated first.
  [[nodiscard]] tables::Table table() const;

 private:
  struct Machine {
    std::string name;  // "machine.nodes = 8, cache.size = 4 KiB"
    std::vector<std::optional<double>> figures;
  };
  static constexpr std::size_t most = 2000;

  mutable std::mutex mutex_;
  std::vector<Machine> machines_;
};

}  // namespace marti::studies::explore
