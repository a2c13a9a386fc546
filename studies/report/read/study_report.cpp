// The report of a study's directory.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <span>
#include <string_view>

#include "sim/error.h"
#include "sim/files.h"
#include "studies/report/model/chart_library.h"
#include "studies/report/model/verdicts.h"
#include "studies/report/read/read_report.h"
#include "studies/report/read/report_files.h"
#include "studies/tables/cell_number.h"
#include "studies/tables/json_table.h"
#include "studies/tables/result_directory.h"
#include "studies/tables/sqlite_connection.h"
#include "studies/tables/text_units.h"

namespace marti::studies::report {

namespace {

namespace fs = std::filesystem;

constexpr std::int64_t largest_text = std::int64_t{4} << 20U;
constexpr std::size_t most_rows = 20'000;  // of all tables together: people read no more
constexpr std::string_view remedy = "; run the study again into an empty directory";

struct Described {
  std::string unit;
  std::string description;
};

// Unit and meaning by table and column.
using Descriptions = std::map<std::pair<std::string, std::string>, Described>;

Descriptions descriptions_of(tables::SqliteConnection& connection) {
  Descriptions found;
  tables::SqliteStatement rows(connection, "SELECT table_name, column_name, unit, description FROM columns");
  while (rows.next()) {
    found[{rows.text(0), rows.text(1)}] = {rows.text(2), rows.text(3)};
  }
  return found;
}

std::vector<std::string> tables_of(tables::SqliteConnection& connection) {
  std::vector<std::string> names;
  tables::SqliteStatement rows(
      connection, "SELECT name FROM sqlite_schema WHERE type = 'table' AND name <> 'columns' ORDER BY rowid");
  while (rows.next()) {
    names.push_back(rows.text(0));
  }
  return names;
}

tables::ColumnType type_of(const std::string& declared) {
  return declared == "INTEGER" ? tables::ColumnType::integer
         : declared == "REAL"  ? tables::ColumnType::real
                               : tables::ColumnType::text;
}

tables::Table read_table(tables::SqliteConnection& connection, const fs::path& file, const std::string& name,
                         const Descriptions& descriptions, std::size_t& rows_left) {
  std::vector<tables::Column> columns;
  std::set<std::string> seen;
  tables::SqliteStatement info(connection, "SELECT name, type FROM pragma_table_info(?)");
  info.with({name});
  while (info.next()) {
    tables::Column column{info.text(0), type_of(info.text(1)), "", ""};
    if (!tables::is_plain_name(column.name, true) || !seen.insert(column.name).second) {
      throw sim::UserError(file.string() + ": table " + name + ": its columns are not those of a study" +
                           std::string(remedy));
    }
    if (const auto at = descriptions.find({name, column.name}); at != descriptions.end()) {
      column.unit = at->second.unit;
      column.description = at->second.description;
    }
    columns.push_back(column);
  }
  if (columns.empty() || !tables::is_plain_name(name)) {
    throw sim::UserError(file.string() + ": table " + name + " is not one of a study" + std::string(remedy));
  }
  tables::Table table(name, name, columns);
  tables::SqliteStatement rows(connection, "SELECT * FROM " + tables::sql_name(name));
  while (rows.next()) {
    if (rows_left == 0) {
      throw sim::UserError(
          fmt::format("{}: has more than {} rows, too many for one page; read the tables with "
                      "sqlite3 or from the .csv files",
                      file.string(), most_rows));
    }
    --rows_left;
    std::vector<tables::Cell> cells;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      cells.push_back(tables::as_type(rows.cell(static_cast<int>(i)), columns[i].type));
    }
    table.add_row(std::move(cells));
  }
  return table;
}

// "setting", "value" and "given", as studies/tables/provenance.h makes it.
void take_settings(const tables::Table& table, ReportData& report) {
  for (const std::vector<tables::Cell>& row : table.rows()) {
    const auto text = [&](std::size_t i) {
      const auto* found = i < row.size() ? std::get_if<std::string>(&row[i]) : nullptr;
      return found == nullptr ? std::string() : *found;
    };
    if (text(0) == "version") {
      report.provenance.emplace_back("version of marti", text(1));
    } else {
      report.configuration += text(0) + " = " + text(1) + "\n";
    }
  }
}

// Takes the first line of the report as the title and the other lines of its first paragraph as what it is
// about, if they are short.
void take_text(const fs::path& file, ReportData& report) {
  report.text = sim::read_file(file, largest_text);
  std::string first = report.text.substr(0, report.text.find("\n\n"));
  if (first.ends_with('\n')) {
    first.pop_back();
  }
  constexpr std::size_t longest = 400;
  if (first.empty() || first.size() > longest) {
    return;
  }
  const std::size_t end = first.find('\n');
  report.title = first.substr(0, end);
  if (end == std::string::npos) {
    return;
  }
  // Columns of the text become one space each, lines become parts of a sentence.
  for (const char c : first.substr(end + 1)) {
    if (c == '\n') {
      report.about += "; ";
    } else if (c != ' ' || (!report.about.empty() && report.about.back() != ' ')) {
      report.about += c;
    }
  }
}

bool has_columns(const tables::Table& table, std::span<const std::string_view> names) {
  return std::ranges::all_of(names, [&](std::string_view name) {
    const auto columns = table.columns();
    return std::ranges::any_of(columns, [&](const tables::Column& column) { return column.name == name; });
  });
}

}  // namespace

ReportData read_study_report(const fs::path& directory) {
  const fs::path file = directory / tables::database_name;
  ReportData report;
  report.kind = "study";
  report.title = "Study";
  tables::SqliteConnection connection(file, tables::SqliteConnection::Access::read);
  const Descriptions descriptions = descriptions_of(connection);
  std::size_t rows_left = most_rows;
  std::vector<tables::Table> tables;
  for (const std::string& name : tables_of(connection)) {
    tables::Table table = read_table(connection, file, name, descriptions, rows_left);
    if (name == "provenance") {
      take_settings(table, report);
      continue;
    }
    if (name.ends_with("_answer") && has_columns(table, std::array<std::string_view, 1>{"answer"})) {
      for (std::size_t row = 0; row < table.rows().size(); ++row) {
        if (const auto* answer = std::get_if<std::string>(&table.at(row, "answer"))) {
          report.answer.push_back(*answer);
        }
      }
      continue;
    }
    constexpr std::array<std::string_view, 3> of_claims = {"subject", "here", "verdict"};
    constexpr std::array<std::string_view, 3> of_cases = {"case", "figure", "verdict"};
    if ((name == "claims" && has_columns(table, of_claims)) ||
        (name == "stability" && has_columns(table, of_cases))) {
      const std::vector<std::string> found = verdict_sentences(table);
      report.answer.insert(report.answer.end(), found.begin(), found.end());
    }
    tables.push_back(std::move(table));
  }
  if (tables::is_there(directory / "report.txt")) {
    take_text(directory / "report.txt", report);
  }
  for (const auto& [chart, table] : tables::charts_of(tables)) {
    report.charts.push_back(chart_of_results(*chart, tables::rows_json(*table)));
  }
  for (tables::Table& table : tables) {
    report.tables.push_back({std::move(table), true});
  }
  for (const fs::path& image : files_ending_in(directory, ".png")) {
    take_image(image, image.stem().string(), report);
  }
  report.answer.push_back(fmt::format("{} and {} below; the study's own report follows them.",
                                      tables::counted(report.tables.size(), "table"),
                                      tables::counted(report.charts.size(), "chart")));
  return report;
}

}  // namespace marti::studies::report
