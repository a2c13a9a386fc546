// Grants and refusals of a budget, and the amount of usable memory.
#include "sim/memory_budget.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <fstream>

#include "sim/work_meter.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"

namespace marti::sim {
namespace {

constexpr std::uint64_t mebibyte = std::uint64_t{1} << 20U;

TEST(MemoryBudget, GrantsWhatIsLeftAndNoByteMore) {
  MemoryBudget budget(100);
  budget.take(60, "a", "");
  EXPECT_EQ(budget.left(), 40U);
  EXPECT_NO_THROW(budget.require(40, "b", ""));
  EXPECT_THROW(budget.require(41, "b", ""), UserError);
  EXPECT_EQ(budget.left(), 40U);
  EXPECT_THROW(budget.take(~std::uint64_t{0}, "c", ""), UserError);
  EXPECT_NO_THROW(MemoryBudget().require(~std::uint64_t{0}, "all", ""));
}

TEST(MemoryBudget, RefusesWithKeyAndBothFigures) {
  MemoryBudget budget(10 * mebibyte, true);
  budget.take(4 * mebibyte, "the scene takes", "");
  EXPECT_EQ(
      test::user_error_of([&] { budget.take(7 * mebibyte - 1, "the tree takes", "lower structure.x"); }),
      "host_machine.memory_limit: the tree takes about 7 MiB beside 4 MiB that are taken, more than 10 MiB: "
      "raise the limit, or lower structure.x");
  EXPECT_NE(MemoryBudget(mebibyte).excess(2 * mebibyte).find("three quarters of what the host"),
            std::string::npos);
  EXPECT_TRUE(budget.excess(6 * mebibyte).empty());
}

TEST(MemoryBudget, AsksWhetherSomebodyWaits) {
  WorkMeter meter;
  MemoryBudget budget(100);
  budget.wait_with(&meter);
  MemoryBudget later = budget;
  EXPECT_NO_THROW(later.take(1, "a", ""));
  EXPECT_NO_THROW(later.end_if_stopped());
  meter.stop();
  EXPECT_THROW(later.take(1, "a", ""), Stopped);
  EXPECT_THROW(later.require(0, "a", ""), Stopped);
  EXPECT_THROW(later.end_if_stopped(), Stopped);
  EXPECT_EQ(later.left(), 99U);
  later.wait_with(nullptr);
  EXPECT_NO_THROW(later.take(1, "a", ""));
}

// A root directory with only what usable_memory() reads.
class FakeHost {
 public:
  FakeHost() { write("proc/meminfo", "MemTotal:       1048576 kB\nMemFree: 5 kB\n"); }
  void write(const std::filesystem::path& file, const std::string& text) const {
    std::filesystem::create_directories((root_.path() / file).parent_path());
    std::ofstream(root_.path() / file) << text;
  }
  [[nodiscard]] std::uint64_t usable() const { return usable_memory(root_.path()); }

 private:
  test::TemporaryDirectory root_;
};

TEST(UsableMemory, IsTheHostsWithoutControlGroups) {
  const FakeHost host;
  EXPECT_EQ(host.usable(), 1024 * mebibyte);
}

TEST(UsableMemory, IsThatOfTheTightestControlGroupOfVersion2) {
  const FakeHost host;
  host.write("proc/self/cgroup", "0::/jobs/one\n");
  host.write("sys/fs/cgroup/jobs/one/memory.max", "max\n");
  EXPECT_EQ(host.usable(), 1024 * mebibyte);
  host.write("sys/fs/cgroup/jobs/memory.max", "314572800\n");
  EXPECT_EQ(host.usable(), 300 * mebibyte);
  host.write("sys/fs/cgroup/jobs/one/memory.max", "209715200\n");
  EXPECT_EQ(host.usable(), 200 * mebibyte);
  // As seen in a container, where the container's own group is mounted as the root.
  host.write("sys/fs/cgroup/memory.max", "104857600\n");
  EXPECT_EQ(host.usable(), 100 * mebibyte);
}

TEST(UsableMemory, IsThatOfTheTightestControlGroupOfVersion1) {
  const FakeHost host;
  host.write("proc/self/cgroup", "3:cpu,cpuacct:/elsewhere\n7:memory:/jobs\n");
  host.write("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
  EXPECT_EQ(host.usable(), 1024 * mebibyte);
  host.write("sys/fs/cgroup/memory/jobs/memory.limit_in_bytes", "52428800\n");
  EXPECT_EQ(host.usable(), 50 * mebibyte);
}

TEST(UsableMemory, IsNoMoreThanTheAddressSpaceOfTheProcess) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  rlimit tight = before;
  tight.rlim_cur = std::uint64_t{1} << 46U;
  if (before.rlim_cur != RLIM_INFINITY || setrlimit(RLIMIT_AS, &tight) != 0) {
    GTEST_SKIP() << "the address space is limited already, or may not be";
  }
  const FakeHost host;
  host.write("proc/meminfo", "MemTotal: 137438953472 kB\n");
  EXPECT_EQ(host.usable(), std::uint64_t{1} << 46U);
  setrlimit(RLIMIT_AS, &before);
  EXPECT_EQ(host.usable(), std::uint64_t{1} << 47U);
}

}  // namespace
}  // namespace marti::sim
