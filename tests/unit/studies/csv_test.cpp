// CSV, read back by a reader that was written from the RFC alone.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "studies/tables/csv.h"

namespace marti::tests {
namespace {

using studies::tables::Cell;
using studies::tables::ColumnType;
using studies::tables::Table;

struct Field {
  std::string text;
  bool quoted = false;
};

// RFC 4180, section 2: records end in CR LF; a quoted field may hold anything, with quotes doubled.
std::optional<std::vector<std::vector<Field>>> parse(const std::string& csv) {
  std::vector<std::vector<Field>> records;
  std::size_t at = 0;
  while (at < csv.size()) {
    std::vector<Field>& record = records.emplace_back();
    for (;;) {
      Field& field = record.emplace_back();
      if (at < csv.size() && csv[at] == '"') {
        field.quoted = true;
        for (++at;; ++at) {
          if (at >= csv.size()) {
            return std::nullopt;
          }
          if (csv[at] == '"') {
            if (at + 1 < csv.size() && csv[at + 1] == '"') {
              ++at;
            } else {
              ++at;
              break;
            }
          }
          field.text += csv[at];
        }
      } else {
        while (at < csv.size() && csv[at] != ',' && csv[at] != '\r') {
          if (csv[at] == '"' || csv[at] == '\n') {
            return std::nullopt;
          }
          field.text += csv[at++];
        }
      }
      if (at < csv.size() && csv[at] == ',') {
        ++at;
        continue;
      }
      if (csv.compare(at, 2, "\r\n") != 0) {
        return std::nullopt;
      }
      at += 2;
      break;
    }
  }
  return records;
}

Table make_table() {
  return {"t",
          "title",
          {{"i", ColumnType::integer, "1", ""},
           {"r", ColumnType::real, "", ""},
           {"s", ColumnType::text, "", ""}}};
}

TEST(Csv, HostileTextComesBack) {
  const std::vector<std::string> texts = {
      "",   "plain",  "with, comma",        "with \"quotes\"",      "\"",      "line\nbreak", "line\r\nbreak",
      "\r", " edge ", "gr\xc3\xbc\xc3\x9f", std::string("a\0b", 3), "\xff\xfe"};
  Table table = make_table();
  for (const std::string& text : texts) {
    table.add_row({std::int64_t{1}, 0.5, text});
  }
  const auto records = parse(studies::tables::csv_of(table));
  ASSERT_TRUE(records.has_value());
  ASSERT_EQ(records->size(), texts.size() + 1);
  EXPECT_EQ((*records)[0][2].text, "s");
  for (std::size_t i = 0; i < texts.size(); ++i) {
    ASSERT_EQ((*records)[i + 1].size(), 3U);
    EXPECT_EQ((*records)[i + 1][2].text, texts[i]);
  }
}

TEST(Csv, ACellWithoutValueDiffersFromAnEmptyText) {
  Table table = make_table();
  table.add_row({Cell(), Cell(), Cell()});
  table.add_row({Cell(), Cell(), std::string()});
  EXPECT_EQ(studies::tables::csv_of(table), "i,r,s\r\n,,\r\n,,\"\"\r\n");
}

TEST(Csv, NumbersComeBackExactly) {
  const std::vector<double> reals = {0.0,
                                     -0.0,
                                     0.1,
                                     1.0 / 3.0,
                                     1e300,
                                     std::numeric_limits<double>::denorm_min(),
                                     std::numeric_limits<double>::max(),
                                     std::numeric_limits<double>::infinity(),
                                     -std::numeric_limits<double>::infinity()};
  Table table = make_table();
  for (const double real : reals) {
    table.add_row({std::numeric_limits<std::int64_t>::min(), real, "x"});
  }
  table.add_row({std::numeric_limits<std::int64_t>::max(), std::numeric_limits<double>::quiet_NaN(), "x"});
  const auto records = parse(studies::tables::csv_of(table));
  ASSERT_TRUE(records.has_value());
  for (std::size_t i = 0; i < reals.size(); ++i) {
    EXPECT_EQ(std::stoll((*records)[i + 1][0].text), std::numeric_limits<std::int64_t>::min());
    const double back = std::strtod((*records)[i + 1][1].text.c_str(), nullptr);
    EXPECT_EQ(back, reals[i]);
    EXPECT_EQ(std::signbit(back), std::signbit(reals[i]));
  }
  EXPECT_EQ(records->back()[0].text, "9223372036854775807");
  EXPECT_EQ(records->back()[1].text, "nan");
}

RC_GTEST_PROP(Csv, AnyTextComesBack, (const std::vector<std::string>& texts)) {
  Table table("t", "", {{"a", ColumnType::text, "", ""}, {"b", ColumnType::text, "", ""}});
  for (const std::string& text : texts) {
    table.add_row({text, text + text});
  }
  const auto records = parse(studies::tables::csv_of(table));
  RC_ASSERT(records.has_value());
  RC_ASSERT(records->size() == texts.size() + 1);
  for (std::size_t i = 0; i < texts.size(); ++i) {
    RC_ASSERT((*records)[i + 1].at(0).text == texts[i]);
    RC_ASSERT((*records)[i + 1].at(1).text == texts[i] + texts[i]);
  }
}

}  // namespace
}  // namespace marti::tests
