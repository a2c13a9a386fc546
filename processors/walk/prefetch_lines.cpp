#include "processors/walk/prefetch_lines.h"

#include <bit>

namespace marti::processors::walk {

PrefetchLines::PrefetchLines(const ReplayInput& input, std::uint32_t line_bytes)
    : input_(input),
      instances_(accel::has_instances(input.log.topology)),
      shift_(static_cast<unsigned>(std::countr_zero(line_bytes))) {}

std::optional<std::uint32_t> PrefetchLines::next(memory::RecordKind kind, std::uint32_t line) const {
  const memory::Address end = input_.layout.base(kind) + input_.layout.section_bytes(kind);
  const memory::Address begin = (memory::Address{line} + 1) << shift_;
  return begin < end ? std::optional(line + 1) : std::nullopt;
}

}  // namespace marti::processors::walk
