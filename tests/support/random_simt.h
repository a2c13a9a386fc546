// Random machines of SIMT nodes.
#pragma once

#include <algorithm>
#include <array>
#include <sstream>
#include <string>

#include "processors/program/work_log.h"
#include "tests/support/random_machine.h"

namespace marti::test {

/// Any machine of SIMT nodes that can time the log. Its times are short, so that a program which takes every
/// cycle can keep up.
inline processors::machine::MachineConfig random_simt(Random& random,
                                                      const processors::program::WorkLog& log) {
  using namespace processors::machine;
  MachineConfig machine = random_machine(random, 1);
  machine.kind = NodeKind::simt;
  machine.clusters = static_cast<std::uint32_t>(pick(random, 1, 2));
  machine.nodes = static_cast<std::uint32_t>(pick(random, 1, machine.clusters == 1 ? 5 : 2));
  machine.clock = sim::Clock::from_period(pick(random, 10, 40));
  machine.operations = {pick(random, 0, 4) / 4, pick(random, 0, 4) / 4, 0, 0, pick(random, 0, 3) / 3,
                        pick(random, 0, 3) / 3, pick(random, 0, 3) / 3, 0};
  machine.pixels = pick(random, 0, 3) == 0 ? Pixels::collected : Pixels::written;
  SimtConfig& simt = machine.simt;
  simt.lanes = static_cast<std::uint32_t>(random() % 4 == 0 ? pick(random, 1, 64) : pick(random, 1, 12));
  simt.warps = static_cast<std::uint32_t>(pick(random, 1, 8));
  simt.issue = static_cast<std::uint32_t>(pick(random, 1, 3));
  simt.reconverge = static_cast<Reconverge>(pick(random, 0, 1));
  simt.ports = static_cast<std::uint32_t>(pick(random, 1, 3));
  simt.mshrs = static_cast<std::uint32_t>(pick(random, 1, 16));
  RtUnitConfig& rt = machine.rt;
  rt.warps = static_cast<std::uint32_t>(pick(random, 0, 4));
  rt.scheduler = static_cast<RtScheduler>(pick(random, 0, 2));
  rt.coalesce = static_cast<RtCoalesce>(pick(random, 0, 2));
  for (std::int64_t* const cycles :
       {&rt.box_cycles, &rt.transform_cycles, &rt.leaf_cycles, &rt.triangle_cycles, &rt.quadric_cycles}) {
    *cycles = random() % 3 == 0 ? 0 : pick(random, 0, 20);
  }
  rt.box_units = static_cast<std::uint32_t>(pick(random, 0, 4));
  rt.triangle_units = static_cast<std::uint32_t>(pick(random, 0, 4));
  if (machine.cache.organisation == CacheOrganisation::none) {
    machine.cache.organisation = CacheOrganisation::unified;
  }
  while (machine.cache.cache.line < 16) {  // shorter ones make records of very many lines
    machine.cache.cache.line *= 2;
    machine.cache.cache.size *= 2;
    for (std::uint64_t& size : machine.cache.split_sizes) {
      size *= 2;
    }
  }
  machine.cache.hit_cycles = random() % 4 == 0 ? pick(random, 0, 20) : pick(random, 0, 3);
  if (random() % 3 == 0) {
    simt.sector = std::max(4U, machine.cache.cache.line >> pick(random, 0, 3));
  }
  if (random() % 3 == 0) {  // caches that are no bottleneck
    machine.cache.cache.size *= 16;
    for (std::uint64_t& size : machine.cache.split_sizes) {
      size *= 16;
    }
  }
  if (machine.placement == Placement::distributed) {
    machine.placement = Placement::shared;
  }
  if (accel::walks_bvh(log.traversal)) {
    machine.layout.leaf = static_cast<memory::LeafLayout>(pick(random, 0, 1));
  }
  if (log.order == accel::WalkOrder::treelet_first) {  // at most log.treelet_records of a log's own layout
    machine.layout.node_order = memory::NodeOrder::treelets;
    machine.layout.treelet_bytes =
        static_cast<std::uint32_t>(log.treelet_records * machine.layout.node_stride());
  }
  const bool treelets = machine.layout.node_order == memory::NodeOrder::treelets;
  if (treelets && random() % 3 == 0) {
    rt.scheduler = RtScheduler::treelet;
  }
  if (rt.warps > 0 && log.has_meets() && random() % 3 == 0) {
    rt.share = RtShare::warp;
  }
  if (rt.warps > 0 && machine.placement != Placement::replicated) {
    const bool stacks = log.has_entered() && rt.share == RtShare::none;
    if (stacks && random() % 2 == 0) {
      machine.prefetch.stack = static_cast<std::uint32_t>(pick(random, 1, 6));
    }
    if (stacks && machine.reference_bytes() >= stack_entry_bytes && random() % 2 == 0) {
      rt.stack = static_cast<std::uint32_t>(pick(random, 1, 4));
    }
    machine.prefetch.treelet = treelets && random() % 2 == 0;
    machine.prefetch.queue = static_cast<std::uint32_t>(pick(random, 1, random() % 2 == 0 ? 4 : 40));
  }
  if (rt.warps > 0 && random() % 3 == 0) {
    rt.sort = static_cast<RaySort>(pick(random, 1, 3));
    rt.sort_rays = static_cast<std::uint32_t>(random() % 2 == 0 ? pick(random, 1, 12) : pick(random, 1, 100));
    rt.sort_cycles = pick(random, 0, 12);
  }
  if (random() % 3 == 0) {
    machine.layout.section_alignment = 1U << pick(random, 0, 4);  // kinds of record share lines
  }
  machine.layout.pixel_bytes = static_cast<std::uint32_t>(pick(random, 1, 8));
  machine.packets.width = static_cast<std::uint32_t>(pick(random, 1, 8));
  machine.host.latency_cycles = pick(random, 0, 9);
  add_random_second_level(random, machine);
  add_random_dram(random, machine);
  if (machine.banks.dram) {
    machine.banks.dram->period = pick(random, 1, 6);
  }
  return machine;
}

/// What tells one such machine from another, for messages.
inline std::string describe_simt(const processors::machine::MachineConfig& machine) {
  using namespace processors::machine;
  std::ostringstream text;
  const auto value = [&text](const char* name, const auto& is) { text << name << " " << is << ", "; };
  const auto choice = [&text](const char* name, const auto& names, auto is) {
    text << name << " " << names[static_cast<std::size_t>(is)] << ", ";
  };
  value("clusters", machine.clusters);
  value("nodes", machine.nodes);
  value("period", machine.clock.period());
  value("lanes", machine.simt.lanes);
  value("warps", machine.simt.warps);
  value("issue", machine.simt.issue);
  choice("reconverge", reconverge_names, machine.simt.reconverge);
  value("rt.warps", machine.rt.warps);
  choice("scheduler", rt_scheduler_names, machine.rt.scheduler);
  choice("coalesce", rt_coalesce_names, machine.rt.coalesce);
  text << "cycles of a box " << machine.rt.box_cycles << ", transform " << machine.rt.transform_cycles
       << ", leaf " << machine.rt.leaf_cycles << ", triangle " << machine.rt.triangle_cycles << ", quadric "
       << machine.rt.quadric_cycles << ", ";
  value("box_units", machine.rt.box_units);
  value("triangle_units", machine.rt.triangle_units);
  choice("cache", cache_organisation_names, machine.cache.organisation);
  value("line", machine.cache.cache.line);
  value("sector", machine.simt.sector);
  choice("replacement", memory::replacement_names, machine.cache.cache.replacement);
  value("size", machine.cache.cache.size);
  value("hit_cycles", machine.cache.hit_cycles);
  value("ports", machine.simt.ports);
  value("mshrs", machine.simt.mshrs);
  value("rt.stack", machine.rt.stack);
  choice("rt.share", rt_share_names, machine.rt.share);
  choice("rt.sort", ray_sort_names, machine.rt.sort);
  value("rt.sort_rays", machine.rt.sort_rays);
  value("rt.sort_cycles", machine.rt.sort_cycles);
  value("prefetch.stack", machine.prefetch.stack);
  value("prefetch.treelet", machine.prefetch.treelet);
  value("queue", machine.prefetch.queue);
  choice("node_order", memory::node_order_names, machine.layout.node_order);
  value("treelet", machine.layout.treelet_bytes);
  choice("l2", second_level_names, machine.l2.sharing);
  value("l2.hit_cycles", machine.l2.hit_cycles);
  choice("placement", placement_names, machine.placement);
  choice("interconnect", std::array{"ideal", "bus", "crossbar"}, machine.interconnect.kind);
  choice("mode", std::array{"held", "split"}, machine.interconnect.mode);
  choice("arbitration", memory::arbitration_names, machine.interconnect.arbitration);
  value("dram", machine.banks.dram
                    ? (machine.banks.dram->policy == memory::DramPolicy::fcfs ? "fcfs" : "frfcfs")
                    : "none");
  choice("pixels", pixels_names, machine.pixels);
  value("write_buffer", machine.write_buffer);
  choice("leaf", memory::leaf_layout_names, machine.layout.leaf);
  text << "packets " << machine.packets.width << " x " << machine.packets.height << ", ";
  choice("assignment", assignment_names, machine.host.assignment);
  text << "latency " << machine.host.latency_cycles;
  return text.str();
}

}  // namespace marti::test
