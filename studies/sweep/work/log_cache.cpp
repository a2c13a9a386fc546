#include "studies/sweep/work/log_cache.h"

#include <condition_variable>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

namespace marti::studies::sweep {

namespace {

template <class Item, class Allocator>
std::uint64_t reserved(const std::vector<Item, Allocator>& items) {
  return items.capacity() * sizeof(Item);
}

struct Entry {
  std::shared_ptr<const FrameLog> log{};  ///< null: not in memory
  std::uint64_t bytes = 0;                ///< that it takes or took when it was there; 0: not known yet
  std::uint64_t users = 0;
  std::uint64_t last_used = 0;
  bool tracing = false;
};

}  // namespace

std::uint64_t memory_of(const processors::program::WorkLog& log) {
  std::uint64_t bytes = reserved(log.topology.nodes) + reserved(log.topology.entries) +
                        reserved(log.topology.work) + reserved(log.quadrics) + reserved(log.texture_begin) +
                        reserved(log.rows);
  for (const processors::program::LogRow& row : log.rows) {
    bytes += reserved(row.words) + reserved(row.begin);
  }
  return bytes;
}

class LogCache::Entries : public std::enable_shared_from_this<Entries> {
 public:
  explicit Entries(std::uint64_t limit) : limit_(limit) {}

  void put(std::size_t frame, FrameLog log) {
    const std::lock_guard lock(mutex_);
    const EntryPointer entry = entry_of(frame);
    if (!entry->log && !entry->tracing) {
      place_if_it_fits(*entry, std::move(log));
    }
  }

  std::shared_ptr<const FrameLog> take(std::size_t frame, const Trace& trace) {
    std::unique_lock lock(mutex_);
    const EntryPointer entry = entry_of(frame);
    while (!entry->log) {
      if (!entry->tracing && fits(pinned_, entry->bytes)) {
        trace_again(lock, *entry, trace);
      } else {
        changed_.wait(lock);
      }
    }
    if (entry->users++ == 0) {
      pinned_ += entry->bytes;
    }
    entry->last_used = ++clock_;
    return {entry->log.get(),
            [table = shared_from_this(), entry](const FrameLog*) { table->give_back(*entry); }};
  }

  std::uint64_t in_memory() {
    const std::lock_guard lock(mutex_);
    return in_memory_;
  }

 private:
  using EntryPointer = std::shared_ptr<Entry>;

  [[nodiscard]] EntryPointer entry_of(std::size_t frame) {
    EntryPointer& entry = entries_[frame];
    if (!entry) {
      entry = std::make_shared<Entry>();
    }
    return entry;
  }

  // One log may always be in memory.
  [[nodiscard]] bool fits(std::uint64_t beside, std::uint64_t bytes) const {
    return beside == 0 || (beside <= limit_ && bytes <= limit_ - beside);
  }

  // Drops logs that nobody uses until `bytes` fit, if they fit beside those in use.
  void make_room(std::uint64_t bytes) {
    while (fits(pinned_, bytes) && !fits(in_memory_, bytes)) {
      Entry* oldest = nullptr;
      for (const auto& [frame, entry] : entries_) {
        if (entry->log && entry->users == 0 && (oldest == nullptr || entry->last_used < oldest->last_used)) {
          oldest = entry.get();
        }
      }
      forget(*oldest);
    }
  }

  void place(Entry& entry, FrameLog log) {
    entry.bytes = memory_of(*log.log);
    entry.log = std::make_shared<const FrameLog>(std::move(log));
    entry.last_used = ++clock_;
    in_memory_ += entry.bytes;
  }
  void place_if_it_fits(Entry& entry, FrameLog log) {
    entry.bytes = memory_of(*log.log);
    make_room(entry.bytes);
    if (fits(in_memory_, entry.bytes)) {
      place(entry, std::move(log));
    }
  }

  // Makes room for a log before it is traced, if its size is known; else it is kept only if it fits
  // afterwards.
  void trace_again(std::unique_lock<std::mutex>& lock, Entry& entry, const Trace& trace) {
    const std::uint64_t room = entry.bytes;
    make_room(room);
    entry.tracing = true;
    in_memory_ += room;
    pinned_ += room;
    lock.unlock();
    FrameLog log;
    const auto stop_tracing = [&] {
      lock.lock();
      entry.tracing = false;
      in_memory_ -= room;
      pinned_ -= room;
      changed_.notify_all();
    };
    try {
      log = trace();
    } catch (...) {
      stop_tracing();
      throw;
    }
    stop_tracing();
    if (room != 0) {
      place(entry, std::move(log));
    } else {
      place_if_it_fits(entry, std::move(log));
    }
  }

  void give_back(Entry& entry) {
    const std::lock_guard lock(mutex_);
    if (--entry.users == 0) {
      pinned_ -= entry.bytes;
      changed_.notify_all();
    }
  }
  void forget(Entry& entry) {
    in_memory_ -= entry.bytes;
    entry.log.reset();
  }

  const std::uint64_t limit_;
  std::mutex mutex_;  // of all below
  std::condition_variable changed_;
  std::map<std::size_t, EntryPointer> entries_;
  std::uint64_t in_memory_ = 0;  // bytes of logs
  std::uint64_t pinned_ = 0;     // of them, those in use or being traced again
  std::uint64_t clock_ = 0;
};

LogCache::LogCache(std::uint64_t memory_limit) : table_(std::make_shared<Entries>(memory_limit)) {}
LogCache::~LogCache() = default;

void LogCache::put(std::size_t frame, FrameLog log) { table_->put(frame, std::move(log)); }
std::shared_ptr<const FrameLog> LogCache::take(std::size_t frame, const Trace& trace) {
  return table_->take(frame, trace);
}
std::uint64_t LogCache::in_memory() const { return table_->in_memory(); }

}  // namespace marti::studies::sweep
