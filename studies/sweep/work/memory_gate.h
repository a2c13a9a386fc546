// Keeps machines that are simulated at the same time within a limit of memory.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>

namespace marti::studies::sweep {

/// Thread-safe.
class MemoryGate {
 public:
  explicit MemoryGate(std::uint64_t limit) : limit_(limit) {}

  /// Holds its bytes as long as it lives.
  class Pass {
   public:
    /// Waits until the bytes fit beside those in use; when nothing is in use, they always do.
    Pass(MemoryGate& gate, std::uint64_t bytes) : gate_(gate), bytes_(bytes) { gate_.enter(bytes_); }
    ~Pass() { gate_.leave(bytes_); }
    Pass(const Pass&) = delete;
    Pass& operator=(const Pass&) = delete;

   private:
    MemoryGate& gate_;
    std::uint64_t bytes_;
  };

 private:
  void enter(std::uint64_t bytes) {
    std::unique_lock lock(mutex_);
    room_.wait(lock, [&] { return in_use_ == 0 || (in_use_ <= limit_ && bytes <= limit_ - in_use_); });
    in_use_ += bytes;
  }
  void leave(std::uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    in_use_ -= bytes;
    room_.notify_all();
  }

  std::uint64_t limit_;
  std::mutex mutex_;
  std::condition_variable room_;
  std::uint64_t in_use_ = 0;
};

}  // namespace marti::studies::sweep
