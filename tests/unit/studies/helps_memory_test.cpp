// What helps is measured while the computer runs out of memory. This program has an operator new of its own,
// which can be told to fail.
#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <new>
#include <string>

#include "studies/helps/what_helps.h"
#include "studies/keys/machine_keys.h"
#include "tests/contract/random_cases.h"
#include "tests/support/configuration_of.h"
#include "tests/support/long_tests.h"

namespace {

constexpr std::int64_t never = std::int64_t{1} << 62U;

// So many allocations of all threads succeed from now on; then `failing` fail, and all after them succeed.
std::atomic<std::int64_t> left = never;
std::atomic<std::int64_t> failing = 0;

bool fails() {
  const std::int64_t place = left.fetch_sub(1);
  return place <= 0 && -place < failing;
}

void* allocated(std::size_t bytes, std::size_t alignment) {
  void* const memory =
      fails() ? nullptr : std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
  if (memory == nullptr) {
    throw std::bad_alloc();
  }
  return memory;
}

// Not inlined: the compiler takes the pair of new and free() for an error.
[[gnu::noinline]] void release(void* memory) noexcept { std::free(memory); }

}  // namespace

void* operator new(std::size_t bytes) { return allocated(bytes == 0 ? 1 : bytes, alignof(std::max_align_t)); }
void* operator new[](std::size_t bytes) {
  return allocated(bytes == 0 ? 1 : bytes, alignof(std::max_align_t));
}
void* operator new(std::size_t bytes, const std::nothrow_t& /*null*/) noexcept {
  return fails() ? nullptr : std::malloc(bytes == 0 ? 1 : bytes);
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return allocated(bytes, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t bytes, std::align_val_t alignment) {
  return allocated(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { release(memory); }
void operator delete[](void* memory) noexcept { release(memory); }
void operator delete(void* memory, std::size_t /*bytes*/) noexcept { release(memory); }
void operator delete[](void* memory, std::size_t /*bytes*/) noexcept { release(memory); }
void operator delete(void* memory, std::align_val_t /*alignment*/) noexcept { release(memory); }
void operator delete[](void* memory, std::align_val_t /*alignment*/) noexcept { release(memory); }
void operator delete(void* memory, std::size_t /*bytes*/, std::align_val_t /*alignment*/) noexcept {
  release(memory);
}
void operator delete[](void* memory, std::size_t /*bytes*/, std::align_val_t /*alignment*/) noexcept {
  release(memory);
}

namespace marti::studies {

using namespace helps;
using namespace keys;

namespace {

// Changes by what they are, with their frame times.
std::map<std::string, std::optional<sim::Ticks>> ends_of(const WhatHelps& what) {
  std::map<std::string, std::optional<sim::Ticks>> ends;
  for (const Help& help : what.helps) {
    for (const std::optional<MeasuredChange>* change : {&help.step, &help.best}) {
      if (*change) {
        ends[describe((*change)->keys)] = (*change)->end;
      }
    }
  }
  return ends;
}

// Measures with all memory, and again with `failures` allocations failing from each of many places on.
// Measuring ends with std::bad_alloc, or leaves replays out and has the others right.
void expect_no_wrong_figure(test::TimedCase (*make)(test::Random&), std::int64_t failures) {
  test::Random random(7);
  test::TimedCase made = make(random);
  test::use_default_interleave(made.machine);
  const sim::Config config = test::configuration_of(test::assignments_of(made.machine));
  sim::Config read = config;
  const processors::machine::MachineConfig machine = read_machine(read);
  const processors::replay::MachineResult result = processors::replay::replay(made.log, machine);
  const SharedLog shared{made.log, nullptr, {}, {}};
  const auto measured = [&] { return what_helps(config, std::nullopt, machine, result, shared); };
  left = never;
  const auto known = ends_of(measured());
  const std::int64_t allocations = never - left;
  ASSERT_GT(allocations, 1000);
  std::size_t refused = 0;
  std::size_t left_out = 0;
  const std::int64_t step = 1 + allocations / static_cast<std::int64_t>(test::stride(100, 2000));
  for (std::int64_t place = 0; place < allocations; place += step) {
    SCOPED_TRACE(place);
    std::optional<WhatHelps> what;
    failing = failures;
    left = place;
    try {
      what = measured();
    } catch (const std::bad_alloc&) {
    }
    left = never;
    if (!what) {
      ++refused;
      continue;
    }
    left_out += unreplayed(*what).memory;
    for (const auto& [change, end] : ends_of(*what)) {
      const auto expected = known.find(change);
      ASSERT_NE(expected, known.end()) << change;
      if (end && expected->second) {  // other replays than usual may have been worth it
        EXPECT_EQ(*end, *expected->second) << change;
      }
    }
  }
  EXPECT_GT(refused, 0U);
  EXPECT_GT(left_out, 0U);
}

TEST(WhatHelpsWithoutMemory, LeavesAReplayOut) {
  expect_no_wrong_figure(test::image_case, 1);
  expect_no_wrong_figure(test::building_case, 1);
}

TEST(WhatHelpsWithoutMemory, LeavesSeveralReplaysOut) {
  expect_no_wrong_figure(test::pipeline_case, 3);
  expect_no_wrong_figure(test::space_case, 3);
}

}  // namespace
}  // namespace marti::studies
