// A store whose program is killed at each instant at which it changes a file: SQLite's calls of the operating
// system are counted, and the process kills itself at the n-th. What SQLite maps into memory (the index of
// the log) is rebuilt by the process that opens the store next.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "sim/files.h"
#include "studies/compare/compare.h"
#include "studies/report/read/read_report.h"
#include "studies/sweep/store/points_table.h"
#include "studies/sweep/store/store_parts.h"
#include "studies/sweep/store/sweep_reader.h"
#include "studies/sweep/store/sweep_store.h"
#include "studies/tables/csv.h"
#include "studies/tables/sqlite_connection.h"
#include "tests/support/long_tests.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"
#include "tests/unit/studies/sweep_parts.h"

namespace marti::studies {

using namespace compare;
using namespace report;
using namespace sweep;
using namespace tables;

namespace {

namespace fs = std::filesystem;
using test::TemporaryDirectory;
using test::user_error_of;

constexpr std::size_t killed_machines = 2;

SweepPlan plan() {
  SweepPlan plan = test::made_plan(killed_machines);
  plan.axes[3] = "bus.kind";  // a name that a table can have
  return plan;
}

// Which call kills, counted from 0, and the calls so far: 'c'reate, 'w'rite, 't'runcate, 'u'nlink; also, that
// a result was added: 'r'.
std::size_t last_call = SIZE_MAX;
std::string calls;

void count(char kind) {
  if (calls.size() == last_call) {
    kill(getpid(), SIGKILL);
  }
  calls += kind;
}

sqlite3_vfs& files() { return *sqlite3_vfs_find(nullptr); }

template <class Call>
Call*& original() {
  static Call* call = nullptr;
  return call;
}

using Open = int(const char*, int, int);
using Write = ssize_t(int, const void*, size_t);
using WriteAt = ssize_t(int, const void*, size_t, off_t);
using Truncate = int(int, off_t);
using Unlink = int(const char*);

int counted_open(const char* name, int flags, int mode) {
  if ((flags & O_CREAT) != 0 && access(name, F_OK) != 0) {
    count('c');
  }
  return original<Open>()(name, flags, mode);
}
ssize_t counted_write(int file, const void* bytes, size_t size) {
  count('w');
  return original<Write>()(file, bytes, size);
}
ssize_t counted_write_at(int file, const void* bytes, size_t size, off_t at) {
  count('w');
  return original<WriteAt>()(file, bytes, size, at);
}
int counted_truncate(int file, off_t size) {
  count('t');
  return original<Truncate>()(file, size);
}
int counted_unlink(const char* name) {
  count('u');
  return original<Unlink>()(name);
}

template <class Call>
void replace(const char* name, Call* call) {
  if (const sqlite3_syscall_ptr now = files().xGetSystemCall(&files(), name)) {
    original<Call>() = reinterpret_cast<Call*>(now);
    files().xSetSystemCall(&files(), name, reinterpret_cast<sqlite3_syscall_ptr>(call));
  }
}

void count_calls() {
  replace<Open>("open", counted_open);
  replace<Write>("write", counted_write);
  replace<WriteAt>("pwrite", counted_write_at);
  replace<WriteAt>("pwrite64", counted_write_at);
  replace<Truncate>("ftruncate", counted_truncate);
  replace<Unlink>("unlink", counted_unlink);
}

// All that is missing.
void finish(const fs::path& file) {
  SweepStore store(file, plan());
  const std::vector<bool> frames = store.frames_done();
  const std::vector<bool> done = store.done();
  for (std::size_t frame = 0; frame < frames.size(); ++frame) {
    if (!frames[frame]) {
      store.add_frame(frame, test::made_frame_row(frame), 1);
    }
  }
  for (std::size_t machine = 0; machine < killed_machines; ++machine) {
    if (!done[machine]) {
      store.add_result(machine, test::plain_row(machine), 1);
      count('r');
    }
  }
  store.close();
}

struct Child {
  std::string calls;  // empty when it was killed
  bool killed = false;
};

// Does it in a process of its own, which kills itself at call `last`.
Child run_until(std::size_t last, const std::function<void()>& what) {
  int ends[2];
  if (pipe(ends) != 0) {
    return {};
  }
  const pid_t process = fork();
  if (process == 0) {
    count_calls();
    calls.clear();
    last_call = last;
    try {
      what();
    } catch (const std::exception&) {
      _exit(2);
    }
    [[maybe_unused]] const ssize_t told = ::write(ends[1], calls.data(), calls.size());
    _exit(0);
  }
  close(ends[1]);
  Child child;
  char part[4096];
  for (ssize_t bytes = 0; (bytes = read(ends[0], part, sizeof part)) > 0;) {
    child.calls.append(part, static_cast<std::size_t>(bytes));
  }
  close(ends[0]);
  int status = 0;
  waitpid(process, &status, 0);
  child.killed = WIFSIGNALED(status);
  EXPECT_TRUE(child.killed || (WIFEXITED(status) && WEXITSTATUS(status) == 0)) << status;
  return child;
}

// Where to kill: at each call that follows one of another kind, and at every so many of those that are alike.
std::vector<std::size_t> instants_of(const std::string& made) {
  const std::size_t stride = test::stride(29);
  std::vector<std::size_t> instants;
  for (std::size_t i = 0; i < made.size(); ++i) {
    if (i == 0 || made[i] != made[i - 1] || i % stride == 0 || i + 1 == made.size()) {
      instants.push_back(i);
    }
  }
  return instants;
}

// What can be read of a sweep that was killed; a message if there is nothing yet.
std::string shown(const fs::path& file, std::size_t& done) {
  std::string text;
  const std::string message = user_error_of([&] {
    DoneKeys keys;
    keys.add(file);  // as --plan does
    done = keys.machines.size();
    text = csv_of(points_table(SweepReader(file))) + compare_results(file.string(), file.string());
    text += read_report(file.parent_path()).title;
  });
  return message == "no UserError" ? text : message;
}

class KilledStore : public testing::Test {
 protected:
  KilledStore() {
    const fs::path whole = directory_.path() / "whole.sqlite";
    finish(whole);
    expected_ = test::dump(whole);
  }

