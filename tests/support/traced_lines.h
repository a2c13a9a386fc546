// The references that nodes make to their caches for a log, in order, worked out from the rules alone.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "memory/layout.h"
#include "processors/machine/machine_config.h"
#include "processors/machine/packets.h"
#include "processors/program/work_log.h"
#include "processors/walk/node_order.h"

namespace marti::test {

struct TracedLine {
  memory::RecordKind kind;
  std::uint32_t line;
  std::uint32_t ray;    ///< operand of the `ray` step it belongs to
  std::uint32_t level;  ///< of the tree node; 0 for materials and texels
};

/// Appends the lines that a pixel's steps touch.
inline void trace_pixel(const processors::WorkLog& log, const memory::Layout& layout,
                        std::span<const std::uint32_t> rank, std::uint32_t line_bytes,
                        std::span<const std::uint32_t> words, std::vector<TracedLine>& trace) {
  using memory::RecordKind;
  using processors::Step;
  std::uint32_t ray = 0;
  const auto touch = [&](RecordKind kind, std::uint64_t first, std::uint64_t records, std::uint32_t level) {
    if (records != 0) {
      const memory::Address begin = layout.address(kind, first);
      const memory::Address last = begin + records * layout.record_bytes(kind, first) - 1;
      for (memory::Address line = begin / line_bytes; line <= last / line_bytes; ++line) {
        trace.push_back({kind, static_cast<std::uint32_t>(line), ray, level});
      }
    }
  };
  for (std::size_t at = 0; at < words.size(); at += processors::step_words(words.data() + at)) {
    const std::uint32_t operand = processors::operand_of(words[at]);
    const auto node = [&] {
      const std::uint32_t level = log.topology.nodes[operand].level;
      touch(RecordKind::node, rank.empty() ? operand : rank[operand], 1, level);
      return level;
    };
    const Step step = processors::step_of(words[at]);
    switch (step) {
      case Step::branch:
      case Step::cut:
        node();
        break;
      case Step::leaf:
      case Step::partial_leaf:
      case Step::mailed_leaf: {
        const std::uint32_t level = node();
        const accel::TopologyNode& leaf = log.topology.nodes[operand];
        const std::uint32_t entries = step == Step::leaf ? leaf.count : words[at + 1];
        touch(RecordKind::list, leaf.first, entries, level);
        for (std::uint32_t entry = 0; entry < entries; ++entry) {
          if (step != Step::mailed_leaf || ((words[at + 2 + entry / 32] >> (entry % 32)) & 1U) != 0) {
            touch(RecordKind::primitive, log.topology.entries[leaf.first + entry], 1, level);
          }
        }
        break;
      }
      case Step::shade:
      case Step::pass:
        touch(RecordKind::material, operand, 1, 0);
        break;
      case Step::texel:
        touch(RecordKind::texel, log.texture_begin[operand] + words[at + 1], 1, 0);
        break;
      case Step::ray:
        ray = operand;
        break;
      case Step::light:
        break;
    }
  }
}

/// The references of node `node` of a machine whose packets are dealt out interleaved, in order.
inline std::vector<TracedLine> trace_node(const processors::WorkLog& log,
                                          const processors::MachineConfig& machine, std::uint32_t node) {
  const memory::Layout layout(
      machine.layout,
      {log.topology.nodes.size(), log.topology.entries.size(), log.primitives, log.materials,
       log.texture_begin.back(), std::uint64_t{log.width} * log.height},
      log.quadrics.size());
  std::vector<std::uint32_t> rank;
  if (machine.layout.node_order == memory::NodeOrder::depth_first) {
    rank = processors::depth_first_rank(log.topology);
  }
  const processors::PacketList packets(log.width, log.height, machine.packets);
  std::vector<TracedLine> trace;
  for (std::uint64_t packet = node; packet < packets.size(); packet += machine.all_nodes()) {
    const processors::Packet place = packets[packet];
    for (std::uint32_t y = place.y0; y < place.y1; ++y) {
      for (std::uint32_t x = place.x0; x < place.x1; ++x) {
        trace_pixel(log, layout, rank, machine.cache.cache.line, log.pixel(x, y), trace);
      }
    }
  }
  return trace;
}

}  // namespace marti::test
