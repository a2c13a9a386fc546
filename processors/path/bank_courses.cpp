#include "processors/path/bank_courses.h"

#include <algorithm>

namespace marti::processors::path {

BankCourses::BankCourses(const memory::BankConfig& config, const memory::Interconnect& memory,
                         PathPieces& pieces)
    : pieces_(pieces),
      memory_(memory),
      interleave_(config.interleave),
      access_(config.clock.cycles(config.access_cycles)),
      busy_(config.clock.cycles(config.busy_cycles)),
      banks_(config.banks()) {
  if (config.dram) {
    dram_.emplace(*config.dram);
  }
  if (config.cache) {
    hit_ = config.cache->clock.cycles(config.cache->hit_cycles);
    line_ = config.cache->cache.line;
  }
}

PathTip BankCourses::access(memory::Address address, std::uint32_t bytes, bool write, const PathTip& arriving,
                            const PathOwner& owner) {
  if (dram_) {
    const sim::Ticks ready = dram_->access(address, bytes, write, arriving.end()).ready;
    return pieces_.append(arriving, ready - arriving.end(), owner, PathKind::bank_access);
  }
  PathTip& bank = banks_[bank_of(address)];
  const PathTip before = later_of(arriving, bank);
  PathTip ready = pieces_.append(before, access_, owner, PathKind::bank_access);
  bank = busy_ < access_ ? pieces_.append(before, busy_, owner, PathKind::bank_access)
                         : pieces_.append(ready, busy_ - access_, owner, PathKind::bank_access);
  return ready;
}

PathTip BankCourses::read(memory::Address address, std::uint32_t bytes, const PathTip& arriving,
                          const PathOwner& owner) {
  if (!hit_) {
    return access(address, bytes, false, arriving, owner);
  }
  const memory::Address line = address / line_;
  const std::int64_t hits = memory_.cache_statistics()->lookups.hits;
  if (hits == hits_) {
    PathTip ready = access(address, bytes, false, arriving, owner);
    if (coming_.size() >= most_coming_) {
      forget_arrived(arriving.end());
      most_coming_ = std::max<std::size_t>(64, 2 * coming_.size());
    }
    coming_.insert_or_assign(line, ready);
    return ready;
  }
  hits_ = hits;
  const auto coming = coming_.find(line);
  if (coming != coming_.end() && coming->second.end() - *hit_ > arriving.end()) {
    return coming->second;
  }
  return pieces_.append(arriving, *hit_, owner, PathKind::shared_cache);
}

void BankCourses::forget_arrived(sim::Ticks now) {
  std::erase_if(coming_, [&](const auto& line) { return line.second.end() <= now; });
}

}  // namespace marti::processors::path
