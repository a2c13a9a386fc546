// Foreign text in messages, and the key that is to blame for a time that does not fit.
#include "sim/shown.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "sim/config_errors.h"
#include "tests/support/user_error.h"

namespace marti::sim {
namespace {

TEST(Shown, EscapesWhatIsNoPrintableCharacter) {
  EXPECT_EQ(shown("plain \"text\" \\ here"), "plain \"text\" \\ here");
  EXPECT_EQ(shown("a\tb\nc\rd"), "a\\tb\\nc\\rd");
  EXPECT_EQ(shown(std::string_view("\0\x1b[2J\x7f", 6)), "\\u0000\\u001b[2J\\u007f");
  EXPECT_EQ(shown("caf\u00e9 \u2603 \U0001f600"), "caf\u00e9 \u2603 \U0001f600");
  EXPECT_EQ(shown("\xc2\x9b\xe2\x80\xae\xef\xbb\xbf"), "\\u009b\\u202e\\ufeff");
  // UTF-8 that is too short, a lone continuation, overlong, a surrogate, beyond the last character.
  EXPECT_EQ(shown("\xe2\x82"), "\\xe2\\x82");
  EXPECT_EQ(shown("\x80z\xc0\xaf"), "\\x80z\\xc0\\xaf");
  EXPECT_EQ(shown("\xed\xa0\x80"), "\\xed\\xa0\\x80");
  EXPECT_EQ(shown("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");
}

TEST(Shown, EndsAfterSoManyCharacters) {
  EXPECT_EQ(shown(std::string(200, 'a')), std::string(200, 'a'));
  EXPECT_EQ(shown(std::string(201, 'a')), std::string(200, 'a') + "...");
  EXPECT_EQ(shown("\u00e9\u00e9\u00e9", 2), "\u00e9\u00e9...");
  EXPECT_EQ(shown(std::string(5000, 'a'), all_shown), std::string(5000, 'a'));
}

TEST(Shown, ChangesNothingTheSecondTime) {
  std::mt19937 random(5);
  for (int i = 0; i < 2000; ++i) {
    std::string bytes(random() % 40, ' ');
    for (char& byte : bytes) {
      byte = static_cast<char>(random());
    }
    const std::string once = shown(bytes);
    EXPECT_EQ(shown(once, all_shown), once);
    for (const char c : once) {
      EXPECT_TRUE(static_cast<unsigned char>(c) >= 0x20 && c != 0x7f);
    }
  }
}

TEST(LongestDuration, IsTheCyclesOrTheClockWhicheverIsUnusual) {
  const auto values = [](std::string clock, std::string latency) {
    return std::vector<EffectiveValue>{
        {"node.clock", "\"33 MHz\"", false, "default"},
        {"bus.clock", "\"" + clock + "\"", true, "a.toml:3"},
        {"bus.latency_cycles", latency, true, "--set bus.latency_cycles=" + latency},
        {"costs.add", "56", false, "default"}};
  };
  EXPECT_EQ(longest_duration(values("1 Hz", "7")), "bus.clock");
  EXPECT_EQ(longest_duration(values("100 MHz", "1000000000")), "bus.latency_cycles");
  EXPECT_EQ(longest_duration(values("10 GHz", "1")), "costs.add");
  EXPECT_EQ(longest_duration({}), "");
  const auto message = [&](std::string clock, std::string latency) {
    return test::user_error_of(
        [&] { with_places(values(clock, latency), "a.toml", [] { throw TimeOverflow("too long"); }); });
  };
  EXPECT_EQ(message("1 Hz", "7"), "a.toml:3: bus.clock: too long");
  EXPECT_EQ(message("100 MHz", "1000000000"), "--set bus.latency_cycles=1000000000: too long");
  EXPECT_EQ(message("10 GHz", "1"), "a.toml: costs.add: too long");
}

}  // namespace
}  // namespace marti::sim
