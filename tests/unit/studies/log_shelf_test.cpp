// The shelf: whatever its limits and directories, a log that is taken is the one that was put there.
#include "studies/sweep/log_shelf.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <thread>

#include "kept_logs.h"
#include "studies/version.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"

namespace marti::studies {
namespace {

using marti::test::Random;
using marti::test::TemporaryDirectory;
using marti::test::user_error_of;
using test::expect_equal;
using test::key_of;

std::vector<FrameLog> some_frames(std::size_t count) {
  Random random(count);
  std::vector<FrameLog> frames;
  for (std::size_t i = 0; i < count; ++i) {
    frames.push_back(test::random_frame(random, 10, static_cast<std::uint32_t>(10 + i)));
  }
  return frames;
}

// The shelf is to be the only owner.
FrameLog copy_of(const FrameLog& frame) {
  return {std::make_shared<const processors::WorkLog>(*frame.log), frame.row};
}

std::uint64_t largest(const std::vector<FrameLog>& frames) {
  std::uint64_t bytes = 0;
  for (const FrameLog& frame : frames) {
    bytes = std::max(bytes, memory_of(*frame.log));
  }
  return bytes;
}

std::size_t files_in(const std::filesystem::path& directory) {
  return static_cast<std::size_t>(
      std::distance(std::filesystem::directory_iterator(directory), std::filesystem::directory_iterator()));
}

void run_on_threads(unsigned threads, const std::function<void(unsigned)>& work) {
  std::vector<std::thread> running;
  for (unsigned thread = 0; thread < threads; ++thread) {
    running.emplace_back(work, thread);
  }
  for (std::thread& thread : running) {
    thread.join();
  }
}

RC_GTEST_PROP(LogShelf, GivesBackWhatWasPutThere, (std::uint64_t seed)) {
  Random random(seed);
  const TemporaryDirectory spill;
  const TemporaryDirectory cache;
  const std::vector<FrameLog> frames = some_frames(6);
  const std::uint64_t limit = random() % (4 * largest(frames));
  {
    LogShelf shelf({limit, spill.path(), random() % 2 == 0 ? cache.path() : std::filesystem::path()});
    std::vector<bool> there(frames.size());
    for (int step = 0; step < 40; ++step) {
      const std::size_t i = random() % frames.size();
      if (!there[i]) {
        shelf.put(key_of(i), copy_of(frames[i]));
        there[i] = true;
      } else if (random() % 6 == 0) {
        shelf.drop(key_of(i));
        there[i] = false;
      } else {
        expect_equal(*shelf.take(key_of(i)), frames[i]);
        RC_ASSERT(!::testing::Test::HasFatalFailure());
      }
      RC_ASSERT(shelf.in_memory() <= std::max(limit, largest(frames)));
    }
    RC_ASSERT(shelf.notes().empty());
  }
  RC_ASSERT(files_in(spill.path()) == 0U);
}

TEST(LogShelf, ManyThreadsShareALittleMemory) {
  const TemporaryDirectory spill;
  const std::vector<FrameLog> frames = some_frames(8);
  for (const std::uint64_t limit : {std::uint64_t{0}, 2 * largest(frames), 5 * largest(frames)}) {
    LogShelf shelf({limit, spill.path(), {}});
    std::atomic<std::uint64_t> wrong{0};
    run_on_threads(4, [&](unsigned thread) {
      for (std::size_t i = thread; i < frames.size(); i += 4) {
        shelf.put(key_of(i), copy_of(frames[i]));
      }
    });
    EXPECT_LE(shelf.in_memory(), std::max(limit, largest(frames)));
    run_on_threads(4, [&](unsigned thread) {
      Random random(thread);
      for (int step = 0; step < 60; ++step) {
        const std::size_t i = random() % frames.size();
        const std::shared_ptr<const FrameLog> log = shelf.take(key_of(i));
        wrong +=
            log->row == frames[i].row && log->log->rows[3].words == frames[i].log->rows[3].words ? 0U : 1U;
        wrong += shelf.in_memory() <= std::max(limit, largest(frames)) ? 0U : 1U;
      }
    });
    EXPECT_EQ(wrong, 0U);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      shelf.drop(key_of(i));
    }
    EXPECT_EQ(shelf.in_memory(), 0U);
    EXPECT_EQ(files_in(spill.path()), limit < 5 * largest(frames) ? 1U : files_in(spill.path()))
        << "the lock alone";
  }
  EXPECT_EQ(files_in(spill.path()), 0U);
}

TEST(LogShelf, WhoHoldsOneLogGetsAnother) {
  const TemporaryDirectory spill;
  const std::vector<FrameLog> frames = some_frames(6);
  LogShelf shelf({1, spill.path(), {}});
  for (std::size_t i = 0; i < frames.size(); ++i) {
    shelf.put(key_of(i), copy_of(frames[i]));
  }
  std::atomic<std::uint64_t> wrong{0};
  run_on_threads(3, [&](unsigned thread) {
    Random random(thread);
    for (int step = 0; step < 40; ++step) {
      const std::size_t first = random() % frames.size();
      const std::size_t second = random() % frames.size();
      const std::shared_ptr<const FrameLog> a = shelf.take(key_of(first));
      const std::shared_ptr<const FrameLog> b = shelf.take(key_of(second));
      wrong += a->row == frames[first].row && b->row == frames[second].row ? 0U : 1U;
      wrong += first != second || a->log == b->log ? 0U : 1U;
    }
  });
  EXPECT_EQ(wrong, 0U);
}

TEST(LogShelf, WaitsForRoom) {
  const TemporaryDirectory spill;
  const std::vector<FrameLog> frames = some_frames(2);
  LogShelf shelf({largest(frames), spill.path(), {}});
  shelf.put(key_of(0), copy_of(frames[0]));
  shelf.put(key_of(1), copy_of(frames[1]));
  std::shared_ptr<const FrameLog> held = shelf.take(key_of(0));
  std::atomic<bool> let_go{false};
  bool waited = false;
  std::thread other([&] {
    const std::shared_ptr<const FrameLog> log = shelf.take(key_of(1));
    waited = let_go;
    EXPECT_EQ(log->row, frames[1].row);
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  let_go = true;
  held.reset();
  other.join();
  EXPECT_TRUE(waited);
}

TEST(LogShelf, ALogOutlivesItsShelf) {
  const TemporaryDirectory spill;
  const std::vector<FrameLog> frames = some_frames(1);
  std::shared_ptr<const FrameLog> log;
  {
    LogShelf shelf({0, spill.path(), {}});
    shelf.put(key_of(0), copy_of(frames[0]));
    log = shelf.take(key_of(0));
    shelf.drop(key_of(0));
    EXPECT_THROW(static_cast<void>(shelf.take(key_of(0))), sim::InternalError);
    EXPECT_GT(shelf.in_memory(), 0U);
  }
  expect_equal(*log, frames[0]);
}

TEST(LogShelf, KeepsLogsForTheNextSweep) {
  const TemporaryDirectory spill;
  const TemporaryDirectory parent;
  const std::filesystem::path cache = parent.path() / "made" / "cache";
  const std::vector<FrameLog> frames = some_frames(2);
  std::string note;
  {
    LogShelf shelf({0, spill.path(), cache});
    EXPECT_EQ(shelf.find_kept(key_of(0), note), nullptr);
    EXPECT_EQ(note, "");
    run_on_threads(2, [&](unsigned i) { shelf.put(key_of(i), copy_of(frames[i])); });
    EXPECT_EQ(files_in(spill.path()), 0U) << "what is kept need not be spilled";
    expect_equal(*shelf.take(key_of(1)), frames[1]);
    shelf.drop(key_of(0));
  }
  EXPECT_EQ(files_in(cache), 2U);
  const std::filesystem::path file = cache / (key_of(0) + ".martilog");
  {
    LogShelf shelf({0, spill.path(), cache});
    const std::shared_ptr<const FrameLog> kept = shelf.find_kept(key_of(0), note);
    ASSERT_NE(kept, nullptr) << note;
    expect_equal(*kept, frames[0]);
    EXPECT_EQ(shelf.take(key_of(0)), kept);
    shelf.put(key_of(0), copy_of(frames[1]));
    EXPECT_EQ(shelf.take(key_of(0))->row, frames[0].row) << "it stays";
  }
  for (const bool other_version : {false, true}) {
    if (other_version) {
      std::filesystem::remove(file);
      write_log_file(file, frames[0], key_of(0), "0.0.7");
    } else {
      std::filesystem::resize_file(file, std::filesystem::file_size(file) - 1);
    }
    LogShelf shelf({0, spill.path(), cache});
    EXPECT_EQ(shelf.find_kept(key_of(0), note), nullptr);
    EXPECT_NE(note.find(file.string() + ": is not a whole work log of this program"), std::string::npos)
        << note;
    shelf.put(key_of(0), copy_of(frames[0]));
    EXPECT_EQ(files_in(cache), 2U);
    LogShelf next({0, spill.path(), cache});
    EXPECT_NE(next.find_kept(key_of(0), note), nullptr) << "the damaged file was replaced";
    EXPECT_EQ(note, "");
  }
}

TEST(LogShelf, TwoProgramsMayKeepOneLogAtOnce) {
  const TemporaryDirectory spill;
  const TemporaryDirectory cache;
  const std::vector<FrameLog> frames = some_frames(1);
  run_on_threads(4, [&](unsigned) {
    for (int i = 0; i < 5; ++i) {
      LogShelf shelf({0, spill.path(), cache.path()});
      shelf.put(key_of(0), copy_of(frames[0]));
      std::string note;
      EXPECT_NE(shelf.find_kept(key_of(0), note), nullptr);
      EXPECT_TRUE(shelf.notes().empty());
    }
  });
  EXPECT_EQ(files_in(cache.path()), 1U);
}

TEST(LogShelf, ACacheThatCannotBeWrittenIsNoted) {
  const TemporaryDirectory directory;
  const std::vector<FrameLog> frames = some_frames(2);
  std::ofstream(directory.path() / "file") << "x";
  LogShelf never({1U << 30U, directory.path(), directory.path() / "file" / "cache"});
  const std::vector<std::string> notes = never.notes();
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("cannot be made a directory"), std::string::npos) << notes[0];
  never.put(key_of(0), copy_of(frames[0]));
  expect_equal(*never.take(key_of(0)), frames[0]);

  LogShelf later({0, directory.path(), directory.path() / "cache"});
  std::filesystem::remove(directory.path() / "cache");
  for (std::size_t i = 0; i < frames.size(); ++i) {
    later.put(key_of(i), copy_of(frames[i]));
  }
  EXPECT_EQ(later.notes().size(), 1U) << "said once";
  EXPECT_TRUE(later.notes().empty());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    expect_equal(*later.take(key_of(i)), frames[i]);
  }
}

TEST(LogShelf, SpillingThatFailsIsAnError) {
  const TemporaryDirectory directory;
  const std::vector<FrameLog> frames = some_frames(2);
  LogShelf shelf({0, directory.path() / "none", {}});
  shelf.put(key_of(0), copy_of(frames[0]));  // one may always stay
  const std::string message = user_error_of([&] { shelf.put(key_of(1), copy_of(frames[1])); });
  EXPECT_NE(message.find("none: work logs that do not fit in memory cannot be written there"),
            std::string::npos)
      << message;
  EXPECT_THROW(static_cast<void>(shelf.take(key_of(1))), sim::InternalError);
  expect_equal(*shelf.take(key_of(0)), frames[0]);
  shelf.drop(key_of(0));
  shelf.put(key_of(1), copy_of(frames[1]));
  expect_equal(*shelf.take(key_of(1)), frames[1]);
}

TEST(LogShelf, RemovesWhatKilledProgramsLeft) {
  const TemporaryDirectory spill;
  const TemporaryDirectory cache;
  const std::vector<FrameLog> frames = some_frames(3);
  LogShelf living({0, spill.path(), {}});
  for (std::size_t i = 0; i < frames.size(); ++i) {
    living.put(key_of(i), copy_of(frames[i]));
  }
  const std::size_t used = files_in(spill.path());
  ASSERT_GE(used, 3U);
  const std::string token = ".marti-spill-0123456789abcdef.tmp-1-";
  for (const char* name : {"0.lock", "1.log", "2.log"}) {
    std::ofstream(spill.path() / (token + name)) << "x";
  }
  std::ofstream(spill.path() / ".marti-spill-fedcba9876543210.tmp-1-5.log") << "without a lock";
  std::ofstream(spill.path() / "mine.log") << "not ours";
  const std::string half = "." + key_of(3) + ".tmp-1-2.martilog";
  std::ofstream(cache.path() / half) << "x";
  std::ofstream(cache.path() / ("." + key_of(4) + ".tmp-1-2.martilog")) << "x";
  std::FILE* const writing = std::fopen((cache.path() / half).c_str(), "r+");
  ASSERT_EQ(::flock(::fileno(writing), LOCK_EX), 0);
  const LogShelf next({0, spill.path(), cache.path()});
  EXPECT_EQ(files_in(spill.path()), used + 1);
  EXPECT_EQ(files_in(cache.path()), 1U) << "another program writes it";
  static_cast<void>(std::fclose(writing));
  const LogShelf last({0, spill.path(), cache.path()});
  EXPECT_EQ(files_in(cache.path()), 0U);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    expect_equal(*living.take(key_of(i)), frames[i]);
  }
}

}  // namespace
}  // namespace marti::studies
