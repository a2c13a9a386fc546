#include "sim/files.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <thread>
#include <utility>
#include <vector>

#include "sim/made_directory.h"
#include "tests/support/files.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"

namespace marti::sim {
namespace {

using test::names_in;
using test::TemporaryDirectory;
using test::user_error_of;

TEST(Files, WhatIsWrittenIsRead) {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "a.bin";
  std::string content(300'000, '\0');
  for (std::size_t i = 0; i < content.size(); ++i) {
    content[i] = static_cast<char>(i * i);
  }
  for (const Durability durability : {Durability::cached, Durability::synced}) {
    write_file(file, content, durability);
    EXPECT_EQ(read_file(file, 300'000), content);
    write_file(file, "", durability);
    EXPECT_EQ(read_file(file, 300'000), "");
  }
  EXPECT_EQ(names_in(directory.path()).size(), 1U);
}

TEST(Files, ALongFileIsRefused) {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "a";
  write_file(file, "12345");
  EXPECT_EQ(read_file(file, 5), "12345");
  EXPECT_EQ(user_error_of([&] { (void)read_file(file, 4); }), file.string() + ": is too long: more than 4 B");
  EXPECT_THROW((void)read_file("/proc/self/maps", 10), UserError);  // states a size of zero
  EXPECT_FALSE(read_file("/proc/self/maps", 1 << 24).empty());
}

TEST(Files, WhatCannotBeReadSaysWhy) {
  const TemporaryDirectory directory;
  const auto missing = directory.path() / "missing";
  EXPECT_EQ(user_error_of([&] { (void)read_file(missing, 10); }),
            missing.string() + ": cannot be read: No such file or directory");
  EXPECT_EQ(user_error_of([&] { (void)read_file(directory.path(), 10); }),
            directory.path().string() + ": cannot be read: Is a directory");
  EXPECT_THROW((void)read_file("", 10), UserError);
  EXPECT_THROW((void)read_file("/dev/zero", 10), UserError);
  const auto pipe = directory.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(user_error_of([&] { (void)read_file(pipe, 10); }),
            pipe.string() + ": cannot be read: not a regular file");
}

TEST(Files, WhatCannotBeWrittenSaysWhyAndLeavesNothing) {
  const TemporaryDirectory directory;
  const auto nowhere = directory.path() / "no" / "such" / "file";
  EXPECT_EQ(user_error_of([&] { write_file(nowhere, "x"); }),
            nowhere.string() + ": cannot be written: No such file or directory");
  EXPECT_EQ(user_error_of([&] { write_file(directory.path(), "x"); }),
            directory.path().string() + ": cannot be written: Is a directory");
  EXPECT_THROW(write_file("", "x"), UserError);
  EXPECT_THROW(write_file(directory.path() / std::string(300, 'n'), "x"), UserError);
  EXPECT_EQ(names_in(directory.path()).size(), 0U);
}

TEST(Files, AFullDiskLeavesTheOldFile) {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "a";
  write_file(file, "old");
  // A limit on the size of files stands in for the full disk: write() fails half-way in the same manner.
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit = before;
  limit.rlim_cur = 100'000;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  const std::string message = user_error_of([&] { write_file(file, std::string(200'000, 'x')); });
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  (void)std::signal(SIGXFSZ, handler);
  EXPECT_EQ(message, file.string() + ": cannot be written: File too large");
  EXPECT_EQ(read_file(file, 10), "old");
  EXPECT_EQ(names_in(directory.path()).size(), 1U);
}

TEST(Files, ALinkIsReplacedAndNotFollowed) {
  const TemporaryDirectory directory;
  write_file(directory.path() / "kept", "kept");
  std::filesystem::create_symlink("kept", directory.path() / "a");
  write_file(directory.path() / "a", "new");
  EXPECT_EQ(read_file(directory.path() / "kept", 10), "kept");
  EXPECT_EQ(read_file(directory.path() / "a", 10), "new");
  EXPECT_FALSE(std::filesystem::is_symlink(directory.path() / "a"));
}

TEST(Files, ManyWritersOfOneFileNeverMix) {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "shared";
  write_file(file, std::string(50'000, 'a'));
  std::vector<std::thread> writers;
  for (const char letter : {'b', 'c', 'd'}) {
    writers.emplace_back([&file, letter] {
      for (int i = 0; i < 20; ++i) {
        write_file(file, std::string(50'000, letter));
      }
    });
  }
  for (int i = 0; i < 50; ++i) {
    const std::string seen = read_file(file, 100'000);
    EXPECT_EQ(seen, std::string(50'000, seen.front()));
  }
  for (std::thread& writer : writers) {
    writer.join();
  }
  EXPECT_EQ(names_in(directory.path()).size(), 1U);
}

TEST(MadeDirectory, IsMadeWithItsParentsAndStaysWhenItHoldsSomething) {
  const TemporaryDirectory directory;
  const auto deep = directory.path() / "a" / "b";
  {
    const MadeDirectory made(deep);
    const MadeDirectory again(deep);
    EXPECT_TRUE(std::filesystem::is_directory(deep));
    write_file(deep / "file", "x");
    EXPECT_THROW(MadeDirectory(deep / "file"), UserError);
    EXPECT_THROW(MadeDirectory(deep / "file" / "below"), UserError);
  }
  EXPECT_EQ(read_file(deep / "file", 10), "x");
}

TEST(MadeDirectory, LeavesNothingBehindWhereNothingWasWritten) {
  const TemporaryDirectory directory;
  for (const char* name : {"a", "a/b/c", "a/", "a/../b", "./a/./b"}) {
    { const MadeDirectory made(directory.path() / name); }
    EXPECT_EQ(names_in(directory.path()).size(), 0U) << name;
  }
  std::filesystem::create_directory(directory.path() / "there");
  { const MadeDirectory made(directory.path() / "there"); }
  { const MadeDirectory made(directory.path() / "there" / "new"); }
  EXPECT_TRUE(std::filesystem::is_directory(directory.path() / "there")) << "it was there before";
  EXPECT_EQ(names_in(directory.path() / "there").size(), 0U);
  {
    MadeDirectory made(directory.path() / "moved");
    const MadeDirectory other(std::move(made));
    EXPECT_TRUE(std::filesystem::is_directory(directory.path() / "moved"));
  }
  EXPECT_EQ(names_in(directory.path()).size(), 1U);
}

}  // namespace
}  // namespace marti::sim
