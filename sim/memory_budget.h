// How much of the host's memory the program may take, and the refusal of what would take more. Results must
// not depend on it: a budget decides whether something is done, never how it comes out.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace marti::sim {

inline constexpr std::string_view memory_limit_key = "host_machine.memory_limit";

/// A value: who is handed a copy may take what is left of it, without a word to the others. A part that runs
/// after another and beside what that one has made is handed the budget that the other has taken from.
class MemoryBudget {
 public:
  /// Without bound.
  MemoryBudget() = default;
  /// `limit` bytes. `given`: by the user, else it is the host's.
  explicit MemoryBudget(std::uint64_t limit, bool given = false) : limit_(limit), given_(given) {}

  [[nodiscard]] std::uint64_t limit() const { return limit_; }
  [[nodiscard]] std::uint64_t left() const { return limit_ - taken_; }

  /// Empty where `bytes` more are within the limit, else " about N, more than host_machine.memory_limit = L".
  [[nodiscard]] std::string excess(std::uint64_t bytes) const;
  /// Throws KeyError when `bytes` more than what was taken is beyond the limit, with both figures. `what`
  /// and its verb begin the message ("the octree takes", "its textures take"), and `remedy` ends it: which
  /// key to change ("lower structure.max_level").
  void require(std::uint64_t bytes, std::string_view what, std::string_view remedy) const;
  /// The same, and takes them for good.
  void take(std::uint64_t bytes, std::string_view what, std::string_view remedy);

 private:
  [[nodiscard]] std::string needed(std::uint64_t bytes) const;
  [[nodiscard]] std::string limit_and_source() const;

  std::uint64_t limit_ = ~std::uint64_t{0};
  std::uint64_t taken_ = 0;
  bool given_ = true;
};

/// The memory that this process can have: the least of the host's, of the limits of its control groups
/// (memory.max of version 2, memory.limit_in_bytes of version 1, each of the group and of those above it)
/// and of RLIMIT_AS. `root` is where proc/ and sys/ are.
[[nodiscard]] std::uint64_t usable_memory(const std::filesystem::path& root = "/");

/// The limit where the user gives none: three quarters of usable_memory(), shared by `processes` of equal
/// ones.
[[nodiscard]] std::uint64_t default_memory_limit(std::uint64_t processes = 1);

}  // namespace marti::sim
