// Every .csv file that the program writes is one that gnuplot and pandas read as it stands: one header line
// of plain, different names, as many cells in each row, and nothing but numbers in a column that has a unit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tests/cli/shell.h"
#include "tests/support/csv_records.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;
using Row = CsvRecord;

std::vector<Row> records_of(const fs::path& file) {
  const std::optional<std::vector<Row>> records = read_csv(read(file));
  EXPECT_TRUE(records.has_value()) << file;
  return records.value_or(std::vector<Row>());
}

bool is_number(const std::string& cell) {
  char* end = nullptr;
  std::strtod(cell.c_str(), &end);
  return !cell.empty() && end == cell.c_str() + cell.size();
}

std::size_t column(const Row& header, const std::string& name) {
  return static_cast<std::size_t>(std::find(header.begin(), header.end(), name) - header.begin());
}

/// The columns of each table that hold quantities, from columns.csv.
std::map<std::string, std::set<std::string>> quantities(const fs::path& directory) {
  std::map<std::string, std::set<std::string>> found;
  const std::vector<Row> rows = records_of(directory / "columns.csv");
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (!rows[i].at(column(rows[0], "unit")).empty()) {
      found[rows[i].at(column(rows[0], "table_name"))].insert(rows[i].at(column(rows[0], "column_name")));
    }
  }
  return found;
}

/// Checks all files of a directory and returns how many they are.
int check(const fs::path& directory) {
  const auto units = fs::exists(directory / "columns.csv") ? quantities(directory)
                                                           : std::map<std::string, std::set<std::string>>();
  int files = 0;
  for (const auto& entry : fs::directory_iterator(directory)) {
    if (entry.path().extension() != ".csv") {
      continue;
    }
    ++files;
    const std::string name = entry.path().filename().string();
    const auto with_unit = units.find(entry.path().stem().string());
    const std::vector<Row> rows = records_of(entry.path());
    EXPECT_FALSE(rows.empty()) << name;
    const Row header = rows.empty() ? Row() : rows[0];
    EXPECT_EQ(std::set<std::string>(header.begin(), header.end()).size(), header.size()) << name;
    for (std::size_t k = 0; k < header.size(); ++k) {
      EXPECT_EQ(header[k].find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_."), std::string::npos)
          << name << ": " << header[k];
      for (std::size_t i = 1; i < rows.size(); ++i) {
        if (k == 0) {
          EXPECT_EQ(rows[i].size(), header.size()) << name << " row " << i;
        }
        if (with_unit != units.end() && with_unit->second.contains(header[k]) && k < rows[i].size()) {
          EXPECT_TRUE(rows[i][k].empty() || is_number(rows[i][k]))
              << name << ": " << header[k] << " " << rows[i][k];
        }
      }
    }
  }
  return files;
}

TEST(Tables, OfASweepAreForOtherPrograms) {
  const TemporaryDirectory directory;
  ASSERT_EQ(marti("sweep " + shipped("sweep-small.toml") + " -o " + quoted(directory.path())).status, 0);
  EXPECT_EQ(check(directory.path()), 1);
}

TEST(Tables, OfAStudyAreForOtherPrograms) {
  const TemporaryDirectory directory;
  ASSERT_EQ(
      marti("study operations --set scene.source=tetra:3 --set image.width=16 --set image.height=12 -o " +
            quoted(directory.path()))
          .status,
      0);
  EXPECT_GE(check(directory.path()), 3);
}

}  // namespace
}  // namespace marti::test
