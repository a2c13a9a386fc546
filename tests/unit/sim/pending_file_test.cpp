#include "sim/pending_file.h"

#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <deque>
#include <regex>
#include <set>
#include <string>

#include "sim/files.h"
#include "tests/support/files.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"

namespace marti::sim {
namespace {

namespace fs = std::filesystem;
using test::names_in;
using test::TemporaryDirectory;
using test::user_error_of;
using test::write;

/// A program that is killed while the file is pending; its temporary name.
std::string left_by_a_killed_program(const fs::path& target) {
  const std::set<std::string> before = names_in(target.parent_path());
  const pid_t child = ::fork();
  if (child == 0) {
    const PendingFile pending(target);
    write(pending.temporary(), "half");
    ::_exit(0);  // without destructors, as by SIGKILL
  }
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  for (const std::string& name : names_in(target.parent_path())) {
    if (!before.contains(name)) {
      return name;
    }
  }
  return {};
}

TEST(PendingFile, TakesItsNameOnlyWhenCommitted) {
  const TemporaryDirectory directory;
  const fs::path target = directory.path() / "image.png";
  {
    const PendingFile pending(target);
    EXPECT_EQ(pending.temporary().extension(), ".png");
    EXPECT_EQ(pending.temporary().parent_path(), directory.path());
    write(pending.temporary(), "half");
  }
  EXPECT_TRUE(fs::is_empty(directory.path()));
  PendingFile pending(target);
  write(pending.temporary(), "a library's, which is longer");
  pending.write("whole");
  EXPECT_FALSE(fs::exists(target));
  pending.commit();
  EXPECT_EQ(read_file(target, 10), "whole");
  EXPECT_EQ(names_in(directory.path()).size(), 1U);
}

TEST(PendingFile, TakesNoPipesPlace) {
  const TemporaryDirectory directory;
  const fs::path pipe = directory.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(user_error_of([&] { const PendingFile pending(pipe); }),
            pipe.string() + ": cannot be written: it is no regular file");
  EXPECT_TRUE(fs::is_fifo(pipe));
}

TEST(PendingFile, HasARandomNameAndIsThereAtOnce) {
  const TemporaryDirectory directory;
  std::set<std::string> names;
  for (int i = 0; i < 20; ++i) {
    const PendingFile pending(directory.path() / "image.png");
    const std::string name = pending.temporary().filename().string();
    EXPECT_TRUE(std::regex_match(name, std::regex(R"(\.image\.tmp-[0-9a-f]{16}\.png)"))) << name;
    EXPECT_EQ(fs::symlink_status(pending.temporary()).type(), fs::file_type::regular);
    EXPECT_EQ(fs::file_size(pending.temporary()), 0U);
    names.insert(name);
  }
  EXPECT_EQ(names.size(), 20U);
}

TEST(PendingFile, NamesMayBeAsLongAsTheSystemAllows) {
  const TemporaryDirectory directory;
  const fs::path target = directory.path() / (std::string(250, 'a') + ".html");
  write_file(target, "page");
  EXPECT_EQ(read_file(target, 100), "page");
}

// Each file is locked as long as the system's limit on open files allows.
TEST(PendingFile, ThereMayBeThousands) {
  const TemporaryDirectory directory;
  std::deque<PendingFile> files;
  for (int i = 0; i < 1500; ++i) {
    files.emplace_back(directory.path() / std::to_string(i)).write(std::to_string(i));
  }
  for (PendingFile& file : files) {
    file.commit();
  }
  EXPECT_EQ(read_file(directory.path() / "1499", 10), "1499");
  EXPECT_EQ(names_in(directory.path()).size(), 1500U);
}

TEST(PendingFile, WhatAKilledProgramLeftGoes) {
  const TemporaryDirectory directory;
  const fs::path target = directory.path() / "image.png";
  const std::string left = left_by_a_killed_program(target);
  ASSERT_FALSE(left.empty());
  { const PendingFile other(directory.path() / "other.png"); }
  EXPECT_TRUE(names_in(directory.path()).contains(left)) << "of another target";
  const PendingFile pending(target);
  EXPECT_EQ(names_in(directory.path()), std::set<std::string>{pending.temporary().filename().string()});
}

TEST(PendingFile, WhatOthersWriteOrOwnStays) {
  const TemporaryDirectory directory;
  const fs::path target = directory.path() / "image.png";
  const PendingFile living(target);
  write(directory.path() / "kept", "kept");
  // Names that are nearly those of temporary files, and such names of things that are not files of marti.
  for (const char* name :
       {".image.tmp-0123456789abcde.png", ".image.tmp-0123456789abcdeF.png", ".image.tmp-1-2.png",
        ".image.part-0123456789abcdef.png", "image.tmp-0123456789abcdef.png"}) {
    write(directory.path() / name, "mine");
  }
  fs::create_symlink("kept", directory.path() / ".image.tmp-0123456789abcdef.png");
  fs::create_directory(directory.path() / ".image.tmp-1123456789abcdef.png");
  const std::set<std::string> before = names_in(directory.path());
  { const PendingFile next(target); }
  EXPECT_EQ(names_in(directory.path()), before);
}

// After the file is gone, another program may use its name.
TEST(PendingFile, AnotherFileInItsPlaceIsNeitherCommittedNorWrittenNorRemoved) {
  const TemporaryDirectory directory;
  const fs::path target = directory.path() / "a";
  write(directory.path() / "kept", "kept");
  fs::path name;
  for (const bool link : {false, true}) {
    PendingFile pending(target);
    name = pending.temporary();
    fs::remove(name);
    EXPECT_NE(user_error_of([&] { pending.commit(); }).find("removed or replaced"), std::string::npos);
    if (link) {
      fs::create_symlink("kept", name);
    } else {
      write(name, "other");
    }
    EXPECT_NE(user_error_of([&] { pending.commit(); }).find("removed or replaced"), std::string::npos);
    EXPECT_TRUE(
        user_error_of([&] { pending.write("x"); }).starts_with(target.string() + ": cannot be written: "));
    EXPECT_FALSE(fs::exists(target));
  }
  EXPECT_TRUE(fs::is_symlink(name));
  EXPECT_EQ(read_file(directory.path() / "kept", 10), "kept");
}

}  // namespace
}  // namespace marti::sim
