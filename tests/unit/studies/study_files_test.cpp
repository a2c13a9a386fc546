// The files of a study: all of them, or the old ones.
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>

#include "sim/error.h"
#include "studies/tables/study_files.h"
#include "tests/support/files.h"
#include "tests/support/temporary_directory.h"

namespace marti::tests {
namespace {

namespace fs = std::filesystem;
using studies::tables::ColumnType;
using studies::tables::StudyOutput;
using studies::tables::Table;
using test::names_in;
using test::read;
using test::TemporaryDirectory;

StudyOutput make_output(std::int64_t value) {
  StudyOutput output;
  output.report = "report " + std::to_string(value) + "\n";
  Table table("numbers", "", {{"n", ColumnType::integer, "1", "a number"}});
  table.add_row({value});
  output.tables.push_back(table);
  return output;
}

TEST(StudyFiles, AreWhatTheHeaderSays) {
  const TemporaryDirectory directory;
  StudyOutput output = make_output(7);
  EXPECT_EQ(studies::tables::write_study(output, directory.path()).size(), 5U);
  const std::set<std::string> plain = {"numbers.csv", "columns.csv", "report.txt", "results.sqlite",
                                       "files.json"};
  EXPECT_EQ(names_in(directory.path()), plain);
  EXPECT_EQ(read(directory.path() / "numbers.csv"), "n\r\n7\r\n");
  output.host_report = "seconds\n";
  output.host_tables.emplace_back(
      "host_numbers", "", std::vector<studies::tables::Column>{{"s", ColumnType::real, "s", "seconds"}});
  studies::tables::write_study(output, directory.path());
  EXPECT_EQ(names_in(directory.path()),
            (std::set<std::string>{"numbers.csv", "host_numbers.csv", "columns.csv", "report.txt", "host.txt",
                                   "results.sqlite", "files.json"}));
  // Nothing of an earlier study stays beside a later one, but what is the user's does.
  test::write(directory.path() / "host.txt", "mine");
  studies::tables::write_study(make_output(8), directory.path());
  std::set<std::string> and_mine = plain;
  and_mine.insert("host.txt");
  EXPECT_EQ(names_in(directory.path()), and_mine);
}

TEST(StudyFiles, AFailureLeavesTheOldOnes) {
  const TemporaryDirectory directory;
  studies::tables::write_study(make_output(1), directory.path());
  const auto names = names_in(directory.path());
  const std::string database = read(directory.path() / "results.sqlite");
  // Two tables of one name cannot both be written.
  StudyOutput twice = make_output(2);
  twice.tables.push_back(twice.tables[0]);
  EXPECT_THROW(studies::tables::write_study(twice, directory.path()), sim::UserError);
  EXPECT_EQ(names_in(directory.path()), names);
  EXPECT_EQ(read(directory.path() / "numbers.csv"), "n\r\n1\r\n");
  EXPECT_EQ(read(directory.path() / "report.txt"), "report 1\n");
  EXPECT_EQ(read(directory.path() / "results.sqlite"), database);
  EXPECT_THROW(studies::tables::write_study(make_output(3), directory.path() / "missing"), sim::UserError);
}

}  // namespace
}  // namespace marti::tests
