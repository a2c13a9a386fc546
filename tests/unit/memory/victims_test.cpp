// Policies whose lines stay in their ways, against models: tree-PLRU against halves within halves, each with
// a pointer; SRRIP against lines that are sorted anew for each victim.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <random>
#include <span>
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

class Tree {
 public:
  explicit Tree(std::uint32_t ways) : halves_(0, ways) {}
  void fill(std::uint32_t way) { halves_.use(way); }
  void use(std::uint32_t way) { halves_.use(way); }
  [[nodiscard]] std::uint32_t victim() const { return halves_.victim(); }

 private:
  Half halves_;
};

// Each line has the time at which it would be 3, if time went on by 1 for each step of all counters.
class Predictions {
 public:
  explicit Predictions(std::uint32_t ways) : due_(ways, 0) {}
  void fill(std::uint32_t way) { due_[way] = now_ + 1; }
  void use(std::uint32_t way) { due_[way] = now_ + 3; }
  std::uint32_t victim() {
    const auto first = std::min_element(due_.begin(), due_.end());
    now_ = std::max(now_, *first);
    return static_cast<std::uint32_t>(first - due_.begin());
  }

 private:
  std::vector<std::int64_t> due_;
  std::int64_t now_ = 0;
};

template <class Victims>
class Model {
 public:
  Model(std::uint32_t sets, std::uint32_t ways) {
    for (std::uint32_t set = 0; set < sets; ++set) {
      sets_.push_back({Victims(ways), std::vector<std::uint32_t>(ways, nothing)});
    }
  }
  bool access(std::uint32_t line) {
    Set& set = sets_[line % sets_.size()];
    auto at = std::find(set.lines.begin(), set.lines.end(), line);
    if (at != set.lines.end()) {
      set.victims.use(static_cast<std::uint32_t>(at - set.lines.begin()));
      return true;
    }
    at = std::find(set.lines.begin(), set.lines.end(), nothing);
    if (at == set.lines.end()) {
      at = set.lines.begin() + set.victims.victim();
    }
    *at = line;
    set.victims.fill(static_cast<std::uint32_t>(at - set.lines.begin()));
    return false;
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
    Victims victims;
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

// While lines are used, touched and taken out.
template <class Victims>
void expect_agreement(Replacement policy, std::span<const std::uint32_t> all_ways) {
  std::mt19937_64 random(1);
  for (const std::uint32_t ways : all_ways) {
    for (int round = 0; round < 6; ++round) {
      const auto sets = static_cast<std::uint32_t>(1 + random() % 5);
      const CacheShape shape = shape_of(config_of(ways, sets, policy));
      with_tag_store(policy, shape, [&]<class Tags>() {
        Tags tags(shape, 2, 1);  // the other cache's sets must not matter
        Model<Victims> model(sets, ways);
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

TEST(TreePlru, AgreesWithATreeOfHalves) {
  expect_agreement<Tree>(Replacement::plru, std::array{1U, 2U, 4U, 8U, 16U, 32U, 64U, 128U, 512U});
}

TEST(Rrip, AgreesWithPredictedTimes) {
  expect_agreement<Predictions>(Replacement::srrip, std::array{1U, 2U, 3U, 5U, 8U, 16U, 17U, 64U, 100U});
}

// The example of Jaleel et al.: lines that are used again outlive any number of lines that are used once.
TEST(Rrip, KeepsWhatIsUsedAgainWhileAStreamPasses) {
  Cache cache(config_of(8, 1, Replacement::srrip));
  for (const Address line : {0, 1, 2, 3, 0, 1, 2, 3}) {
    (void)cache.read(line, 1);
  }
  for (Address stream = 100; stream < 104; ++stream) {
    (void)cache.read(stream, 1);
  }
  for (Address stream = 200; stream < 1000; ++stream) {
    EXPECT_EQ(cache.read(stream, 1), 1U);
    for (const Address line : {0, 1, 2, 3}) {
      EXPECT_EQ(cache.read(line, 1), 0U) << "after line " << stream;
    }
  }
}

TEST(Rrip, RefusesSetsThatAreSearchedTooLong) {
  EXPECT_NO_THROW(Cache(config_of(65'536, 1, Replacement::srrip)));
  EXPECT_THROW(Cache(config_of(65'537, 1, Replacement::srrip)), sim::UserError);
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
