// `marti compare` as its user runs it.
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "tests/cli/printed_json.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;

TEST(CompareCommand, ListsWhatDiffersBetweenTwoRuns) {
  const TemporaryDirectory directory;
  const std::string a = quoted(directory.path() / "a");
  const std::string b = quoted(directory.path() / "b");
  ASSERT_EQ(marti("run " + small_run + " -o " + a).status, 0);
  ASSERT_EQ(marti("run " + small_run + " --set cache.size=1KiB -o " + b).status, 0);
  const Outcome same = marti("compare " + a + " " + a);
  EXPECT_EQ(same.status, 0) << same.output;
  EXPECT_TRUE(says(same, "configuration  0 settings differ"));
  EXPECT_TRUE(says(same, "results        0 figures differ"));
  const Outcome text = marti("compare " + a + " " + b);
  EXPECT_EQ(text.status, 0) << text.output;
  EXPECT_TRUE(says(text, "cache.size"));
  EXPECT_TRUE(says(text, "1 setting differs"));
  EXPECT_LT(text.output.find("cache.size"), text.output.find("results ")) << "the configuration comes first";
  EXPECT_FALSE(says(text, "image_hash")) << "the image does not depend on the machine";
  const nlohmann::json found = printed_json("compare " + a + " " + b);
  double last = 2.0;
  for (const auto& difference : found["numbers"]) {
    EXPECT_LE(difference["relative"].get<double>(), last);
    last = difference["relative"].get<double>();
  }
  const auto one = nlohmann::json::parse(read(directory.path() / "a" / "result.json"));
  const auto other = nlohmann::json::parse(read(directory.path() / "b" / "result.json"));
  bool frame_time = false;
  for (const auto& difference : found["numbers"]) {
    if (difference["name"] == "end") {
      frame_time = true;
      EXPECT_EQ(difference["a"], one["figures"]["machine"]["end"]);
      EXPECT_EQ(difference["b"], other["figures"]["machine"]["end"]);
    }
  }
  EXPECT_TRUE(frame_time);
  // A difference that another order of packets makes as well is told as that.
  const std::string noise = "no more than another order of packets does";
  EXPECT_FALSE(says(text, noise));
  nlohmann::json wide = one;
  wide["machine"]["what_helps"]["noise"] = {
      {"replays", 5}, {"shortest_ps", 1}, {"longest_ps", 2}, {"band", 1e6}};
  std::ofstream(directory.path() / "a" / "result.json") << wide;
  EXPECT_TRUE(says(marti("compare " + a + " " + b), noise));
  const Outcome all = marti("compare " + a + " " + b + " --all");
  EXPECT_TRUE(says(all, "image_hash"));
}

// Runs of two machines, of which the second has a smaller cache.
class ComparePage : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(marti("run " + small_run + " -o " + quoted(a_)).status, 0);
    ASSERT_EQ(marti("run " + small_run + " --set cache.size=1KiB -o " + quoted(b_)).status, 0);
    if (says(marti(command("probe.html")), "built without the scripts")) {
      GTEST_SKIP() << "built without the scripts of pages";
    }
  }
  [[nodiscard]] std::string command(const std::string& page) const {
    return "compare " + quoted(a_) + " " + quoted(b_) + " -o " + quoted(directory_.path() / page);
  }

  TemporaryDirectory directory_;
  fs::path a_ = directory_.path() / "\"a\" <b>";
  fs::path b_ = directory_.path() / "b";
};

TEST_F(ComparePage, IsOneFileThatLoadsNothing) {
  a_ = b_;
  const Outcome made = marti(command("page.html"));
  EXPECT_EQ(made.status, 0) << made.output;
  EXPECT_TRUE(says(made, "wrote " + (directory_.path() / "page.html").string()));
  const std::string page = read(directory_.path() / "page.html");
  EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
  EXPECT_NE(page.find("Content-Security-Policy"), std::string::npos);
  EXPECT_EQ(page.find("src=\"http"), std::string::npos);
  EXPECT_EQ(page.find("<link rel=\"stylesheet"), std::string::npos);
  // Again over the page that is there, and as JSON, which stays JSON.
  EXPECT_NO_THROW((void)printed_json(command("page.html")));
  EXPECT_EQ(read(directory_.path() / "page.html"), page) << "equal files give equal bytes";
}

TEST_F(ComparePage, IsNotWrittenWhereItCannotBe) {
  expect_refused(command("none/page.html"), "none");
  write(directory_.path() / "notes.txt", "mine");
  expect_refused(command("notes.txt"), "is not an HTML page");
  EXPECT_EQ(read(directory_.path() / "notes.txt"), "mine");
  expect_refused("compare " + quoted(b_) + " " + quoted(b_) + " -o /dev/full",
                 "/dev/full: is no regular file");
  EXPECT_EQ(marti("compare " + quoted(b_) + " " + quoted(b_) + " -o ''").status, 2);
  const std::string page = "<!DOCTYPE html>older";
  write(directory_.path() / "page.html", page);
  a_ = directory_.path() / "missing";
  EXPECT_EQ(marti(command("page.html")).status, 2);
  EXPECT_EQ(read(directory_.path() / "page.html"), page) << "nothing to compare: the page stays";
}

TEST_F(ComparePage, AFailingWriteLeavesAnOlderPage) {
  a_ = b_;
  const std::string page = "<!DOCTYPE html>older";
  write(directory_.path() / "page.html", page);
  // A file may have 64 blocks of 1 KiB; the page is larger.
  const Outcome limited =
      shell("trap '' XFSZ; ulimit -f 64; " + quoted(MARTI_PROGRAM) + " " + command("page.html"));
  EXPECT_EQ(limited.status, 2) << limited.output;
  EXPECT_TRUE(says(limited, "page.html"));
  EXPECT_EQ(read(directory_.path() / "page.html"), page);
  std::size_t files = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory_.path())) {
    files += entry.is_regular_file() ? 1 : 0;
  }
  EXPECT_LE(files, 2U) << "no temporary file is left beside page.html and probe.html";
}

TEST(CompareCommand, RefusesWhatItCannotCompare) {
  const TemporaryDirectory directory;
  const std::string place = quoted(directory.path());
  expect_refused("compare " + place + "/none " + place, "/none: there is no such file");
  write(directory.path() / "result.json", "{\"marti\": {");
  EXPECT_EQ(marti("compare " + place + " " + place).status, 2);
  EXPECT_EQ(marti("compare " + place).status, 2);
}

}  // namespace
}  // namespace marti::test
