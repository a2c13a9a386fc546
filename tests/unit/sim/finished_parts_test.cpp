// Parts of work that are kept until all of it is done.
#include "sim/finished_parts.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "sim/error.h"
#include "tests/support/files.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"

namespace marti::sim {
namespace {

namespace fs = std::filesystem;

struct Answer {
  double number = 0.0;
  std::string text;
  std::vector<std::uint32_t> list;
};

class Parts : public testing::Test {
 protected:
  /// What once() gives for part `number`, and whether it was done now.
  std::pair<Answer, bool> part(FinishedParts* parts, int number) {
    WorkMeter meter;
    meter.keep_in(parts);
    Answer answer;
    bool done = false;
    once(
        &meter, "parts", std::to_string(number),
        [&] {
          done = true;
          answer = {number + 0.5, std::string(static_cast<std::size_t>(number), 'x'), {7, 8}};
        },
        answer.number, answer.text, answer.list);
    EXPECT_EQ(meter.state().whole_done, 1U);
    EXPECT_EQ(answer.number, number + 0.5);
    EXPECT_EQ(answer.text.size(), static_cast<std::size_t>(number));
    EXPECT_EQ(answer.list, (std::vector<std::uint32_t>{7, 8}));
    return {answer, done};
  }
  /// The file after three parts, as a program leaves it that is killed then.
  std::string three_parts() {
    FinishedParts parts(file(), "work");
    for (const int number : {1, 2, 3}) {
      EXPECT_TRUE(part(&parts, number).second);
      EXPECT_FALSE(part(&parts, number).second);
    }
    return test::read(file());
  }
  [[nodiscard]] fs::path file() const { return directory_.path() / "parts"; }

 private:
  test::TemporaryDirectory directory_;
};

TEST_F(Parts, AreDoneOnceInAllCalls) {
  const std::string content = three_parts();
  EXPECT_FALSE(fs::exists(file())) << "work that ends leaves no file";
  test::write(file(), content);
  FinishedParts parts(file(), "work");
  EXPECT_EQ(parts.taken_up(), 3U);
  for (const int number : {1, 2, 3}) {
    EXPECT_FALSE(part(&parts, number).second);
  }
  EXPECT_TRUE(part(&parts, 4).second);
  EXPECT_TRUE(part(nullptr, 1).second);
}

// Wherever the file ends, and whatever byte of it is another one, the parts before are there, and what is
// done anew is found by the next call.
TEST_F(Parts, BeforeADamageAreThere) {
  const std::string content = three_parts();
  for (std::size_t i = 0; i < content.size(); i += 7) {
    for (const bool cut : {true, false}) {
      std::string damaged = cut ? content.substr(0, i) : content;
      if (!cut) {
        damaged[i] = static_cast<char>(damaged[i] ^ 4);
      }
      test::write(file(), damaged);
      try {
        std::string after;
        {
          FinishedParts parts(file(), "work");
          EXPECT_LT(parts.taken_up(), 3U) << i;
          for (const int number : {1, 2, 3}) {
            part(&parts, number);
          }
          after = test::read(file());
        }
        test::write(file(), after);
        EXPECT_EQ(FinishedParts(file(), "work").taken_up(), 3U) << i;
      } catch (const UserError& error) {
        EXPECT_FALSE(cut) << i;
        EXPECT_TRUE(test::says(error.what(), "is not of marti")) << error.what();
      }
    }
  }
}

TEST_F(Parts, OfOtherWorkAreDropped) {
  test::write(file(), three_parts());
  EXPECT_EQ(FinishedParts(file(), "other work").taken_up(), 0U);
}

// A file that was read and has changed since may give another answer.
TEST_F(Parts, OfAnotherInputAreDoneAnew) {
  const test::TemporaryDirectory inputs;
  test::write(inputs.path() / "scene", "one");
  note_input(inputs.path() / "scene");
  FinishedParts parts(file(), "work");
  EXPECT_TRUE(part(&parts, 1).second);
  EXPECT_FALSE(part(&parts, 1).second);
  test::write(inputs.path() / "scene", "three");
  EXPECT_TRUE(part(&parts, 1).second);
}

TEST_F(Parts, OfAnotherProgramOrProcessAreRefused) {
  test::write(file(), "a user's file");
  EXPECT_TRUE(
      test::says(test::user_error_of([&] { const FinishedParts parts(file(), "work"); }), "is not of marti"));
  EXPECT_EQ(test::read(file()), "a user's file");
  fs::remove(file());
  const FinishedParts parts(file(), "work");
  EXPECT_TRUE(test::says(test::user_error_of([&] { const FinishedParts other(file(), "work"); }),
                         "another process runs a study"));
}

}  // namespace
}  // namespace marti::sim
