// The machines of the comparison with the SystemC model.
#pragma once

#include <cstdint>
#include <deque>
#include <string>

#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"

namespace marti::oracle {

struct ComparedMachine {
  std::string name;  ///< how to make it again
  processors::program::WorkLog log;
  processors::machine::MachineConfig config;
};

/// `count` machines and logs drawn from `seed`, `seed` + 1, ... A quarter have clocks of one period and steps
/// of few cycles, so that many events come at equal times; a quarter small caches and little memory
/// bandwidth, so that queues are long; a quarter short pixels and slow banks, so that write buffers are full.
[[nodiscard]] std::deque<ComparedMachine> random_machines(std::uint64_t seed, std::uint32_t count);

/// Small frames of real scenes, with every walk and option, on machines of the size that people study.
[[nodiscard]] std::deque<ComparedMachine> machines_of_real_frames();

}  // namespace marti::oracle
