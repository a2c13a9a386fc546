#include "studies/sweep/work/stripped_log_cache.h"

#include <algorithm>

#include "sim/error.h"

namespace marti::studies {

std::shared_ptr<const processors::StrippedLog> StrippedLogCache::get(
    std::size_t frame, const std::shared_ptr<const processors::WorkLog>& log,
    const processors::MachineConfig& machine, std::size_t sharing, std::span<const std::uint32_t> ways) {
  const std::string key = processors::StrippedLog::key_of(machine);
  const bool lru = !ways.empty() && ways.back() != 0;
  if (key.empty() || sharing < (lru ? fewest_machines : fewest_without_lru)) {
    return nullptr;
  }
  std::shared_ptr<Entry> entry;
  {
    const std::lock_guard lock(mutex_);
    const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const std::shared_ptr<Entry>& e) {
      return e->frame == frame && e->key == key;
    });
    if (found != entries_.end()) {
      entries_.splice(entries_.begin(), entries_, found);
    } else {
      entries_.push_front(std::make_shared<Entry>());
      entries_.front()->frame = frame;
      entries_.front()->key = key;
      if (entries_.size() > most_kept) {
        entries_.pop_back();
      }
    }
    entry = entries_.front();
  }
  const std::lock_guard making(entry->making);
  if (!entry->made) {
    entry->logs = processors::StrippedLog::make(*log, machine, ways, most_bytes_ / most_kept);
    entry->made = true;
  }
  const auto wanted = std::find(ways.begin(), ways.end(), processors::StrippedLog::ways_of(machine));
  sim::ensure(wanted != ways.end(), "a log is not stripped for a machine of its batch");
  return entry->logs[static_cast<std::size_t>(wanted - ways.begin())];
}

void StrippedLogCache::drop(std::size_t frame) {
  const std::lock_guard lock(mutex_);
  entries_.remove_if([frame](const std::shared_ptr<Entry>& entry) { return entry->frame == frame; });
}

}  // namespace marti::studies
