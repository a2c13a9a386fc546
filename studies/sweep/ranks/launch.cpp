#include "studies/sweep/ranks/launch.h"

#include <charconv>
#include <cstdlib>
#include <string_view>
#include <system_error>

namespace marti::studies::sweep {

namespace {

// A number in an environment variable; 0 where there is none.
std::uint32_t number_in(const char* variable) {
  const char* const value = std::getenv(variable);
  std::uint32_t number = 0;
  if (value != nullptr) {
    const std::string_view text(value);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{} || end != text.data() + text.size()) {
      return 0;
    }
  }
  return number;
}

}  // namespace

std::uint32_t launched_processes() {
  // The innermost launcher first: an mpirun inside a Slurm job has Slurm's variables as well.
  // Open MPI's mpirun; MPICH's, Intel MPI's and Slurm's PMI; srun, for the processes of a step.
  for (const char* const variable : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"}) {
    if (const std::uint32_t processes = number_in(variable); processes != 0) {
      return processes;
    }
  }
  return 1;
}

}  // namespace marti::studies::sweep
