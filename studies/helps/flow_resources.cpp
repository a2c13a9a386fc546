#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "studies/helps/better.h"
#include "studies/helps/resource_lists.h"

namespace marti::studies::helps {

namespace {

using processors::machine::MachineConfig;
using processors::machine::PipelineConfig;
using processors::machine::Scheme;

void add_stages(const Changer& changer, const MachineConfig& machine, std::vector<Resource>& resources) {
  constexpr std::array<std::pair<std::string_view, std::uint32_t PipelineConfig::*>,
                       processors::machine::pipeline_stages>
      stages = {{{"pipeline.search", &PipelineConfig::search},
                 {"pipeline.nearest", &PipelineConfig::nearest},
                 {"pipeline.shade", &PipelineConfig::shade}}};
  for (const auto& [grown, member] : stages) {
    const std::int64_t before = machine.pipeline.*member;
    const std::int64_t added = tenth_more(before) - before;
    std::vector<NewValue> values = {{"machine.nodes", machine.nodes + added}};
    for (const auto& [key, count] : stages) {
      const std::int64_t now = machine.pipeline.*count;
      values.push_back({key, key == grown ? now + added : now, now});
    }
    resources.push_back({std::string(grown), Part::nodes, changer.with(values), std::nullopt});
  }
}

void add_queues(const Changer& changer, const MachineConfig& machine, std::vector<Resource>& resources) {
  const bool pipeline = machine.scheme == Scheme::pipeline;
  const std::string section = pipeline ? "pipeline." : "space.";
  resources.push_back(more(changer, Part::queues, section + "queue"));
  // With 0 there are as many in flight as the queues allow.
  if ((pipeline ? machine.pipeline.in_flight : machine.space.in_flight) > 0) {
    Resource rays = more(changer, Part::queues, section + "in_flight");
    if (pipeline) {
      rays.best = changer.with(
          {{"pipeline.in_flight", std::int64_t{processors::machine::most_in_flight(machine.pipeline)}}});
    }
    resources.push_back(std::move(rays));
  }
}

}  // namespace

void add_flow(const Changer& changer, const MachineConfig& machine, std::vector<Resource>& resources) {
  const bool image = machine.scheme == Scheme::image;
  if (!image || machine.placement == processors::machine::Placement::distributed) {
    resources.push_back(faster_clock(changer, Part::network, "network.clock"));
    resources.push_back(fewer(changer, Part::network, "network.hop_cycles"));
    if (machine.network.kind != memory::NetworkKind::ideal) {
      resources.push_back(wider(changer, Part::network, "network.width"));
    }
  }
  if (image) {
    return;
  }
  resources.push_back(fewer(changer, Part::messages, "messages.ray", 1));
  resources.push_back(fewer(changer, Part::messages, "messages.contribution", 1));
  resources.push_back(fewer(changer, Part::messages, "messages.send_cycles"));
  resources.push_back(fewer(changer, Part::messages, "messages.receive_cycles"));
  add_queues(changer, machine, resources);
  if (machine.scheme == Scheme::pipeline) {
    add_stages(changer, machine, resources);
  } else {
    resources.push_back({"space.level", Part::regions,
                         changer.with({{"space.level", std::int64_t{machine.space.level} + 1}}), std::nullopt,
                         false});
  }
}

}  // namespace marti::studies::helps
