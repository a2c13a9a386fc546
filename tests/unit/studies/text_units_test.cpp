// Numbers as people read them.
#include "studies/tables/text_units.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

namespace marti::studies {

using namespace tables;

namespace {

TEST(TextUnits, TimesHaveThreeDecimalsInTheLargestUnit) {
  EXPECT_EQ(seconds(0), "0 s");
  EXPECT_EQ(seconds(1), "1 ps");
  EXPECT_EQ(seconds(999), "999 ps");
  EXPECT_EQ(seconds(1000), "0.001 us");
  EXPECT_EQ(seconds(999'999'499), "999.999 us");
  EXPECT_EQ(seconds(999'999'999), "1.000 ms") << "and not 1000.000 us";
  EXPECT_EQ(seconds(1'000'000'000), "1.000 ms");
  EXPECT_EQ(seconds(40'858'349'694), "40.858 ms");
  EXPECT_EQ(seconds(1'500'000'000'000), "1.500 s");
  EXPECT_EQ(signed_seconds(0), "0 s");
  EXPECT_EQ(signed_seconds(-331), "-331 ps");
  EXPECT_EQ(signed_seconds(28'202'000'000), "+28.202 ms");
}

TEST(TextUnits, ComputedTimesKeepWithin64Bits) {
  EXPECT_EQ(computed_seconds(1e6), "1.000 us");
  EXPECT_EQ(computed_seconds(1.5), "2 ps");
  EXPECT_EQ(computed_seconds(-1.0), "0 s");
  EXPECT_EQ(computed_seconds(1e308), computed_seconds(0x1p63));
}

TEST(TextUnits, SharesAndChangesArePercentages) {
  EXPECT_EQ(percent(0.249), "24.90 %");
  EXPECT_EQ(rough_percent(0.0993), "9.9 %");
  EXPECT_EQ(rough_percent(-0.0003), "0.0 %");
  EXPECT_EQ(rough_percent(-0.0007), "-0.1 %");
  EXPECT_EQ(change_percent(0.6902), "+69.02 %");
  EXPECT_EQ(change_percent(-1.0), "-100.00 %");
  EXPECT_EQ(change_percent(0.0), "+0.00 %");
  EXPECT_EQ(change_percent(1e-6), "+1.0e-04 %");
  EXPECT_EQ(change_percent(8.99), "+899.00 %");
  EXPECT_EQ(change_percent(9.99999), "11.00 times");
  EXPECT_EQ(change_percent(39366.79), "39,368 times");
  EXPECT_EQ(times(1.0 / 3.0), "0.33");
}

TEST(TextUnits, NumbersOfThingsHaveTheirPlural) {
  EXPECT_EQ(counted(0, "node"), "0 nodes");
  EXPECT_EQ(counted(1, "node"), "1 node");
  EXPECT_EQ(counted(1024, "object reference"), "1,024 object references");
}

TEST(TextUnits, FiguresHaveTheirUnit) {
  EXPECT_EQ(figure_text(std::int64_t{40'858'349'694}, "ps", "-"), "40.858 ms");
  EXPECT_EQ(figure_text(331.99, "ps", "-"), "332 ps");
  EXPECT_EQ(figure_text(-2e9, "ps", "-"), "-2.000 ms");
  EXPECT_EQ(figure_text(std::int64_t{16384}, "byte", "-"), "16.0 KiB");
  EXPECT_EQ(figure_text(std::int64_t{1234567}, "1", "-"), "1,234,567");
  EXPECT_EQ(figure_text(0.936275, "1", "-"), "0.9363");
  EXPECT_EQ(figure_text(0.936275, "fraction", "-"), "93.63 %");
  EXPECT_EQ(figure_text(0.000123456, "fraction", "-"), "0.012 %");
  EXPECT_EQ(figure_text(0.0, "fraction", "-"), "0.00 %");
  EXPECT_EQ(figure_text(std::int64_t{2'000'000}, "fJ", "-"), "2.000 nJ");
  EXPECT_EQ(figure_text(1.5, "mJ", "-"), "1.500 mJ");
  EXPECT_EQ(figure_text(2.5, "W", "-"), "2.5 W");
  EXPECT_EQ(figure_text(Cell(), "ps", "-"), "-");
  EXPECT_EQ(figure_text(std::string("text"), "ps", "-"), "text");
  EXPECT_EQ(figure_text(std::numeric_limits<double>::infinity(), "ps", "none"), "none");
  EXPECT_EQ(figure_text(std::numeric_limits<std::int64_t>::min(), "ps", "-"), "-9.223e+06 s");
}

}  // namespace
}  // namespace marti::studies
