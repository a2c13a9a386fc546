// How a process learns that it is one of several, and its message when it was built without MPI.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "studies/sweep/ranks/launch.h"
#include "studies/sweep/ranks/ranks.h"
#include "tests/support/user_error.h"

namespace marti::studies {

using namespace sweep;

namespace {

void forget_launchers() {
  for (const char* variable : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS", "SLURM_NTASKS"}) {
    unsetenv(variable);
  }
}

TEST(Launch, OnlyAJobOfSeveralProcessesCounts) {
  forget_launchers();
  EXPECT_EQ(launched_processes(), 1U);
  setenv("SLURM_NTASKS", "8", 1);  // of a batch job, whose script is one process
  EXPECT_EQ(launched_processes(), 1U);
  setenv("SLURM_STEP_NUM_TASKS", "8", 1);
  EXPECT_EQ(launched_processes(), 8U);
  setenv("OMPI_COMM_WORLD_SIZE", "2", 1);  // mpirun inside a job
  EXPECT_EQ(launched_processes(), 2U);
  setenv("OMPI_COMM_WORLD_SIZE", "1", 1);
  EXPECT_EQ(launched_processes(), 1U);
  for (const char* nonsense : {"", "x", "-2", "3x", "99999999999999"}) {
    forget_launchers();
    setenv("PMI_SIZE", nonsense, 1);
    EXPECT_EQ(launched_processes(), 1U) << nonsense;
  }
  forget_launchers();
}

TEST(Launch, WithoutMpiSeveralProcessesAreRefused) {
  setenv("OMPI_COMM_WORLD_SIZE", "4", 1);
  const std::string message = marti::test::user_error_of([] { const Ranks ranks; });
  EXPECT_TRUE(message.starts_with("4 processes were started together")) << message;
  EXPECT_NE(message.find("MARTI_MPI=ON"), std::string::npos) << message;
  end_all_ranks(2);  // there are none
  forget_launchers();
}

}  // namespace
}  // namespace marti::studies
