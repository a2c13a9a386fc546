#include "studies/sweep/ranks/launch.h"

#include <cstdlib>

#include "sim/parse_number.h"

namespace marti::studies::sweep {

namespace {

// A number in an environment variable; 0 where there is none.
std::uint32_t number_in(const char* variable) {
  const char* const value = std::getenv(variable);
  return value != nullptr ? sim::parse_number<std::uint32_t>(value).value_or(0) : 0;
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
