#include "studies/sweep/work/strip_shelf.h"

#include <algorithm>

namespace marti::studies {

std::shared_ptr<const processors::StrippedLog> StripShelf::get(
    std::size_t frame, const std::shared_ptr<const processors::WorkLog>& log,
    const processors::MachineConfig& machine, std::size_t sharing) {
  const std::string key = processors::StrippedLog::key_of(machine);
  if (key.empty() || sharing < fewest_machines) {
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
    entry->log = processors::StrippedLog::make(*log, machine, most_bytes_ / most_kept);
    entry->made = true;
  }
  return entry->log;
}

void StripShelf::drop(std::size_t frame) {
  const std::lock_guard lock(mutex_);
  entries_.remove_if([frame](const std::shared_ptr<Entry>& entry) { return entry->frame == frame; });
}

}  // namespace marti::studies
