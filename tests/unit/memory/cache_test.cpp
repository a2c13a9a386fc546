// The cache model against a second one without tags, hashes or arrays of caches.
#include "memory/cache.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <vector>

#include "memory/random_victims.h"
#include "memory/tags.h"
#include "sim/error.h"

namespace marti::memory {
namespace {

// Each set is a list of lines, newest first for LRU and FIFO; in slots for random replacement.
class ListModel {
 public:
  explicit ListModel(const CacheConfig& config)
      : config_(config),
        ways_(config.ways == full_ways ? config.size / config.line : config.ways),
        sets_(config.size / config.line / ways_) {}

  bool read(Address line) {
    std::vector<Address>& set = contents_[line % sets_];
    const auto at = std::find(set.begin(), set.end(), line);
    if (at != set.end()) {
      if (config_.replacement == Replacement::lru) {
        set.erase(at);
        set.insert(set.begin(), line);
      }
      return true;
    }
    if (config_.replacement == Replacement::random) {
      const auto free = std::find(set.begin(), set.end(), nothing);
      if (free != set.end()) {
        *free = line;
      } else if (set.size() < ways_) {
        set.push_back(line);
      } else {
        VictimStream& stream = streams_.try_emplace(line % sets_, config_.seed, line % sets_).first->second;
        set[stream.next(static_cast<std::uint32_t>(ways_))] = line;
      }
      return false;
    }
    set.insert(set.begin(), line);
    if (set.size() > ways_) {
      set.pop_back();
    }
    return false;
  }

  bool holds(Address line) {
    const std::vector<Address>& set = contents_[line % sets_];
    return std::find(set.begin(), set.end(), line) != set.end();
  }

  bool remove(Address line) {
    std::vector<Address>& set = contents_[line % sets_];
    const auto at = std::find(set.begin(), set.end(), line);
    if (at == set.end()) {
      return false;
    }
    if (config_.replacement == Replacement::random) {
      *at = nothing;  // the others stay in their slots
    } else {
      set.erase(at);
    }
    return true;
  }

 private:
  static constexpr Address nothing = ~Address{0};

  CacheConfig config_;
  std::uint64_t ways_;
  std::uint64_t sets_;
  std::map<Address, std::vector<Address>> contents_;
  std::map<Address, VictimStream> streams_;
};

// Addresses with both locality and conflicts: a random walk with jumps.
std::vector<Address> trace(std::uint64_t seed, std::size_t length, Address span) {
  std::mt19937_64 random(seed);
  std::vector<Address> addresses;
  Address at = 0;
  for (std::size_t i = 0; i < length; ++i) {
    at = random() % 8 == 0 ? random() % span : (at + random() % 64) % span;
    addresses.push_back(at);
  }
  return addresses;
}

TEST(Cache, AgreesWithAListModelForEveryPolicyAndShape) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 300; ++round) {
    CacheConfig config;
    config.line = 1U << (random() % 7);
    config.ways = static_cast<std::uint32_t>(std::array{0, 1, 2, 3, 4, 7, 8, 16, 17, 40}[random() % 10]);
    config.size = std::uint64_t{config.line} * std::max(1U, config.ways) * (1 + random() % 20);
    config.replacement = static_cast<Replacement>(random() % 3);
    config.seed = random();
    Cache cache(config);
    ListModel model(config);
    for (const Address address : trace(random(), 1500, config.size * 4)) {
      const std::uint64_t bytes = 1 + random() % 50;
      std::int64_t missed = 0;
      for (Address line = address / config.line; line <= (address + bytes - 1) / config.line; ++line) {
        missed += model.read(line) ? 0 : 1;
      }
      ASSERT_EQ(cache.read(address, bytes), missed)
          << "line " << config.line << " ways " << config.ways << " size " << config.size << " policy "
          << replacement_names[static_cast<std::size_t>(config.replacement)];
    }
  }
}

