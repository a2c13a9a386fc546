// How much of the host's memory the program may take, and the error when more would be needed. Results must
// not depend on it: a budget decides whether something is done, never its outcome.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace marti::sim {

class WorkMeter;

inline constexpr std::string_view memory_limit_key = "host_machine.memory_limit";

/// A value: taking from a copy has no effect on other copies. Where the memory of two steps is in use at the
/// same time, the later step gets the budget from which the earlier one has taken.
class MemoryBudget {
 public:
  /// No limit.
  MemoryBudget() = default;
  /// `limit` in bytes. `given`: the user has set it; else it follows from the host.
  explicit MemoryBudget(std::uint64_t limit, bool given = false) : limit_(limit), given_(given) {}

  /// From now on require(), take() and end_if_stopped() throw Stopped after meter->stop(). Readers and
  /// builders take their memory step by step, so each step ends them then. Null: nothing ends them.
  /// `meter` must outlive the budget and its copies.
  void wait_with(const WorkMeter* meter) { meter_ = meter; }
  /// For steps that take no memory.
  void end_if_stopped() const;

  [[nodiscard]] std::uint64_t limit() const { return limit_; }
  [[nodiscard]] std::uint64_t left() const { return limit_ - taken_; }

  /// Empty if `bytes` more are within the limit, else " about N, more than host_machine.memory_limit = L".
  [[nodiscard]] std::string excess(std::uint64_t bytes) const;
  /// Throws KeyError, with both figures, when `bytes` more would exceed the limit. `what` is the message's
  /// beginning, with its verb ("the octree takes", "its textures take"), `remedy` its end: the key to change
  /// ("lower structure.max_level").
  void require(std::uint64_t bytes, std::string_view what, std::string_view remedy) const;
  /// As require(), and subtracts the bytes from what is left.
  void take(std::uint64_t bytes, std::string_view what, std::string_view remedy);

 private:
  [[nodiscard]] std::string needed(std::uint64_t bytes) const;
  [[nodiscard]] std::string limit_and_source() const;

  std::uint64_t limit_ = ~std::uint64_t{0};
  std::uint64_t taken_ = 0;
  bool given_ = true;
  const WorkMeter* meter_ = nullptr;
};

/// The memory that this process can have: the least of the host's memory, the limits of its control groups
/// (memory.max of version 2, memory.limit_in_bytes of version 1, each for the group and its ancestors) and
/// RLIMIT_AS. `root` is the directory of proc/ and sys/.
[[nodiscard]] std::uint64_t usable_memory(const std::filesystem::path& root = "/");

/// The limit if the user sets none: three quarters of usable_memory(), divided equally among
/// `processes`.
[[nodiscard]] std::uint64_t default_memory_limit(std::uint64_t processes = 1);

}  // namespace marti::sim
