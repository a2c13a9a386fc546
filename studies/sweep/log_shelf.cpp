#include "studies/sweep/log_shelf.h"

#include <algorithm>
#include <condition_variable>
#include <map>
#include <mutex>
#include <set>
#include <system_error>
#include <thread>
#include <utility>

#include "sim/error.h"
#include "sim/units.h"
#include "studies/program_build.h"
#include "studies/sweep/log_cache.h"
#include "studies/sweep/spill_files.h"

namespace marti::studies {

namespace {

// A file in the cache directory may be anybody's. This bounds the memory of one that states more than the
// shelf's limit; work logs are compressed to a tenth or so.
constexpr std::uint64_t most_kept_ratio = 1024;

struct Entry {
  enum class State : std::uint8_t {
    absent,    ///< on disk only
    resident,  ///< in memory
    busy       ///< in memory, being read or written
  };
  std::string key{};
  State state = State::absent;
  std::shared_ptr<const FrameLog> log{};
  std::uint64_t bytes = 0;                      ///< of memory that it takes or would take
  std::filesystem::path file{};                 ///< where it can be read; empty: nowhere yet
  std::unique_ptr<sim::PendingFile> spilled{};  ///< the same file, if it is to vanish
  std::uint64_t users = 0;
  std::uint64_t last_used = 0;
  bool dropped = false;

  [[nodiscard]] bool pinned() const { return users > 0 || state == State::busy; }
};

// It becomes a file's name.
void check_key(const std::string& key) {
  sim::ensure(key.size() == 32 && key.find_first_not_of("0123456789abcdef") == std::string::npos,
              "log shelf: a key is not 32 hexadecimal digits");
}

}  // namespace

class LogShelf::Book : public std::enable_shared_from_this<Book> {
 public:
  explicit Book(Options options) : limit_(options.memory_limit), spill_files_(std::move(options.spill)) {
    if (!options.cache.empty()) {
      try {
        cache_ = std::make_shared<const LogCache>(std::move(options.cache));
      } catch (const sim::UserError& error) {
        no_cache(error);
      }
    }
  }

  std::shared_ptr<const FrameLog> find_kept(const std::string& key, std::string& note) {
    note.clear();
    Lock lock(mutex_);
    try {
      if (!entries_.contains(key)) {
        if (!cache_) {
          return nullptr;
        }
        const std::filesystem::path file = cache_->file_of(key);
        lock.unlock();
        std::error_code error;
        if (!std::filesystem::exists(file, error)) {
          return nullptr;
        }
        auto entry = std::make_shared<Entry>();
        entry->key = key;
        entry->bytes = memory_of_kept(file, key);
        entry->file = file;
        lock.lock();
        entries_.emplace(key, std::move(entry));
      }
      return take(lock, key);
    } catch (const sim::UserError& error) {
      note = std::string(error.what()) + "; the frame is traced again";
      if (lock.owns_lock()) {
        entries_.erase(key);
      } else {
        lock.lock();
      }
      notes_.push_back(note);
      return nullptr;
    }
  }

  void put(const std::string& key, FrameLog log) {
    Lock lock(mutex_);
    if (entries_.contains(key)) {
      return;
    }
    const auto entry = std::make_shared<Entry>();
    entry->key = key;
    entry->bytes = memory_of(*log.log);
    entry->log = std::make_shared<const FrameLog>(std::move(log));
    entries_.emplace(key, entry);
    begin(entry);
    try {
      keep(lock, *entry);
      while (in_memory_ > limit_ && can_fit(pinned_bytes() - entry->bytes, entry->bytes)) {
        const EntryPointer victim = idle();
        if (!victim) {
          break;
        }
        evict(lock, victim);
      }
      if (can_fit(in_memory_ - entry->bytes, entry->bytes)) {
        finish(entry, Entry::State::resident);
      } else {
        spill(lock, *entry);
        finish(entry, Entry::State::absent);
      }
    } catch (...) {
      entries_.erase(key);
      finish(entry, Entry::State::absent);
      throw;
    }
  }

  std::shared_ptr<const FrameLog> take(const std::string& key) {
    Lock lock(mutex_);
    return take(lock, key);
  }