TEST(Cache, AgreesWithAListModelWhileLinesAreTakenOut) {
  std::mt19937_64 random(2);
  for (int round = 0; round < 300; ++round) {
    CacheConfig config;
    config.line = 16;
    config.ways = static_cast<std::uint32_t>(std::array{0, 1, 2, 3, 4, 4, 8, 16, 17, 40}[random() % 10]);
    config.size = std::uint64_t{config.line} * std::max(1U, config.ways) * (1 + random() % 20);
    config.replacement = static_cast<Replacement>(random() % 3);
    config.seed = random();
    Cache cache(config);
    ListModel model(config);
    for (const Address address : trace(random(), 1500, config.size * 2)) {
      const Address line = address / config.line;
      if (random() % 4 == 0) {
        ASSERT_EQ(cache.invalidate(address, 1), model.remove(line) ? 1 : 0);
      } else {
        ASSERT_EQ(cache.read(address, 1), model.read(line) ? 0 : 1)
            << "ways " << config.ways << " size " << config.size << " policy "
            << replacement_names[static_cast<std::size_t>(config.replacement)];
      }
    }
  }
}

TEST(Cache, TouchingBringsNothingInAndIsAUseOfWhatIsThere) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 200; ++round) {
    CacheConfig config;
    config.line = 1;
    config.ways = static_cast<std::uint32_t>(std::array{1, 2, 3, 4, 8, 17}[random() % 6]);
    config.size = std::uint64_t{config.ways} * (1 + random() % 4);
    config.replacement = static_cast<Replacement>(random() % 3);
    const CacheShape shape = shape_of(config);
    with_tag_store(config.replacement, shape, [&]<class Tags>() {
      Tags tags(shape, 1, config.seed);
      ListModel model(config);
      for (int i = 0; i < 600; ++i) {
        const auto line = static_cast<std::uint32_t>(random() % (2 * config.size));
        switch (random() % 4) {
          case 0:
            ASSERT_EQ(tags.view(0).remove(line), model.remove(line));
            break;
          case 1:
            ASSERT_EQ(tags.view(0).touch(line), model.holds(line) && model.read(line));
            break;
          default:
            ASSERT_EQ(tags.view(0).access(line), model.read(line));
        }
      }
    });
  }
}

TEST(Cache, ManyCachesInOneStoreDoNotDisturbEachOther) {
  CacheConfig config;
  config.size = 512;
  config.line = 16;
  config.ways = 2;
  const CacheShape shape = shape_of(config);
  SetTags<Replacement::lru, 2> together(shape, 5, config.seed);
  std::vector<Cache> apart;
  for (int i = 0; i < 5; ++i) {
    apart.emplace_back(config);
  }
  std::mt19937_64 random(7);
  for (int i = 0; i < 20000; ++i) {
    const auto which = static_cast<std::uint32_t>(random() % 5);
    const auto line = static_cast<std::uint32_t>(random() % 100);
    ASSERT_EQ(together.view(which).access(line), apart[which].read(line * 16, 1) == 0);
  }
}

TEST(Cache, RefusesWhatCannotBeBuilt) {
  const auto build = [](std::uint64_t size, std::uint32_t line, std::uint32_t ways) {
    CacheConfig config;
    config.size = size;
    config.line = line;
    config.ways = ways;
    return Cache(config);
  };
  EXPECT_THROW(build(0, 32, 1), sim::UserError);
  EXPECT_THROW(build(1024, 0, 1), sim::UserError);
  EXPECT_THROW(build(1024, 24, 1), sim::UserError);
  EXPECT_THROW(build(1000, 32, 1), sim::UserError);
  EXPECT_THROW(build(1024, 32, 33), sim::UserError);
  EXPECT_THROW(build(1024, 32, 5), sim::UserError);
  EXPECT_THROW(build(~std::uint64_t{0} - 31, 32, 1), sim::UserError);
  EXPECT_EQ(build(96, 32, 1).shape().sets, 3U) << "sets need not be a power of two";
  Cache cache = build(1024, 1, 4);
  EXPECT_THROW(cache.read(0, 0), sim::UserError);
  EXPECT_THROW(cache.read(~Address{0}, 2), sim::UserError);
  EXPECT_THROW(cache.read(Address{1} << 33U, 1), sim::UserError);
}

}  // namespace
}  // namespace marti::memory
