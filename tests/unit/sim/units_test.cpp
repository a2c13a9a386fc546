#include "sim/units.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "tests/support/user_error.h"

namespace marti::sim {
namespace {

using test::user_error_of;

TEST(Units, SizesAreExact) {
  EXPECT_EQ(parse_size("0"), 0);
  EXPECT_EQ(parse_size("64"), 64);
  EXPECT_EQ(parse_size("64 B"), 64);
  EXPECT_EQ(parse_size("16 KiB"), 16 * 1024);
  EXPECT_EQ(parse_size("16KiB"), 16 * 1024);
  EXPECT_EQ(parse_size("  1.5\tMiB "), 3 * 512 * 1024);
  EXPECT_EQ(parse_size("0.0009765625 KiB"), 1);
  EXPECT_EQ(parse_size("1.000000000000000000000000000000000000000000000000 B"), 1);
  EXPECT_EQ(parse_size("9223372036854775807"), std::numeric_limits<std::int64_t>::max());
}

TEST(Units, SizesThatAreNoneAreRefused) {
  EXPECT_EQ(user_error_of([] { (void)parse_size("0.5 B"); }), "\"0.5 B\": is not a whole number of bytes");
  EXPECT_EQ(user_error_of([] { (void)parse_size("0.0001 KiB"); }),
            "\"0.0001 KiB\": is not a whole number of bytes");
  EXPECT_NE(user_error_of([] { (void)parse_size("16 KB"); }).find("ambiguous"), std::string::npos);
  EXPECT_NE(user_error_of([] { (void)parse_size("9223372036854775808"); }).find("too large"),
            std::string::npos);
  EXPECT_NE(user_error_of([] { (void)parse_size("8388608 TiB"); }).find("too large"), std::string::npos);
  for (const char* text : {"", " ", "KiB", "-1 B", "+1 B", "1. B", ".5 KiB", "1e3 B", "0x10", "1 kib",
                           "1 B B", "1,5 KiB", "1 KiB 2 B", "16 Hz", "inf", "nan", "1..5 KiB"}) {
    EXPECT_THROW((void)parse_size(text), UserError) << text;
  }
  EXPECT_THROW((void)parse_size(std::string(100'000, '9')), UserError);
  EXPECT_THROW((void)parse_size("0." + std::string(100'000, '1') + " KiB"), UserError);
  EXPECT_THROW((void)parse_size(std::string_view("1\0 KiB", 6)), UserError);
}

TEST(Units, DurationsAreTicks) {
  EXPECT_EQ(parse_duration("10 ns"), 10'000);
  EXPECT_EQ(parse_duration("0.5 ns"), 500);
  EXPECT_EQ(parse_duration("1 ps"), 1);
  EXPECT_EQ(parse_duration("3 us"), 3'000'000);
  EXPECT_EQ(parse_duration("2 ms"), 2'000'000'000);
  EXPECT_EQ(parse_duration("1.25 s"), 1'250'000'000'000);
  EXPECT_THROW((void)parse_duration("0.0001 ns"), UserError);
  EXPECT_THROW((void)parse_duration("10"), UserError);
  EXPECT_THROW((void)parse_duration("10 Ns"), UserError);
  EXPECT_THROW((void)parse_duration("9223373 s"), UserError);
}

TEST(Units, FrequenciesAreTheNearestDouble) {
  EXPECT_EQ(parse_frequency("33 MHz"), 33e6);
  EXPECT_EQ(parse_frequency("33.3333 MHz"), 33.3333e6);
  EXPECT_EQ(parse_frequency("1 GHz"), 1e9);
  EXPECT_EQ(parse_frequency("0.1 kHz"), 100.0);
  EXPECT_THROW((void)parse_frequency("33"), UserError);
  EXPECT_THROW((void)parse_frequency("33 mhz"), UserError);
  EXPECT_THROW((void)parse_frequency(std::string(400, '9') + " Hz"), UserError);
}

TEST(Units, PercentagesAreFractions) {
  EXPECT_EQ(parse_percentage("42 %"), 0.42);
  EXPECT_EQ(parse_percentage("0.1%"), 0.001);
  EXPECT_EQ(parse_percentage("250 %"), 2.5);
  EXPECT_THROW((void)parse_percentage("0.42"), UserError);
}

TEST(Units, PrintsTheLargestExactUnit) {
  EXPECT_EQ(print_size(0), "0 B");
  EXPECT_EQ(print_size(16 * 1024), "16 KiB");
  EXPECT_EQ(print_size(1537), "1537 B");
  EXPECT_EQ(print_size(3 * 512 * 1024), "1536 KiB");
  EXPECT_EQ(print_duration(10'000), "10 ns");
  EXPECT_EQ(print_duration(10'001), "10001 ps");
  EXPECT_EQ(print_frequency(33e6), "33 MHz");
  EXPECT_EQ(print_frequency(33.3333e6), "33.3333 MHz");
  EXPECT_EQ(print_frequency(0.5), "0.5 Hz");
  EXPECT_EQ(print_frequency(0), "0 Hz");
  EXPECT_EQ(print_percentage(0.42), "42 %");
  EXPECT_EQ(print_percentage(0.0), "0 %");
  EXPECT_EQ(print_percentage(0.001), "0.1 %");
  EXPECT_EQ(print_percentage(12.0), "1200 %");
  EXPECT_EQ(print_real(3.0), "3.0");
  EXPECT_EQ(print_real(-0.1), "-0.1");
  EXPECT_EQ(print_real(1e300), "1e+300");
}

RC_GTEST_PROP(Units, IntegersReadBackAsPrinted, (std::int64_t any)) {
  const std::int64_t value = any & std::numeric_limits<std::int64_t>::max();
  const std::int64_t round = (value >> 30) << 20;  // reaches the larger units
  for (const std::int64_t number : {value, round}) {
    RC_ASSERT(parse_size(print_size(number)) == number);
    RC_ASSERT(parse_duration(print_duration(number)) == number);
    RC_ASSERT(parse_duration(print_duration(number / 1'000'000 * 1'000'000)) ==
              number / 1'000'000 * 1'000'000);
  }
}

RC_GTEST_PROP(Units, RealsReadBackAsPrinted, (std::uint64_t bits)) {
  double value = 0;
  std::memcpy(&value, &bits, sizeof value);
  RC_PRE(std::isfinite(value));
  RC_ASSERT(std::strtod(print_real(value).c_str(), nullptr) == value);
  const double magnitude = std::abs(value);
  RC_ASSERT(parse_frequency(print_frequency(magnitude)) == magnitude);
  RC_ASSERT(parse_percentage(print_percentage(magnitude)) == magnitude);
}

}  // namespace
}  // namespace marti::sim
