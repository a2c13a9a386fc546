// Runs machines of the SystemC model: all in one simulation, because a process can have but one.
#pragma once

#include <span>
#include <vector>

#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"
#include "tests/validation/systemc/machine.h"

namespace marti::oracle {

/// One machine and the log it works on. The objects must outlive the simulation.
struct Job {
  const processors::program::WorkLog* log = nullptr;
  const processors::machine::MachineConfig* config = nullptr;
};

struct Simulation {
  std::vector<MachineFigures> machines;  ///< one for each job
  double seconds = 0.0;                  ///< processor time, without building the modules
};

/// Each machine begins at time 0, independently of the others. Can be called once in a process; throws
/// InternalError the second time.
[[nodiscard]] Simulation simulate(std::span<const Job> jobs);

}  // namespace marti::oracle