  void drop(const std::string& key) {
    const Lock lock(mutex_);
    if (const auto found = entries_.find(key); found != entries_.end()) {
      const EntryPointer entry = found->second;
      entries_.erase(found);
      entry->dropped = true;
      free_if_dropped(entry);
    }
  }

  std::vector<std::string> notes() {
    const Lock lock(mutex_);
    return std::exchange(notes_, {});
  }
  std::uint64_t in_memory() {
    const Lock lock(mutex_);
    return in_memory_;
  }

 private:
  using Lock = std::unique_lock<std::mutex>;
  using EntryPointer = std::shared_ptr<Entry>;

  // One log may always be in memory.
  [[nodiscard]] bool can_fit(std::uint64_t beside, std::uint64_t bytes) const {
    return beside == 0 || (beside <= limit_ && bytes <= limit_ - beside);
  }
  [[nodiscard]] std::uint64_t pinned_bytes() const {
    std::uint64_t bytes = 0;
    for (const EntryPointer& entry : present_) {
      bytes += entry->pinned() ? entry->bytes : 0;
    }
    return bytes;
  }
  /// The one in memory that nobody uses and that was used longest ago, if there is one.
  [[nodiscard]] EntryPointer idle() const {
    EntryPointer oldest;
    for (const EntryPointer& entry : present_) {
      if (!entry->pinned() && (!oldest || entry->last_used < oldest->last_used)) {
        oldest = entry;
      }
    }
    return oldest;
  }
  /// Nobody will make room unless the calling thread gets what it asks for.
  [[nodiscard]] bool all_wait() const {
    return busy_ == 0 && std::all_of(holding_.begin(), holding_.end(), [&](const auto& holder) {
             return holder.first == std::this_thread::get_id() || waiting_.contains(holder.first);
           });
  }

  std::shared_ptr<const FrameLog> take(Lock& lock, const std::string& key) {
    const auto found = entries_.find(key);
    sim::ensure(found != entries_.end(), "log shelf: a log that was never put there");
    const EntryPointer entry = found->second;
    while (true) {
      sim::ensure(!entry->dropped, "log shelf: a log that was dropped");
      if (entry->state == Entry::State::resident) {
        return hand_out(entry);
      }
      if (entry->state == Entry::State::absent) {
        if (can_fit(in_memory_, entry->bytes)) {
          load(lock, entry);
          continue;
        }
        if (const EntryPointer victim = idle(); victim && can_fit(pinned_bytes(), entry->bytes)) {
          evict(lock, victim);
          continue;
        }
        if (all_wait()) {
          load(lock, entry);
          continue;
        }
      }
      waiting_.insert(std::this_thread::get_id());
      changed_.wait(lock);
      waiting_.erase(std::this_thread::get_id());
    }
  }

  // From begin() to finish() an entry is in memory and busy, and its members are the calling thread's.
  void begin(const EntryPointer& entry) {
    if (present_.insert(entry).second) {
      in_memory_ += entry->bytes;
    }
    entry->state = Entry::State::busy;
    entry->last_used = ++clock_;
    ++busy_;
  }
  void finish(const EntryPointer& entry, Entry::State state) {
    --busy_;
    entry->state = state;
    if (state == Entry::State::absent) {
      leave_memory(entry);
    }
    free_if_dropped(entry);
    changed_.notify_all();
  }
  void leave_memory(const EntryPointer& entry) {
    if (present_.erase(entry) != 0) {
      in_memory_ -= entry->bytes;
    }
    entry->log.reset();
    entry->state = Entry::State::absent;
    changed_.notify_all();
  }
  void free_if_dropped(const EntryPointer& entry) {
    if (entry->dropped && !entry->pinned()) {
      leave_memory(entry);
      entry->spilled.reset();
    }
  }

  void load(Lock& lock, const EntryPointer& entry) {
    begin(entry);
    lock.unlock();
    try {
      const std::unique_ptr<LogSource> source = log_file_source(entry->file);
      entry->log =
          std::make_shared<const FrameLog>(read_log(*source, entry->key, build_of_program(), entry->bytes));
    } catch (...) {
      lock.lock();
      finish(entry, Entry::State::absent);
      throw;
    }
    lock.lock();
    finish(entry, Entry::State::resident);
  }

