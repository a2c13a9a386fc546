// Shares of a sweep: which process has which, and that all processes together have each machine once.
#include "studies/sweep/share.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>
#include <string>

#include "studies/sweep/plan/sweep_keys.h"
#include "tests/support/user_error.h"

namespace marti::studies {

using namespace sweep;

namespace {

void forget_launchers() {
  for (const char* variable : {"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_LOCAL_SIZE",
                               "PMI_RANK", "PMI_SIZE", "MPI_LOCALNRANKS", "SLURM_PROCID",
                               "SLURM_STEP_NUM_TASKS", "SLURM_STEP_TASKS_PER_NODE", "SLURM_NTASKS"}) {
    unsetenv(variable);
  }
}

std::string launched() {
  const std::optional<Share> share = share_of_launcher();
  return share ? share->text() : "none";
}

TEST(ShareOfLauncher, IsThatOfTheInnermostLauncher) {
  forget_launchers();
  EXPECT_EQ(launched(), "none");
  setenv("SLURM_NTASKS", "8", 1);  // of a batch job, whose script is one process
  setenv("SLURM_PROCID", "0", 1);
  EXPECT_EQ(launched(), "none");
  EXPECT_EQ(processes_beside(), 1U);
  setenv("SLURM_STEP_NUM_TASKS", "8", 1);
  setenv("SLURM_STEP_TASKS_PER_NODE", "3(x2),2", 1);
  setenv("SLURM_PROCID", "2", 1);
  EXPECT_EQ(launched(), "3 of 8");
  EXPECT_EQ(processes_beside(), 3U);
  setenv("OMPI_COMM_WORLD_SIZE", "2", 1);  // mpirun inside a job
  setenv("OMPI_COMM_WORLD_LOCAL_SIZE", "2", 1);
  setenv("OMPI_COMM_WORLD_RANK", "0", 1);
  EXPECT_EQ(launched(), "1 of 2");
  EXPECT_EQ(processes_beside(), 2U);
  setenv("OMPI_COMM_WORLD_SIZE", "1", 1);
  EXPECT_EQ(launched(), "none");
  forget_launchers();
  for (const char* nonsense : {"", "x", "-2", "3x", "99999999999999"}) {
    setenv("PMI_RANK", "1", 1);
    setenv("PMI_SIZE", nonsense, 1);
    EXPECT_EQ(launched(), "none") << nonsense;
    setenv("PMI_RANK", nonsense, 1);
    setenv("PMI_SIZE", "2", 1);
    EXPECT_EQ(launched(), "none") << nonsense;
  }
  forget_launchers();
}

TEST(ShareNamed, IsANumberOfSeveral) {
  EXPECT_EQ(share_named("3/8").text(), "3 of 8");
  EXPECT_EQ(share_named("1/1").text(), "1 of 1");
  for (const char* wrong : {"", "/", "3", "3/", "/8", "0/8", "9/8", "0/0", "3/8/2", " 3/8", "-1/8", "a/b"}) {
    const std::string message = test::user_error_of([&] { static_cast<void>(share_named(wrong)); });
    EXPECT_NE(message.find("the third of eight is 3/8"), std::string::npos) << wrong << ": " << message;
  }
}

SweepPlan shared_plan(const std::string& axes) {
  sim::Config config = sim::Config::from_text(
      sweep_schema(), "[scene]\nsource = \"tetra:1\"\n[image]\nwidth = 8\nheight = 8\n[sweep.axes]\n" + axes,
      "sweep");
  return plan_sweep(config);
}

void expect_dealt(const SweepPlan& plan, std::uint32_t processes) {
  std::map<std::string, int> times;           // that a machine was dealt
  std::map<std::size_t, std::set<int>> with;  // the processes that have machines of a timing
  std::size_t least = plan.machines.size();
  std::size_t most = 0;
  for (std::uint32_t number = 1; number <= processes; ++number) {
    const SweepPlan part = part_of(plan, {number, processes}, [](const SweepMachine&) { return false; });
    std::set<std::size_t> used;
    for (const SweepMachine& machine : part.machines) {
      ++times[machine.key];
      with[machine.timing].insert(static_cast<int>(number));
      used.insert(machine.frame);
      const auto same = std::ranges::find(plan.machines, machine.key, &SweepMachine::key);
      EXPECT_EQ(part.frames.at(machine.frame).key, plan.frames[same->frame].key);
    }
    EXPECT_EQ(used.size(), part.frames.size()) << "a frame that no machine needs";
    least = std::min(least, part.machines.size());
    most = std::max(most, part.machines.size());
  }
  EXPECT_EQ(times.size(), plan.machines.size());
  for (const auto& [key, count] : times) {
    EXPECT_EQ(count, 1) << key;
  }
  for (const auto& [timing, numbers] : with) {
    EXPECT_EQ(numbers.size(), 1U) << "a replay is done twice";
  }
  EXPECT_LE(most - least, 8U);
}

TEST(PartOf, AllTogetherHaveEachMachineOnce) {
  // Some of these need one replay only: energies, and widths that move a line in as many beats.
  const SweepPlan plan = shared_plan(
      "image.max_depth = [1, 2]\nmachine.nodes = [1, 2, 3, 8]\ninterconnect.width = [16, 32, 64]\n"
      "cache.line = [32, 64]\n");
  const SweepPlan many_frames =
      shared_plan("image.width = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]\nmachine.nodes = [1, 2]\n");
  for (const std::uint32_t processes : {1U, 2U, 3U, 7U, 100U}) {
    expect_dealt(plan, processes);
    expect_dealt(many_frames, processes);
  }
}

TEST(PartOf, KeepsTheMachinesOfAFrameTogetherWhereThereAreManyFrames) {
  const SweepPlan plan =
      shared_plan("image.width = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]\nmachine.nodes = [1, 2]\n");
  std::size_t frames = 0;
  for (std::uint32_t number = 1; number <= 3; ++number) {
    frames += part_of(plan, {number, 3}, [](const SweepMachine&) { return false; }).frames.size();
  }
  EXPECT_EQ(frames, plan.frames.size()) << "a frame is traced by two processes";
}

TEST(PartOf, LeavesOutWhatIsDone) {
  const SweepPlan plan = shared_plan("machine.nodes = [1, 2, 3, 4, 5, 6]\n");
  const SweepPlan all = part_of(plan, {2, 2}, [](const SweepMachine&) { return false; });
  const SweepPlan rest = part_of(
      plan, {2, 2}, [&](const SweepMachine& machine) { return machine.key == all.machines.front().key; });
  EXPECT_EQ(rest.machines.size() + 1, all.machines.size());
  EXPECT_TRUE(part_of(plan, {2, 2}, [](const SweepMachine&) { return true; }).frames.empty());
}

}  // namespace
}  // namespace marti::studies