  // Kills a process that finishes what `begin` has made, at each instant.
  void kill_at_each_instant(const std::function<void(const fs::path&)>& begin) {
    const fs::path directory = directory_.path() / "out";
    const fs::path file = directory / "results.sqlite";
    const auto anew = [&] {
      fs::remove_all(directory);
      fs::create_directory(directory);
      begin(file);
    };
    anew();
    const std::string made = run_until(SIZE_MAX, [&] { finish(file); }).calls;
    ASSERT_GT(made.size(), 20U);
    EXPECT_EQ(test::dump(file), expected_);
    const auto added_before = [&](std::size_t call) {
      const std::string before = made.substr(0, call);
      return static_cast<std::size_t>(std::count(before.begin(), before.end(), 'r'));
    };
    ASSERT_GE(added_before(made.size()), 1U);
    for (const std::size_t last : instants_of(made)) {
      anew();
      ASSERT_TRUE(run_until(last, [&] { finish(file); }).killed);
      std::size_t done = 0;
      const std::string text = shown(file, done);
      const std::string where = "killed at call " + std::to_string(last) + " of " + made + "\n" + text;
      // No result that was added is lost, and the store can be read; if it cannot, it has not been begun.
      EXPECT_GE(done, added_before(last)) << where;
      const bool nothing_yet = text.find("holds nothing: the sweep was ended") != std::string::npos ||
                               text.find("there is no such file") != std::string::npos ||
                               text.find("has been timed yet") != std::string::npos;
      EXPECT_TRUE(done == 0 ? nothing_yet : text.find("point,machine.nodes") != std::string::npos) << where;
      EXPECT_EQ(user_error_of([&] { finish(file); }), "no UserError") << where;
      EXPECT_EQ(test::dump(file), expected_) << where;
      EXPECT_EQ(std::distance(fs::directory_iterator(directory), fs::directory_iterator()), 1) << where;
    }
  }

  TemporaryDirectory directory_;
  std::string expected_;
};

TEST_F(KilledStore, ANewOne) {
  kill_at_each_instant([](const fs::path& /*file*/) {});
}

// One that was closed in order, and whose log is begun anew.
TEST_F(KilledStore, OneThatIsGoneOnWith) {
  kill_at_each_instant([](const fs::path& file) {
    SweepStore store(file, plan());
    store.add_result(0, test::plain_row(0), 1);
    store.close();
  });
}

// What other programs and older versions do: they change the file through a journal, and are killed.
class HotJournal : public KilledStore {
 protected:
  HotJournal() {
    finish(file_);
    std::size_t done = 0;
    before_ = shown(file_, done);
    const Child child = run_until(SIZE_MAX, [&] {
      SqliteConnection connection(file_, SqliteConnection::Access::write);
      // A cache of few pages: the file is changed before the end of the transaction.
      connection.execute(
          "PRAGMA cache_size = 1; BEGIN; UPDATE results SET hits = 1;"
          "UPDATE columns SET description = 'x'; UPDATE settings SET value = value || 'x';");
      kill(getpid(), SIGKILL);
    });
    EXPECT_TRUE(child.killed);
    EXPECT_TRUE(fs::exists(file_.string() + "-journal"));
  }

  fs::path file_ = directory_.path() / "results.sqlite";
  std::string before_;
};

TEST_F(HotJournal, IsTakenInByReaders) {
  fs::remove(directory_.path() / "whole.sqlite");
  std::size_t done = 0;
  EXPECT_EQ(shown(file_, done), before_);
  EXPECT_EQ(done, killed_machines);
  EXPECT_FALSE(fs::exists(file_.string() + "-journal"));
}

TEST_F(HotJournal, IsTakenInByTheNextSweep) {
  finish(file_);
  EXPECT_EQ(test::dump(file_), expected_);
}

// Where nothing may be written, the message says what to do.
TEST_F(HotJournal, CannotBeTakenInByOneWhoMayNotWrite) {
  fs::permissions(file_, fs::perms{0444});
  fs::permissions(file_.string() + "-journal", fs::perms{0444});
  fs::permissions(directory_.path(), fs::perms{0555});
  const pid_t process = fork();
  if (process == 0) {
    constexpr uid_t nobody = 65534;
    if (getuid() == 0 && setuid(nobody) != 0) {
      _exit(3);
    }
    std::size_t done = 0;
    const std::string text = shown(file_, done);
    const bool says =
        text.starts_with(file_.string()) && text.find("run it again there") != std::string::npos;
    _exit(says ? 42 : 1);
  }
  int status = 0;
  waitpid(process, &status, 0);
  fs::permissions(directory_.path(), fs::perms::owner_all);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 42);
}

}  // namespace
}  // namespace marti::studies
