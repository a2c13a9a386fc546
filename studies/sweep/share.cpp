#include "studies/sweep/share.h"

#include <sched.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <string_view>
#include <tuple>
#include <vector>

#include "sim/error.h"
#include "sim/parse_number.h"
#include "sim/shown.h"

namespace marti::studies::sweep {

namespace {

// The number that the environment variable begins with.
std::optional<std::uint32_t> number_in(const char* variable) {
  const char* const value = std::getenv(variable);
  if (value == nullptr) {
    return std::nullopt;
  }
  const std::string_view text(value);
  return sim::parse_number<std::uint32_t>(text.substr(0, text.find_first_of("(,")));
}

bool bound_to_some_processors() {
  cpu_set_t set;
  CPU_ZERO(&set);
  return sched_getaffinity(0, sizeof set, &set) == 0 && CPU_COUNT(&set) < sysconf(_SC_NPROCESSORS_ONLN);
}

// Machines that one process should time together.
struct Hand {
  double rays = 0.0;        // that are traced for them, each machine's counted
  std::uint64_t nodes = 0;  // of the first of them
  std::vector<std::size_t> machines;
};

std::vector<Hand> hands_of(const SweepPlan& plan, bool whole_frames) {
  std::map<std::size_t, Hand> hands;
  for (std::size_t i = 0; i < plan.machines.size(); ++i) {
    const SweepMachine& machine = plan.machines[i];
    const double rays = plan.frames[machine.frame].rays();
    Hand& hand = hands[whole_frames ? machine.frame : machine.timing];
    if (hand.machines.empty()) {
      hand.rays = whole_frames ? rays : 0.0;  // the frame itself takes about as long as one of its machines
      hand.nodes = machine.config.all_nodes();
    }
    hand.rays += whole_frames || hand.machines.empty() ? rays : 0.0;
    hand.machines.push_back(i);
  }
  std::vector<Hand> all;
  for (auto& [group, hand] : hands) {
    all.push_back(std::move(hand));
  }
  return all;
}

}  // namespace

std::string Share::text() const { return std::to_string(number) + " of " + std::to_string(of); }

Share share_named(const std::string& text) {
  const std::size_t slash = std::min(text.find('/'), text.size());
  const auto number = sim::parse_number<std::uint32_t>(std::string_view(text).substr(0, slash));
  const auto of =
      sim::parse_number<std::uint32_t>(std::string_view(text).substr(std::min(slash + 1, text.size())));
  if (!number || !of || *number == 0 || *number > *of) {
    throw sim::UserError("--share: " + sim::shown(text) + " is no share; the third of eight is 3/8");
  }
  return {*number, *of};
}

std::optional<Share> share_of_launcher() {
  // The innermost launcher first: an mpirun inside a Slurm job has Slurm's variables as well.
  constexpr std::pair<const char*, const char*> launchers[] = {
      {"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"},
      {"PMI_RANK", "PMI_SIZE"},
      {"SLURM_PROCID", "SLURM_STEP_NUM_TASKS"}};
  for (const auto& [number, of] : launchers) {
    const std::optional<std::uint32_t> processes = number_in(of);
    if (!processes || *processes == 0) {
      continue;
    }
    const std::optional<std::uint32_t> process = number_in(number);
    if (*processes == 1 || !process || *process >= *processes) {
      return std::nullopt;
    }
    return Share{*process + 1, *processes};
  }
  return std::nullopt;
}

std::uint32_t processes_beside() {
  if (!share_of_launcher()) {
    return 1;
  }
  for (const char* const variable :
       {"OMPI_COMM_WORLD_LOCAL_SIZE", "MPI_LOCALNRANKS", "SLURM_STEP_TASKS_PER_NODE"}) {
    if (const std::optional<std::uint32_t> processes = number_in(variable); processes && *processes != 0) {
      return *processes;
    }
  }
  return 1;
}

unsigned threads_beside() {
  const auto mine = static_cast<unsigned>(tbb::this_task_arena::max_concurrency());
  return bound_to_some_processors() ? mine : std::max(1U, mine / processes_beside());
}

SweepPlan part_of(const SweepPlan& plan, Share share, const std::function<bool(const SweepMachine&)>& done) {
  constexpr std::size_t many_frames = 4;  // for each process: fewer could not be dealt evenly
  std::vector<Hand> hands = hands_of(plan, plan.frames.size() >= many_frames * share.of);
  // What costs the same goes by the key, which is as good as chance: in the plan's order each process could
  // get other values of an axis.
  std::ranges::sort(hands, [&](const Hand& a, const Hand& b) {
    return std::tie(b.rays, b.nodes, plan.machines[b.machines.front()].key) <
           std::tie(a.rays, a.nodes, plan.machines[a.machines.front()].key);
  });
  std::vector<std::size_t> mine;
  for (std::size_t hand = share.number - 1; hand < hands.size(); hand += share.of) {
    std::ranges::copy_if(hands[hand].machines, std::back_inserter(mine),
                         [&](std::size_t machine) { return !done(plan.machines[machine]); });
  }
  std::ranges::sort(mine);
  SweepPlan part;
  part.file = plan.file;
  part.axes = plan.axes;
  part.question = plan.question;
  std::optional<std::size_t> frame;  // of the plan, that the part had last
  for (const std::size_t machine : mine) {
    if (frame != plan.machines[machine].frame) {
      frame = plan.machines[machine].frame;
      part.frames.push_back(plan.frames[*frame]);
    }
    part.machines.push_back(plan.machines[machine]);
    part.machines.back().frame = part.frames.size() - 1;
  }
  return part;
}

}  // namespace marti::studies::sweep
