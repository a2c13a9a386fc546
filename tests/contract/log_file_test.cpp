// Work logs as files: what is read is what was written, and machines of every kind take the times that they
// take on the log itself. A file that was damaged is refused; what is not refused can be timed.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "processors/program/log_rules.h"
#include "studies/log_file/log_fields.h"
#include "tests/contract/random_cases.h"
#include "tests/support/equal_results.h"
#include "tests/support/files.h"
#include "tests/support/random_simt.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"
#include "tests/unit/processors/simt_logs.h"

namespace marti::test {
namespace {

using processors::machine::MachineConfig;
using processors::program::WorkLog;
using studies::log_file::Fields;
using studies::log_file::PackedReader;
using studies::log_file::PackedWriter;

/// Fields as bytes that are packed into no file.
struct Bytes {
  static constexpr bool reads = false;
  std::string text;
  void bytes(const void* from, std::size_t count) { text.append(static_cast<const char*>(from), count); }
};

std::string bytes_of(const WorkLog& log) {
  Bytes bytes;
  Fields<Bytes> fields(bytes);
  studies::log_file::describe(fields, log);
  return bytes.text;
}

void write_packed(const std::filesystem::path& file, const std::string& bytes) {
  PackedWriter writer(file);
  writer.bytes(bytes.data(), bytes.size());
  writer.commit();
}

WorkLog read_log(const std::filesystem::path& file) {
  PackedReader reader(file);
  reader.limit(sim::MemoryBudget(std::uint64_t{1} << 26U));
  Fields<PackedReader> fields(reader);
  WorkLog log;
  studies::log_file::describe(fields, log);
  reader.end();
  return log;
}

WorkLog written_and_read(const WorkLog& log) {
  const TemporaryDirectory directory;
  const std::filesystem::path file = directory.path() / "a.log";
  write_packed(file, bytes_of(log));
  return read_log(file);
}

RC_GTEST_PROP(LogFile, HoldsAnyLog, (std::uint64_t seed)) {
  Random random(seed);
  const WorkLog log = any_log(random);
  const WorkLog read = written_and_read(log);
  RC_ASSERT(bytes_of(read) == bytes_of(log));
  RC_ASSERT(read.topology == log.topology);
  RC_ASSERT(read.rows.size() == log.rows.size());
  for (std::size_t y = 0; y < log.rows.size(); ++y) {
    RC_ASSERT(read.rows[y].words == log.rows[y].words);
    RC_ASSERT(read.rows[y].begin == log.rows[y].begin);
  }
}

// More than one part, and not a whole number of them.
TEST(LogFile, HoldsLongLogs) {
  WorkLog log;
  log.width = 1;
  log.height = 1;
  log.rows.resize(1);
  Random random(3);
  for (std::size_t i = 0; i < 3 * studies::log_file::part_bytes / 4 + 7; ++i) {
    log.rows[0].words.push_back(static_cast<std::uint32_t>(random()));
  }
  EXPECT_TRUE(written_and_read(log).rows[0].words == log.rows[0].words);
}

// Any machine that can time the log.
MachineConfig any_machine(Random& random, const WorkLog& log) {
  const bool tree = !log.topology.work.empty() && !accel::walks_bvh(log.traversal);
  if (log.order == accel::WalkOrder::treelet_first) {
    return random_simt(random, log);  // whose treelets are those of the log
  }
  MachineConfig machine = random_machine(random, 6);
  switch (pick(random, 0, 4)) {
    case 0:
      add_random_second_level(random, machine);
      break;
    case 1:
      make_random_pipeline(random, machine);
      break;
    case 2:
      if (!accel::has_instances(log.topology)) {
        make_random_space(random, machine);
      }
      break;
    case 3:
      if (tree) {
        add_random_build(random, machine);
      }
      break;
    default:
      return random_simt(random, log);
  }
  return machine;
}

processors::replay::MachineResult timed(const WorkLog& log, const MachineConfig& machine) {
  return processors::replay::replay(log, machine);
}

TEST(LogFile, EveryMachineTakesTheTimesOfTheLogItself) {
  Random random(11);
  for (const WorkLog& log : processors::test::simt_logs(9, 6)) {
    ASSERT_EQ(processors::program::fault_of(log), "");
    ASSERT_EQ(processors::program::fault_of_order(log), "");
    const WorkLog read = written_and_read(log);
    ASSERT_EQ(bytes_of(read), bytes_of(log));
    for (int times = 0; times < 12; ++times) {
      const MachineConfig machine = any_machine(random, log);
      expect_equal(timed(read, machine), timed(log, machine));
    }
  }
}

// A bit turned, bytes overwritten, cut off or taken out.
void damage(Random& random, std::string& bytes) {
  const std::size_t at = random() % bytes.size();
  const std::size_t count = std::min<std::size_t>(bytes.size() - at, 1 + random() % 9);
  switch (pick(random, 0, 3)) {
    case 0:
      bytes[at] = static_cast<char>(bytes[at] ^ static_cast<char>(1U << random() % 8));
      break;
    case 1:
      for (std::size_t i = at; i < at + count; ++i) {
        bytes[i] = static_cast<char>(random());
      }
      break;
    case 2:
      bytes.resize(at);
      break;
    default:
      bytes.erase(at, count);
  }
}

// Somebody may write any bytes with the right checksums. What the rules of logs let pass, every machine can
// time.
TEST(LogFile, WhatIsNotRefusedCanBeTimed) {
  const TemporaryDirectory directory;
  const std::filesystem::path file = directory.path() / "a.log";
  int refused = 0;
  int taken = 0;
  Random random(5);
  for (const WorkLog& log : processors::test::simt_logs(4, 3)) {
    const std::string bytes = bytes_of(log);
    // Most of a small log is its tree, so that the words at the end are damaged as often.
    const std::size_t words = std::size_t{4} * log.rows.size() * log.rows.front().words.size();
    for (int times = 0; times < 250; ++times) {
      const std::size_t kept = times % 2 == 0 ? 0 : bytes.size() - std::min(words, bytes.size() - 1);
      std::string damaged = bytes.substr(kept);
      damage(random, damaged);
      write_packed(file, bytes.substr(0, kept) + damaged);
      WorkLog read;
      const std::string message = user_error_of([&] { read = read_log(file); });
      if (message != "no UserError") {
        EXPECT_TRUE(says(message, "a.log")) << message;
        ++refused;
      } else if (!processors::program::fault_of(read).empty() ||
                 !processors::program::fault_of_order(read).empty()) {
        ++refused;
      } else {
        for (int machines = 0; machines < 5; ++machines) {
          const MachineConfig machine = any_machine(random, read);
          static_cast<void>(user_error_of([&] { static_cast<void>(timed(read, machine)); }));
        }
        ++taken;
      }
    }
  }
  EXPECT_GT(refused, 100);
  EXPECT_GT(taken, 5) << "such as those in which a ray has another kind";
}

/// Each use of a damaged file is refused in one line that names the file.
void expect_refused(const std::filesystem::path& file, const std::string& bytes, const std::string& how) {
  write(file, bytes);
  const std::string message = user_error_of([&] { static_cast<void>(read_log(file)); });
  EXPECT_TRUE(message.starts_with(file.string() + ": ")) << how << ": " << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << how;
}

TEST(LogFile, EveryCutAndEveryTurnedBitIsFound) {
  const TemporaryDirectory directory;
  const std::filesystem::path file = directory.path() / "a.log";
  Random random(7);
  write_packed(file, bytes_of(small_log(random, 3)));
  const std::string whole = read(file);
  ASSERT_LT(whole.size(), 4000U);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    expect_refused(file, whole.substr(0, length), "cut at " + std::to_string(length));
  }
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    std::string turned = whole;
    turned[bit / 8] = static_cast<char>(turned[bit / 8] ^ static_cast<char>(1U << bit % 8));
    expect_refused(file, turned, "bit " + std::to_string(bit));
  }
  expect_refused(file, whole + "x", "longer");
  for (int times = 0; times < 200; ++times) {
    std::string bytes(random() % 200, ' ');
    for (char& byte : bytes) {
      byte = static_cast<char>(random());
    }
    expect_refused(file, bytes, "random bytes");
    expect_refused(file, whole.substr(0, 20) + bytes, "random bytes behind the beginning");
  }
}

// Sizes that the file cannot hold, or that memory cannot, are not even tried.
TEST(LogFile, SizesAreCheckedBeforeMemoryIsTaken) {
  const TemporaryDirectory directory;
  const std::filesystem::path file = directory.path() / "a.log";
  WorkLog log;
  log.topology.entries.resize(1000);
  std::string bytes = bytes_of(log);
  const std::string size("\xe8\x03\x00\x00\x00\x00\x00\x00", 8);  // 1000
  ASSERT_NE(bytes.find(size), std::string::npos);
  bytes.replace(bytes.find(size), size.size(), std::string(7, '\xff') + '\x0f');
  write_packed(file, bytes);
  EXPECT_TRUE(says(user_error_of([&] { static_cast<void>(read_log(file)); }), "ends too early"));

  write_packed(file, bytes_of(log));
  PackedReader reader(file);
  reader.limit(sim::MemoryBudget(2000));
  Fields<PackedReader> fields(reader);
  EXPECT_TRUE(
      says(user_error_of([&] { studies::log_file::describe(fields, log); }), "host_machine.memory_limit"));
}

}  // namespace
}  // namespace marti::test
