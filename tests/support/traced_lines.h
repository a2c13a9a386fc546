// The references that nodes make to their caches for a log, in order, worked out from the rules alone.
#pragma once

#include <cstdint>
#include <vector>

#include "tests/support/naive_program.h"

namespace marti::test {

struct TracedLine {
  memory::RecordKind kind;
  std::uint32_t line;
  std::uint32_t ray;    ///< operand of the `ray` step it belongs to
  std::uint32_t level;  ///< of the tree node; 0 for materials and texels
};

/// The references of node `node` of a machine whose packets are dealt out interleaved, in order.
inline std::vector<TracedLine> trace_node(const processors::program::WorkLog& log,
                                          const processors::machine::MachineConfig& machine,
                                          std::uint32_t node) {
  const NaiveProgram program(log, machine);
  const processors::machine::PacketList packets(log.width, log.height, machine.packets);
  std::vector<TracedLine> trace;
  for (std::uint64_t packet = node; packet < packets.size(); packet += machine.all_nodes()) {
    const processors::machine::Packet place = packets[packet];
    for (std::uint32_t y = place.y0; y < place.y1; ++y) {
      for (std::uint32_t x = place.x0; x < place.x1; ++x) {
        const auto words = log.pixel(x, y);
        std::uint32_t ray = 0;
        for (std::size_t at = 0; at < words.size(); at += processors::program::step_words(&words[at])) {
          ray = processors::program::step_of(words[at]) == processors::program::Step::ray
                    ? processors::program::operand_of(words[at])
                    : ray;
          for (const NaiveAction& action : program.actions_of(&words[at], ray)) {
            if (action.what == NaiveAction::What::refer) {
              const auto line = static_cast<std::uint32_t>(action.address / machine.cache.cache.line);
              trace.push_back({action.kind, line, action.ray, action.level});
            }
          }
        }
      }
    }
  }
  return trace;
}

}  // namespace marti::test
