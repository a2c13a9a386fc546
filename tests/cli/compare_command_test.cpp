// `marti compare` as its user runs it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/cli/shell.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;

const std::string small_run = quoted(fs::path(MARTI_SOURCE) / "configs" / "marti.toml") + small_teapot;

TEST(CompareCommand, ListsWhatDiffersBetweenTwoRuns) {
  const TemporaryDirectory directory;
  const std::string a = quoted(directory.path() / "a");
  const std::string b = quoted(directory.path() / "b");
  ASSERT_EQ(marti("run " + small_run + " -o " + a).status, 0);
  ASSERT_EQ(marti("run " + small_run + " --set cache.size=1KiB -o " + b).status, 0);
  const Outcome same = marti("compare " + a + " " + a);
  EXPECT_EQ(same.status, 0) << same.output;
  EXPECT_NE(same.output.find("configuration  0 settings differ"), std::string::npos) << same.output;
  EXPECT_NE(same.output.find("results        0 figures differ"), std::string::npos) << same.output;
  const Outcome text = marti("compare " + a + " " + b);
  EXPECT_EQ(text.status, 0) << text.output;
  EXPECT_NE(text.output.find("cache.size"), std::string::npos) << text.output;
  EXPECT_NE(text.output.find("1 setting differs"), std::string::npos) << text.output;
  EXPECT_LT(text.output.find("cache.size"), text.output.find("results ")) << "the configuration comes first";
  EXPECT_EQ(text.output.find("image_hash"), std::string::npos) << "the image does not depend on the machine";
  const Outcome json = marti("compare " + a + " " + b + " --json");
  ASSERT_EQ(json.status, 0) << json.output;
  const auto found = nlohmann::json::parse(json.output);
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
  const Outcome all = marti("compare " + a + " " + b + " --all");
  EXPECT_NE(all.output.find("image_hash"), std::string::npos) << all.output;
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
