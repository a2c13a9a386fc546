// The command `marti explore`: its address, its end, its refusals. Its answers are tested in unit/studies and
// browser.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>

#include "tests/cli/shell.h"
#include "tests/cli/started.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

TEST(ExploreCommand, PrintsItsAddressAndEndsAfterItsTime) {
  const Outcome outcome = marti("explore " + small_run + " --for 0.05");
  EXPECT_EQ(outcome.status, 0);
  ASSERT_EQ(outcome.output.find("http://127.0.0.1:"), 0U) << outcome.output;
  // The token and a line end; nothing else is printed.
  const std::size_t token = outcome.output.find('/', std::string("http://").size()) + 1;
  EXPECT_EQ(outcome.output.find_first_not_of("0123456789abcdef", token), token + 32);
  EXPECT_EQ(outcome.output.substr(token + 32), "/\n");
}

TEST(ExploreCommand, ATimeThatIsNoNumberIsRefused) {
  for (const std::string time : {"nan", "inf", "-1"}) {
    const Outcome outcome = marti("explore " + small_run + " --for " + time);
    EXPECT_EQ(outcome.status, 2) << time;
    EXPECT_TRUE(outcome.output.find("--for") != std::string::npos) << outcome.output;
  }
}

TEST(ExploreCommand, ASignalEndsIt) {
  const TemporaryDirectory directory;
  const std::filesystem::path output = directory.path() / "output";
  Started explore(
      {"explore", std::string(MARTI_SOURCE) + "/configs/marti.toml", "--set", "scene.source=tetra:2", "--set",
       "image.width=8", "--set", "image.height=8", "--for", "60"},
      output);
  while (read(output).find('\n') == std::string::npos && !explore.ended()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  explore.send(SIGINT);
  EXPECT_EQ(explore.wait(), -SIGINT);
}

TEST(ExploreCommand, RefusesWhatItCannotShow) {
  expect_refused("explore none.toml", "none.toml");
  expect_refused("explore " + small_run + " --set cache.size=1B", "cache.size");
  expect_refused("explore " + shipped("marti.toml") + " --port 70000", "70000");
  expect_refused("explore " + shipped("marti.toml") + " --set frames.count=2", "frames.count");
}

}  // namespace
}  // namespace marti::test
