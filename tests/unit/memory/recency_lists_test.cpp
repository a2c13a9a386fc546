// The lists of lines used last against lists that are searched and erased one element at a time.
#include "memory/recency_lists.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <deque>
#include <map>
#include <random>
#include <vector>

namespace marti::memory {
namespace {

template <std::uint32_t Depth>
void compare(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto sets = static_cast<std::uint32_t>(1 + random() % 5);
  const auto lines = static_cast<std::uint32_t>(1 + random() % (3 * Depth * sets));
  RecencyLists<Depth> lists(sets);
  for (int packet = 0; packet < 3; ++packet) {
    std::map<std::uint32_t, std::deque<std::uint32_t>> plain;  // all lines of each set, the newest first
    std::map<std::uint32_t, std::uint32_t> inserted;           // how often a line was not among the newest
    for (int touch = 0; touch < 300; ++touch) {
      const auto line = static_cast<std::uint32_t>(random() % lines);
      std::deque<std::uint32_t>& list = plain[line % sets];
      const auto found = std::find(list.begin(), list.end(), line);
      const auto place = static_cast<std::uint32_t>(found - list.begin());
      const bool known = found != list.end() && place < Depth;
      const auto before = std::min(Depth, static_cast<std::uint32_t>(list.size()));
      ASSERT_EQ(lists.touch(line), known ? place : Depth);
      if (!known) {
        ASSERT_EQ(lists.lines_before(), before);
        ++inserted[line % sets];
      }
      if (found != list.end()) {
        list.erase(found);
      }
      list.push_front(line);
    }
    std::size_t touched = 0;
    lists.for_each_touched([&](const std::uint32_t* held, std::uint32_t count, std::uint32_t brought_in) {
      const std::deque<std::uint32_t>& list = plain[held[0] % sets];
      ASSERT_EQ(count, std::min<std::size_t>(Depth, list.size()));
      ASSERT_TRUE(std::equal(held, held + count, list.begin()));
      ASSERT_EQ(brought_in, std::min(inserted[held[0] % sets], Depth + 1));
      ++touched;
    });
    ASSERT_EQ(touched, plain.size());
    lists.clear();
  }
}

RC_GTEST_PROP(RecencyLists, EqualPlainLists, (std::uint64_t seed)) {
  compare<4>(seed);
  compare<8>(seed);
  compare<16>(seed);
  RC_ASSERT(!::testing::Test::HasFatalFailure());
}

}  // namespace
}  // namespace marti::memory
