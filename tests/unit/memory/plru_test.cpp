// Tree-PLRU against a model of it that is a tree: halves within halves, each with a pointer.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <random>
#include <vector>

#include "memory/cache.h"
#include "memory/tags.h"
#include "sim/error.h"

namespace marti::memory {
namespace {

constexpr std::uint32_t nothing = 0xffffffffU;

// Ways first .. first + count - 1.
class Half {
 public:
  Half(std::uint32_t first, std::uint32_t count) : first_(first), count_(count) {
    if (count > 1) {
      halves_[0] = std::make_unique<Half>(first, count / 2);
      halves_[1] = std::make_unique<Half>(first + count / 2, count / 2);
    }
  }
  void use(std::uint32_t way) {
    if (count_ > 1) {
      const bool upper = way >= first_ + count_ / 2;
      victim_in_upper_ = !upper;
      halves_[upper ? 1 : 0]->use(way);
    }
  }
  [[nodiscard]] std::uint32_t victim() const {
    return count_ == 1 ? first_ : halves_[victim_in_upper_ ? 1 : 0]->victim();
  }

 private:
  std::uint32_t first_;
  std::uint32_t count_;
  bool victim_in_upper_ = false;
  std::array<std::unique_ptr<Half>, 2> halves_;
};

class TreeModel {
 public:
  TreeModel(std::uint32_t sets, std::uint32_t ways) {
    for (std::uint32_t set = 0; set < sets; ++set) {
      sets_.push_back({Half(0, ways), std::vector<std::uint32_t>(ways, nothing)});
    }
  }
  bool access(std::uint32_t line) {
    Set& set = sets_[line % sets_.size()];
    auto at = std::find(set.lines.begin(), set.lines.end(), line);
    const bool hit = at != set.lines.end();
    if (!hit) {
      at = std::find(set.lines.begin(), set.lines.end(), nothing);
      if (at == set.lines.end()) {
        at = set.lines.begin() + set.tree.victim();
      }
      *at = line;
    }
    set.tree.use(static_cast<std::uint32_t>(at - set.lines.begin()));
    return hit;
  }
  bool holds(std::uint32_t line) const {
    const Set& set = sets_[line % sets_.size()];
    return std::find(set.lines.begin(), set.lines.end(), line) != set.lines.end();
  }
  bool remove(std::uint32_t line) {
    Set& set = sets_[line % sets_.size()];
    const auto at = std::find(set.lines.begin(), set.lines.end(), line);
    if (at == set.lines.end()) {
      return false;
    }
    *at = nothing;
    return true;
  }

 private:
  struct Set {
    Half tree;
    std::vector<std::uint32_t> lines;
  };
  std::vector<Set> sets_;
};

CacheConfig config_of(std::uint32_t ways, std::uint32_t sets, Replacement replacement) {
  CacheConfig config;
  config.line = 1;
  config.ways = ways;
  config.size = std::uint64_t{ways} * sets;
  config.replacement = replacement;
  return config;
}

TEST(TreePlru, AgreesWithATreeOfHalvesWhileLinesAreUsedTouchedAndTakenOut) {
  std::mt19937_64 random(1);
  for (const std::uint32_t ways : {1U, 2U, 4U, 8U, 16U, 32U, 64U, 128U, 512U}) {
    for (int round = 0; round < 6; ++round) {
      const auto sets = static_cast<std::uint32_t>(1 + random() % 5);
      const CacheShape shape = shape_of(config_of(ways, sets, Replacement::plru));
      with_tag_store(Replacement::plru, shape, [&]<class Tags>() {
        Tags tags(shape, 2, 1);  // the other cache's sets must not matter
        TreeModel model(sets, ways);
        for (std::uint32_t i = 0; i < 40 * ways + 1000; ++i) {
          const auto line = static_cast<std::uint32_t>(random() % (2 * ways * sets));
          switch (random() % 8) {
            case 0:
              ASSERT_EQ(tags.view(1).remove(line), model.remove(line)) << ways << " ways";
              break;
            case 1:
              ASSERT_EQ(tags.view(1).touch(line), model.holds(line) && model.access(line)) << ways << " ways";
              break;
            case 2:
              (void)tags.view(0).access(line);
              break;
            default:
              ASSERT_EQ(tags.view(1).access(line), model.access(line)) << ways << " ways";
          }
        }
      });
    }
  }
}

TEST(TreePlru, NeverReplacesOneOfTheLinesUsedLast) {
  // The last 1 + log2(ways) different lines used are safe: Reineke, Grund, Berg, Wilhelm, Timing
  // predictability of cache replacement policies, Real-Time Systems 37, 2007.
  std::mt19937_64 random(3);
  constexpr std::uint32_t ways = 16;
  Cache cache(config_of(ways, 1, Replacement::plru));
  std::vector<Address> recent;
  for (int i = 0; i < 20000; ++i) {
    const Address line = random() % 40;
    const bool hit = cache.read(line, 1) == 0;
    const auto at = std::find(recent.begin(), recent.end(), line);
    if (at != recent.end()) {
      ASSERT_TRUE(hit);
      recent.erase(at);
    }
    recent.insert(recent.begin(), line);
    recent.resize(std::min<std::size_t>(recent.size(), 5));
  }
}

TEST(TreePlru, RefusesWaysThatAreNoPowerOfTwo) {
  for (const std::uint32_t ways : {3U, 5U, 24U}) {
    EXPECT_THROW(Cache(config_of(ways, 4, Replacement::plru)), sim::UserError);
    EXPECT_NO_THROW(Cache(config_of(ways, 4, Replacement::lru)));
  }
  CacheConfig full = config_of(24, 4, Replacement::plru);
  full.ways = full_ways;
  EXPECT_THROW(Cache{full}, sim::UserError);
}

}  // namespace
}  // namespace marti::memory
