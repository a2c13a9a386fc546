// What a comparison of two results says in sentences: which is faster, by how much and why.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "studies/compare/differences.h"
#include "studies/compare/figures.h"

namespace marti::studies::compare {

/// Two results, and all that is said of them.
struct ComparedPair {
  ComparedResult a;
  ComparedResult b;
  Differences differences;
  bool same_frame = false;
  std::vector<ActivityTime> times;  ///< empty when the frames differ, or the results lack the times
};

[[nodiscard]] ComparedPair compared_pair(ComparedResult a, ComparedResult b);

/// "B is slower: its frame takes 69.061 ms, that of A 40.858 ms, 1.69 times as long (+69.0 %)".
[[nodiscard]] std::string speed_text(std::int64_t a, std::int64_t b);

/// The most important sentence first. Of two frames that differ it says what differs in them, and not that a
/// machine is faster. Results without a frame time have none.
[[nodiscard]] std::vector<std::string> verdict_of(const ComparedPair& pair);

/// What would make each frame shorter, where it is recorded.
[[nodiscard]] std::vector<std::string> helps_of(const ComparedPair& pair);

}  // namespace marti::studies::compare