  // Out of memory, after it was written if it is in no file.
  void evict(Lock& lock, const EntryPointer& entry) {
    begin(entry);
    try {
      spill(lock, *entry);
    } catch (...) {
      finish(entry, Entry::State::resident);
      throw;
    }
    finish(entry, Entry::State::absent);
  }

  // The entry is busy. The lock is held again afterwards, whatever happens.
  void spill(Lock& lock, Entry& entry) {
    if (!entry.file.empty()) {
      return;
    }
    lock.unlock();
    try {
      std::unique_ptr<sim::PendingFile> spilled = spill_files_.make();
      write_log_file(spilled->temporary(), *entry.log, entry.key, build_of_program());
      entry.file = spilled->temporary();
      entry.spilled = std::move(spilled);
    } catch (...) {
      lock.lock();
      throw;
    }
    lock.lock();
  }

  // The same for the cache directory; what goes wrong is noted, and not tried again.
  void keep(Lock& lock, Entry& entry) {
    const std::shared_ptr<const LogCache> cache = cache_;
    if (!cache) {
      return;
    }
    lock.unlock();
    try {
      cache->keep(entry.key, *entry.log);
      entry.file = cache->file_of(entry.key);
      lock.lock();
    } catch (const sim::UserError& error) {
      lock.lock();
      no_cache(error);
    }
  }
  void no_cache(const sim::UserError& error) {
    cache_.reset();
    notes_.push_back(std::string(error.what()) + "; no more work logs are kept for the next sweep");
  }

  [[nodiscard]] std::uint64_t memory_of_kept(const std::filesystem::path& file,
                                             const std::string& key) const {
    const std::unique_ptr<LogSource> source = log_file_source(file);
    const std::uint64_t most = std::max(limit_, source->left() * most_kept_ratio);
    const std::uint64_t bytes = stated_memory(*source, key, build_of_program());
    if (bytes > most) {
      throw sim::UserError(file.string() + ": would take more memory than a file of its size can need");
    }
    return bytes;
  }

  std::shared_ptr<const FrameLog> hand_out(const EntryPointer& entry) {
    const std::thread::id taker = std::this_thread::get_id();
    ++entry->users;
    ++holding_[taker];
    entry->last_used = ++clock_;
    return {entry->log.get(),
            [book = shared_from_this(), entry, taker](const FrameLog*) { book->give_back(entry, taker); }};
  }
  void give_back(const EntryPointer& entry, std::thread::id taker) {
    const Lock lock(mutex_);
    --entry->users;
    if (--holding_[taker] == 0) {
      holding_.erase(taker);
    }
    free_if_dropped(entry);
    changed_.notify_all();
  }

  const std::uint64_t limit_;
  SpillFiles spill_files_;
  std::mutex mutex_;  // of all below
  std::condition_variable changed_;
  std::shared_ptr<const LogCache> cache_;
  std::map<std::string, EntryPointer> entries_;
  std::set<EntryPointer> present_;  // in memory; also those that were dropped but are in use
  std::uint64_t in_memory_ = 0;     // their bytes
  std::uint64_t busy_ = 0;          // how many of them are
  std::uint64_t clock_ = 0;
  std::map<std::thread::id, std::uint64_t> holding_;
  std::set<std::thread::id> waiting_;
  std::vector<std::string> notes_;
};

LogShelf::LogShelf(Options options) : book_(std::make_shared<Book>(std::move(options))) {}
LogShelf::~LogShelf() = default;

std::shared_ptr<const FrameLog> LogShelf::find_kept(const std::string& key, std::string& note) {
  check_key(key);
  return book_->find_kept(key, note);
}
void LogShelf::put(const std::string& key, FrameLog log) {
  check_key(key);
  book_->put(key, std::move(log));
}
std::shared_ptr<const FrameLog> LogShelf::take(const std::string& key) { return book_->take(key); }
void LogShelf::drop(const std::string& key) { book_->drop(key); }
std::vector<std::string> LogShelf::notes() { return book_->notes(); }
std::uint64_t LogShelf::in_memory() const { return book_->in_memory(); }

}  // namespace marti::studies
