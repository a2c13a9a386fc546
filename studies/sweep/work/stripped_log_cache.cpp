#include "studies/sweep/work/stripped_log_cache.h"

#include <algorithm>

#include "sim/error.h"

namespace marti::studies::sweep {

std::shared_ptr<const processors::walk::StrippedLog> StrippedLogCache::get(
    std::size_t frame, const std::shared_ptr<const processors::program::WorkLog>& log,
    const processors::machine::MachineConfig& machine, std::size_t sharing,
    std::span<const std::uint32_t> ways) {
  using processors::walk::StrippedLog;
  const std::string key = StrippedLog::key_of(machine);
  if (key.empty() || !pays(sharing, std::ranges::any_of(ways, [](auto each) { return each != 0; }))) {
    return nullptr;
  }
  std::shared_ptr<Entry> entry;
  {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find_if(
        entries_, [&](const std::shared_ptr<Entry>& e) { return e->frame == frame && e->key == key; });
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
    make(*entry, *log, machine, ways);
  }
  const auto wanted = std::ranges::find(entry->ways, StrippedLog::ways_of(machine));
  sim::ensure(wanted != entry->ways.end(), "a log is not stripped for a machine of its batch");
  return entry->logs[static_cast<std::size_t>(wanted - entry->ways.begin())];
}

void StrippedLogCache::make(Entry& entry, const processors::program::WorkLog& log,
                            const processors::machine::MachineConfig& machine,
                            std::span<const std::uint32_t> ways) const {
  using processors::walk::StrippedLog;
  std::uint64_t left = most_bytes_ / most_kept;
  entry.ways.assign(ways.begin(), ways.end());
  entry.logs = StrippedLog::make(log, machine, ways, left);
  const auto missing = [](const auto& each) { return each == nullptr; };
  if (ways.size() > 1 && std::ranges::all_of(entry.logs, missing)) {
    // They do not fit together. Those for many ways take the least memory.
    for (std::size_t i = ways.size(); i-- > 0;) {
      entry.logs[i] = StrippedLog::make(log, machine, ways.subspan(i, 1), left).front();
      left -= entry.logs[i] == nullptr ? 0 : std::min(left, entry.logs[i]->bytes_of_words());
    }
  }
  entry.made = true;
}

void StrippedLogCache::drop(std::size_t frame) {
  const std::lock_guard lock(mutex_);
  entries_.remove_if([frame](const std::shared_ptr<Entry>& entry) { return entry->frame == frame; });
}

}  // namespace marti::studies::sweep
