// Runs the program as its user does.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/files.h"

namespace marti::test {

struct Outcome {
  int status = -1;
  std::string output;  // standard output and error
};

// Through a shell, so that a test can redirect and limit it.
inline Outcome shell(const std::string& command) {
  Outcome outcome;
  FILE* pipe = popen(("( " + command + " ) 2>&1").c_str(), "r");
  std::array<char, 4096> buffer{};
  for (std::size_t n = 0; pipe != nullptr && (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
    outcome.output.append(buffer.data(), n);
  }
  const int status = pclose(pipe);
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return outcome;
}

inline std::string quoted(const std::filesystem::path& path) { return "'" + path.string() + "'"; }

inline Outcome marti(const std::string& arguments) { return shell(quoted(MARTI_PROGRAM) + " " + arguments); }

/// Whether the program has printed the text; a failed expectation shows all that it has printed.
inline testing::AssertionResult says(const Outcome& outcome, const std::string& text) {
  const bool said = outcome.output.find(text) != std::string::npos;
  return (said ? testing::AssertionSuccess() : testing::AssertionFailure()) << outcome.output;
}

/// The program must refuse these arguments in these words.
inline void expect_refused(const std::string& arguments, const std::string& words) {
  const Outcome outcome = marti(arguments);
  EXPECT_EQ(outcome.status, 2) << arguments << "\n" << outcome.output;
  EXPECT_PRED_FORMAT2(testing::IsSubstring, words, outcome.output) << arguments;
}

/// A study wrote the same files with the same bytes into both directories, except for times of the host, the
/// database, and files.json, which has the hashes of these. Returns how many files were compared.
inline int expect_same_files(const std::filesystem::path& a, const std::filesystem::path& b) {
  int compared = 0;
  for (const std::string& name : names_in(a)) {
    EXPECT_TRUE(std::filesystem::exists(b / name)) << name;
    EXPECT_GT(std::filesystem::file_size(a / name), 0U) << name;
    if (!name.starts_with("host") && name != "results.sqlite" && name != "files.json") {
      ++compared;
      EXPECT_EQ(read(a / name), read(b / name)) << name;
    }
  }
  return compared;
}

/// Runs a study to its end, but ends it up to three times when it has finished one more of its parts.
inline Outcome study_in_pieces(const std::string& study, const std::filesystem::path& output) {
  const std::string size = "stat -c %s " + quoted(output / "unfinished.parts") + " 2>/dev/null || echo 0";
  return shell(
      "size=0; for ends in 1 2 3 4; do " + quoted(MARTI_PROGRAM) + " study " + study + " -o " +
      quoted(output) + " & p=$!; while [ $ends -lt 4 ] && kill -0 $p 2>/dev/null; do now=$(" + size +
      "); if [ $now -gt 200 ] && [ $now -gt $size ]; then kill $p 2>/dev/null; size=$now; break; fi; "
      "done; wait $p; status=$?; [ $status -eq 143 ] || exit $status; done; exit $status");
}

/// A study prints these words and writes these files into a/ of the directory, and the same ones once more
/// into b/, in pieces. Returns how many files were the same.
inline int expect_study(const std::string& study, const std::filesystem::path& directory,
                        const std::vector<std::string>& words, const std::vector<std::string>& files) {
  const Outcome outcome = marti("study " + study + " -o " + quoted(directory / "a"));
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  for (const std::string& text : words) {
    EXPECT_TRUE(says(outcome, text)) << text;
  }
  for (const std::string& name : files) {
    EXPECT_TRUE(std::filesystem::exists(directory / "a" / name)) << name;
  }
  const Outcome pieces = study_in_pieces(study, directory / "b");
  EXPECT_EQ(pieces.status, 0) << pieces.output;
  EXPECT_FALSE(std::filesystem::exists(directory / "b" / "unfinished.parts"));
  return expect_same_files(directory / "a", directory / "b");
}

/// A study cannot write files larger than a few blocks, such as its database, as on a full disk: it ends, and
/// the results that are there stay.
inline void expect_kept_on_a_full_disk(const std::string& study, const std::filesystem::path& results) {
  const auto before = files_of(results);
  const Outcome full = shell("ulimit -f 8; trap '' XFSZ; " + quoted(MARTI_PROGRAM) + " study " + study +
                             " --set node.clock=40MHz -o " + quoted(results));
  EXPECT_EQ(full.status, 2) << full.output;
  EXPECT_TRUE(before == files_of(results)) << "a file has changed, or one was left behind";
}

/// Settings of a run that takes no time.
inline const std::string small_teapot =
    " --set image.width=24 --set image.height=16 --set scene.source=teapot:2";

/// A configuration that comes with the program, as an argument.
inline std::string shipped(const std::string& name) {
  return quoted(std::filesystem::path(MARTI_SOURCE) / "configs" / name);
}
inline const std::string small_run = shipped("marti.toml") + small_teapot;

}  // namespace marti::test
