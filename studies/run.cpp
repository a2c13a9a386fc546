#include <string>
#include <utility>

#include "sim/units.h"
#include "studies/machine_keys.h"
#include "studies/run_result.h"

namespace marti::studies {

namespace {

void refuse_beyond_memory(const sim::Config& config, const RunResult& result) {
  const std::uint64_t bytes = processors::host_bytes(result.machine);
  if (bytes > static_cast<std::uint64_t>(result.frame_config.memory_limit)) {
    config.fail("machine.nodes", "simulating these nodes and their caches takes about " +
                                     sim::print_size(static_cast<std::int64_t>(bytes >> 20U << 20U)) +
                                     ", more than host_machine.memory_limit = " +
                                     sim::print_size(result.frame_config.memory_limit));
  }
}

void refuse_several_frames(const sim::Config& config, const FrameRange& frames) {
  if (frames.count > 1) {
    config.fail("frames.count", std::to_string(frames.count) +
                                    " frames are asked for, but `marti run` renders one, that of "
                                    "frames.first; set frames.count = 1, or "
                                    "use `marti study frames`");
  }
}

}  // namespace

sim::Schema run_schema() {
  sim::Schema schema;
  declare_frame_keys(schema);
  declare_machine_keys(schema);
  return schema;
}

RunResult run(sim::Config& config) {
  RunResult result;
  result.config_name = config.name();
  result.frame_config = read_frame(config);
  refuse_several_frames(config, result.frame_config.frames);
  result.machine = read_machine(config);
  config.refuse_unused();
  refuse_beyond_memory(config, result);
  result.values = config.effective_values();

  result.functional = run_functional(result.frame_config);
  const processors::WorkLog& log = *result.functional.frame.log;
  result.timed = processors::replay(log, result.machine);
  sim::Ticks one_node_end = result.timed.end;
  if (result.machine.all_nodes() > 1 || result.machine.scheme != processors::Scheme::image) {
    // However the machine divides its work, one node has nobody to divide it with: it traces the image.
    processors::MachineConfig one = result.machine;
    one.scheme = processors::Scheme::image;
    if (result.machine.scheme == processors::Scheme::space) {
      one.placement = processors::Placement::replicated;  // in its own memory, where it has the whole scene
    }
    one.clusters = 1;
    one.nodes = 1;
    one_node_end = processors::replay(log, one).end;
  }
  result.scaling = scaling_of(one_node_end, result.timed.end, result.machine.all_nodes());
  result.finding = find_limit(result.machine, result.timed);
  return result;
}

}  // namespace marti::studies
