// One simulation at a time: whose turn it is.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "sim/work_meter.h"

namespace marti::studies::explore {

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
    Turn(Turns& turns, std::shared_ptr<sim::WorkMeter> meter) : turns_(&turns), meter_(std::move(meter)) {}
    Turn(Turn&& other) noexcept
        : turns_(std::exchange(other.turns_, nullptr)), meter_(std::move(other.meter_)) {}
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;
    Turn& operator=(Turn&&) = delete;
    ~Turn();

    /// For the work; it is stopped when a reader asks for a newer one.
    [[nodiscard]] sim::WorkMeter& meter() const { return *meter_; }

   private:
    Turns* turns_;
    std::shared_ptr<sim::WorkMeter> meter_;
  };

  /// Waits for a turn. A reader's request takes the place of every request that waits, one of the background
  /// that of those of the background; std::nullopt when such a newer one came. A reader's also stops the one
  /// that has its turn.
  [[nodiscard]] std::optional<Turn> take(Asker asker);

  /// Stops the one that has its turn; those that wait and those that come get none.
  void stop();

  /// How far the work of the present turn is; an empty state while no turn is taken.
  [[nodiscard]] sim::WorkMeter::State state() const;

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::shared_ptr<sim::WorkMeter> taken_;  // of the turn that is taken; null: none is
  bool ended_ = false;
  bool reader_waits_ = false;
  std::uint64_t newest_reader_ = 0;
  std::uint64_t newest_background_ = 0;
};

}  // namespace marti::studies::explore
