// Tables that share pieces of memory: they keep what is written, any thread may free them, and no piece
// stays.
#include <gtest/gtest.h>

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <random>
#include <thread>
#include <utility>
#include <vector>

#include "sim/chunks.h"

namespace marti::sim {
namespace {

using Table = ChunkVector<std::uint32_t>;

// A table of a random size, mostly small, some beyond what shares a piece, some empty.
Table random_table(Chunks& chunks, std::mt19937_64& random, std::uint32_t number) {
  const std::size_t size = number % 17 == 0     ? 0
                           : random() % 20 == 0 ? 300'000 + random() % 2'000'000
                                                : random() % 30'000;
  Table table(size, ChunkAllocator<std::uint32_t>(chunks));
  for (std::size_t at = 0; at < size; ++at) {
    table[at] = number * 2654435761U + static_cast<std::uint32_t>(at);
  }
  return table;
}

void expect_kept(const Table& table, std::uint32_t number) {
  for (std::size_t at = 0; at < table.size(); ++at) {
    ASSERT_EQ(table[at], number * 2654435761U + static_cast<std::uint32_t>(at));
  }
}

TEST(Chunks, TablesOutliveTheObjectThatMadeThem) {
  const std::size_t before = Chunks::in_use();
  std::vector<Table> tables(100);
  {
    Chunks chunks;
    std::mt19937_64 random(1);
    for (std::uint32_t i = 0; i < tables.size(); ++i) {
      tables[i] = random_table(chunks, random, i);
      EXPECT_EQ(reinterpret_cast<std::uintptr_t>(tables[i].data()) % alignof(std::max_align_t), 0U);
    }
  }
  for (std::uint32_t i = 0; i < tables.size(); i += 2) {
    tables[i] = {};
  }
  for (std::uint32_t i = 1; i < tables.size(); i += 2) {
    expect_kept(tables[i], i);
    tables[i].push_back(0);  // grows without the Chunks
    tables[i].pop_back();
    const Table copy = tables[i];
    tables[i] = {};
    expect_kept(copy, i);
  }
  tables.clear();
  EXPECT_EQ(Chunks::in_use(), before);
}

TEST(Chunks, OtherThreadsMayFreeTablesWhileMoreAreMade) {
  const std::size_t before = Chunks::in_use();
  std::mutex mutex;
  std::condition_variable made;
  std::deque<std::pair<std::uint32_t, Table>> tables;
  constexpr std::uint32_t count = 300;
  {
    const std::jthread taker([&] {
      for (std::uint32_t taken = 0; taken < count; ++taken) {
        std::unique_lock lock(mutex);
        made.wait(lock, [&] { return !tables.empty(); });
        const auto [number, table] = std::move(tables.front());
        tables.pop_front();
        lock.unlock();
        expect_kept(table, number);
      }
    });
    Chunks chunks;
    std::mt19937_64 random(2);
    for (std::uint32_t i = 0; i < count; ++i) {
      Table table = random_table(chunks, random, i);
      const std::lock_guard lock(mutex);
      tables.emplace_back(i, std::move(table));
      made.notify_one();
    }
  }
  EXPECT_EQ(Chunks::in_use(), before);
}

}  // namespace
}  // namespace marti::sim
