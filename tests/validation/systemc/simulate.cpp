#include "tests/validation/systemc/simulate.h"

#include <ctime>
#include <exception>
#include <memory>
#include <string>
#include <systemc>

#include "sim/error.h"

namespace {

using marti::oracle::Job;
using marti::oracle::Machine;
using marti::oracle::Simulation;

// Passed between simulate() and sc_main(), which SystemC calls.
struct Exchange {
  std::span<const Job> jobs;
  Simulation simulation;
  std::exception_ptr error;
};
Exchange* exchange = nullptr;

void run() {
  std::vector<std::unique_ptr<Machine>> machines;
  for (const Job& job : exchange->jobs) {
    const std::string name = "machine_" + std::to_string(machines.size());
    machines.push_back(std::make_unique<Machine>(name.c_str(), *job.log, *job.config));
  }
  sc_core::sc_start(sc_core::SC_ZERO_TIME);  // builds what SystemC builds before the first event
  const std::clock_t start = std::clock();
  sc_core::sc_start();
  exchange->simulation.seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  for (const auto& machine : machines) {
    exchange->simulation.machines.push_back(machine->figures());
  }
}

}  // namespace

int sc_main(int /*argc*/, char** /*argv*/) {
  try {
    run();
  } catch (...) {
    exchange->error = std::current_exception();
    return 1;
  }
  return 0;
}

namespace marti::oracle {

Simulation simulate(std::span<const Job> jobs) {
  sim::ensure(exchange == nullptr, "SystemC can simulate once in a process");
  static Exchange the_exchange;
  exchange = &the_exchange;
  exchange->jobs = jobs;
  std::string name = "systemc";
  char* arguments[] = {name.data(), nullptr};
  const int status = sc_core::sc_elab_and_sim(1, arguments);
  if (exchange->error) {
    std::rethrow_exception(exchange->error);
  }
  sim::ensure(status == 0, "SystemC has failed");
  return std::move(exchange->simulation);
}

}  // namespace marti::oracle
