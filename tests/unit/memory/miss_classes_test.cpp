// Classes of misses and sharing of lines while lines are taken out, against lists and sets.
#include "memory/miss_classes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "memory/cache.h"
#include "memory/line_sharing.h"

namespace marti::memory {
namespace {

CacheConfig small(std::uint32_t ways, std::uint32_t lines) {
  return {.size = lines, .line = 1, .ways = ways, .replacement = Replacement::fifo};
}

TEST(MissClasses, AgreeWithListsAndSetsWhileLinesAreTakenOut) {
  std::mt19937_64 random(1);
  std::map<MissClass, int> seen;
  for (int round = 0; round < 100; ++round) {
    const std::uint32_t ways = 1U << (random() % 4);
    const auto lines = static_cast<std::uint32_t>(ways * (1 + random() % 6));
    Cache cache(small(ways, lines));
    MissClassifier classifier(lines, 3);
    std::vector<std::uint32_t> full;  // newest first
    std::set<std::uint32_t> had;
    std::set<std::uint32_t> taken;
    for (int i = 0; i < 1500; ++i) {
      const auto line = static_cast<std::uint32_t>(random() % (3 * lines));
      if (random() % 16 == 0) {
        const bool held = cache.invalidate(line, 1) == 1;
        classifier.written(2, line, held);
        std::erase(full, line);
        if (held) {
          taken.insert(line);
        }
        continue;
      }
      const bool in_full = std::erase(full, line) == 1;
      full.insert(full.begin(), line);
      full.resize(std::min<std::size_t>(full.size(), lines));
      if (cache.read(line, 1) == 0) {
        classifier.hit(2, line);
        continue;
      }
      MissClass expected = in_full ? MissClass::conflict : MissClass::capacity;
      if (taken.erase(line) == 1) {
        expected = MissClass::invalidation;
      } else if (!had.contains(line)) {
        expected = MissClass::compulsory;
      }
      had.insert(line);
      ASSERT_EQ(classifier.miss(2, line), expected);
      ++seen[expected];
    }
  }
  EXPECT_EQ(seen.size(), miss_classes);
}

TEST(LineSharing, CountsNodesOfEachClusterApart) {
  std::mt19937_64 random(3);
  LineSharing sharing(3, 4);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::set<std::uint32_t>> users;
  for (int i = 0; i < 3000; ++i) {
    const auto node = static_cast<std::uint32_t>(random() % 12);
    const auto line = static_cast<std::uint32_t>((random() % 40) * (random() % 40));
    sharing.fetch(node, line);
    users[{node / 4, line}].insert(node);
  }
  std::map<std::uint32_t, std::int64_t> fetched;
  for (const auto& [line, nodes] : users) {
    ++fetched[static_cast<std::uint32_t>(nodes.size())];
  }
  const SharingResult result = sharing.result();
  EXPECT_EQ(result.fetches, 3000);
  EXPECT_EQ(result.distinct, static_cast<std::int64_t>(users.size()));
  EXPECT_EQ(result.duplicates(), 3000 - result.distinct);
  EXPECT_EQ(result.fetched, fetched);
  EXPECT_EQ(result.by(5), 0);
}

}  // namespace
}  // namespace marti::memory
