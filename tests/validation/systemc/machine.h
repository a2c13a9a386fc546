// A whole simulated machine of SystemC modules, and what it counted.
#pragma once

#include <cstdint>
#include <memory>
#include <systemc>
#include <vector>

#include "memory/bank.h"
#include "memory/interconnect.h"
#include "processors/cost/accounting.h"
#include "processors/cost/step_time.h"
#include "processors/machine/machine_config.h"
#include "processors/node/host.h"
#include "processors/program/work_log.h"
#include "tests/validation/systemc/database.h"
#include "tests/validation/systemc/host.h"
#include "tests/validation/systemc/instant.h"
#include "tests/validation/systemc/interconnect.h"
#include "tests/validation/systemc/node.h"

namespace marti::oracle {

/// How often each wait occurred at a queue.
using WaitTimes = std::map<Time, std::int64_t>;

/// The `waits` members of the project's structs are left empty; they are in WaitTimes.
struct BankFigures {
  memory::BankStatistics statistics;
  WaitTimes waits;
};
struct ClusterFigures {
  memory::InterconnectStatistics interconnect;
  WaitTimes waits;
  std::vector<BankFigures> banks;
};
struct MachineFigures {
  Time end = 0;
  std::vector<processors::cost::NodeStatistics> nodes;
  std::vector<ClusterFigures> clusters;
  processors::node::HostStatistics host;
  std::uint64_t packets = 0;
};

/// Throws InternalError for a machine with any part that this model lacks: the model could not check
/// that part.
void refuse_what_is_not_modelled(const processors::machine::MachineConfig& config);

class Machine : public sc_core::sc_module {
 public:
  /// Log and configuration must outlive it.
  Machine(const sc_core::sc_module_name& name, const processors::program::WorkLog& log,
          const processors::machine::MachineConfig& config);
  /// After the simulation. Throws InternalError when a node has not finished.
  [[nodiscard]] MachineFigures figures() const;

 private:
  processors::cost::StepTicks ticks_;
  Database database_;
  Turns turns_;
  Host host_;
  std::vector<std::unique_ptr<Interconnect>> interconnects_;
  std::vector<std::unique_ptr<Node>> nodes_;
};

}  // namespace marti::oracle
