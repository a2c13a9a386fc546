#include "processors/replay/flow_conservation.h"
#include "processors/walk/law.h"

#include <array>
#include <string>
#include <utility>

#include "sim/error.h"

namespace marti::processors::replay {

namespace {

std::int64_t samples_with_rays(const program::WorkLog& log) {
  std::int64_t pixels = 0;
  for (const program::LogRow& row : log.rows) {
    for (std::size_t x = 1; x < row.begin.size(); ++x) {
      pixels += row.begin[x] != row.begin[x - 1] ? 1 : 0;
    }
  }
  return pixels * log.samples;
}

void check_steps(const program::LogTotals& totals, const cost::StepCounts& steps) {
  const std::array<std::pair<std::int64_t, std::uint64_t>, 16> pairs = {{
      {steps.camera_rays, totals.rays[0]},
      {steps.shadow_rays, totals.rays[1]},
      {steps.reflection_rays, totals.rays[2]},
      {steps.refraction_rays, totals.rays[3]},
      {steps.diffuse_rays, totals.rays[4]},
      {steps.branches, totals.branches},
      {steps.transforms, totals.transforms},
      {steps.leaves, totals.leaves},
      {steps.tests, totals.tests},
      {steps.lookups, totals.lookups},
      {steps.shades, totals.shades},
      {steps.lights, totals.lights},
      {steps.texels, totals.texels},
      {steps.cuts, totals.cuts},
      {steps.passes, totals.passes},
      {steps.any_hits, totals.any_hits},
  }};
  for (const auto& [taken, logged] : pairs) {
    walk::require_equal(taken, static_cast<std::int64_t>(logged), "the steps taken are those of the log");
  }
  walk::require_equal(steps.pixels, 0, "pixels are finished by the host");
}

}  // namespace

void check_flow_conservation(const program::WorkLog& log, const machine::MachineConfig& config,
                             const MachineResult& result) {
  const program::LogTotals totals = program::totals_of(log);
  const flow::FlowResult& flow = result.flow;
  check_steps(totals, result.steps());

  flow::FlowCounts sum;
  for (const flow::FlowCounts& node : flow.nodes) {
    walk::require_equal(node.taken + node.made, node.passed_on + node.ended,
                        "what comes to a node leaves it");
    sim::merge(sum, node);
  }
  std::int64_t messages = 0;
  std::int64_t bytes = 0;
  for (const memory::NetworkStatistics& network : flow.networks) {
    messages += network.messages;
    bytes += network.bytes;
  }
  const std::int64_t sent = result.host.requests;
  walk::require_equal(sent, samples_with_rays(log), "every camera ray is sent once");
  walk::require_equal(flow.rays, static_cast<std::int64_t>(totals.all_rays()),
                      "the rays made are those of the log");
  walk::require_equal(flow.rays, sent + sum.made, "rays come from the host or are made by nodes");
  walk::require_equal(flow.rays, sum.ended, "every ray ends");
  walk::require_equal(sum.contributions, flow.collected, "every contribution is collected");
  walk::require_equal(sent + sum.passed_on + sum.contributions, messages,
                      "every message to another node or the host goes through a network");
  walk::require_equal(sent * config.messages.ray_bytes + sum.bytes_sent, bytes,
                      "the networks carry the bytes that are sent");
}

}  // namespace marti::processors::replay
