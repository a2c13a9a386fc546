// One simulation at a time: whose turn it is.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>

namespace marti::studies {

/// Who asks for a simulation.
enum class Asker : std::uint8_t {
  reader,      ///< has moved a control and waits for the answer
  background,  ///< the page, which fills in a curve or what helps
};

/// Thread-safe.
class Turns {
 public:
  /// While it lives no other turn is given.
  class Turn {
   public:
    explicit Turn(Turns& turns) : turns_(&turns) {}
    Turn(Turn&& other) noexcept : turns_(other.turns_) { other.turns_ = nullptr; }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;
    Turn& operator=(Turn&&) = delete;
    ~Turn();

    /// Becomes true when a reader asks for a newer one.
    [[nodiscard]] const std::atomic<bool>& stop() const { return turns_->stop_; }

   private:
    Turns* turns_;
  };

  /// Waits for a turn. A reader's request takes the place of every request that waits, one of the background
  /// that of those of the background; std::nullopt when such a newer one came. A reader's also stops the one
  /// that has its turn.
  [[nodiscard]] std::optional<Turn> take(Asker asker);

  /// Stops the one that has its turn; those that wait get none.
  void stop();

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool taken_ = false;
  std::atomic<bool> stop_ = false;  // of the turn that is taken
  bool reader_waits_ = false;
  std::uint64_t newest_reader_ = 0;
  std::uint64_t newest_background_ = 0;
};

}  // namespace marti::studies
