#include "processors/walk/attribution.h"

#include <algorithm>

namespace marti::processors::walk {

AttributionCounts& Attribution::at(memory::RecordKind record, Origin origin) {
  const std::size_t level = std::min<std::uint32_t>(origin.level, levels - 1);
  const std::size_t work = origin.ray * std::size_t{2} + (origin.splitting ? 1 : 0);
  const std::size_t cell = (work * levels + level) * memory::record_kinds + static_cast<std::size_t>(record);
  if (cell >= cells_.size()) {
    cells_.resize((work + 1) * levels * memory::record_kinds);
  }
  return cells_[cell];
}

void Attribution::wait(memory::RecordKind record, Origin origin, const memory::Service& service) {
  AttributionCounts& counts = at(record, origin);
  counts.interconnect_wait += service.wait_interconnect;
  counts.transfer += service.transfer;
  counts.bank_wait += service.wait_bank;
  counts.bank_access += service.bank;
}

std::vector<AttributionRow> Attribution::rows() const {
  std::vector<AttributionRow> rows;
  for (std::size_t cell = 0; cell < cells_.size(); ++cell) {
    if (cells_[cell].references == 0 && cells_[cell].waited() == 0) {
      continue;
    }
    const std::size_t place = cell / memory::record_kinds;
    const std::size_t work = place / levels;
    const std::size_t ray = work / 2;
    rows.push_back({static_cast<memory::RecordKind>(cell % memory::record_kinds),
                    static_cast<std::uint32_t>(place % levels),
                    program::ray_kind_of(static_cast<std::uint32_t>(ray)),
                    program::bounce_of(static_cast<std::uint32_t>(ray)), work % 2 == 1, cells_[cell]});
  }
  return rows;
}

}  // namespace marti::processors::walk
