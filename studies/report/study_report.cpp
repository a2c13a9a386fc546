// The report of a study's directory.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "sim/error.h"
#include "sim/files.h"
#include "studies/report/report_files.h"
#include "studies/report/report_kinds.h"
#include "studies/tables/cell_number.h"
#include "studies/tables/sqlite_connection.h"

namespace marti::studies {

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

Descriptions descriptions_of(SqliteConnection& connection) {
  Descriptions found;
  SqliteStatement rows(connection, "SELECT table_name, column_name, unit, description FROM columns");
  while (rows.next()) {
    found[{rows.text(0), rows.text(1)}] = {rows.text(2), rows.text(3)};
  }
  return found;
}

std::vector<std::string> tables_of(SqliteConnection& connection) {
  std::vector<std::string> names;
  SqliteStatement rows(
      connection, "SELECT name FROM sqlite_schema WHERE type = 'table' AND name <> 'columns' ORDER BY rowid");
  while (rows.next()) {
    names.push_back(rows.text(0));
  }
  return names;
}

ColumnType type_of(const std::string& declared) {
  return declared == "INTEGER" ? ColumnType::integer
         : declared == "REAL"  ? ColumnType::real
                               : ColumnType::text;
}

bool is_plain(const std::string& name) {
  return !name.empty() &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos;
}

Table read_table(SqliteConnection& connection, const fs::path& file, const std::string& name,
                 const Descriptions& descriptions, std::size_t& rows_left) {
  std::vector<Column> columns;
  std::set<std::string> seen;
  SqliteStatement info(connection, "SELECT name, type FROM pragma_table_info(?)");
  info.with({name});
  while (info.next()) {
    Column column{info.text(0), type_of(info.text(1)), "", ""};
    if (!is_plain(column.name) || !seen.insert(column.name).second) {
      throw sim::UserError(file.string() + ": table " + name + ": its columns are not those of a study" +
                           std::string(remedy));
    }
    if (const auto at = descriptions.find({name, column.name}); at != descriptions.end()) {
      column.unit = at->second.unit;
      column.description = at->second.description;
    }
    columns.push_back(column);
  }
  if (columns.empty() || !is_plain(name)) {
    throw sim::UserError(file.string() + ": table " + name + " is not one of a study" + std::string(remedy));
  }
  Table table(name, name, columns);
  SqliteStatement rows(connection, "SELECT * FROM " + sql_name(name));
  while (rows.next()) {
    if (rows_left == 0) {
      throw sim::UserError(
          fmt::format("{}: has more than {} rows, too many for one page; read the tables with "
                      "sqlite3 or from the .csv files",
                      file.string(), most_rows));
    }
    --rows_left;
    std::vector<Cell> cells;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      cells.push_back(as_type(rows.cell(static_cast<int>(i)), columns[i].type));
    }
    table.add_row(std::move(cells));
  }
  return table;
}

// "setting", "value" and "given", as studies/tables/provenance.h makes it.
void take_settings(const Table& table, ReportData& report) {
  for (const std::vector<Cell>& row : table.rows()) {
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

// Takes the report's first paragraph as the title, if it is short.
void take_text(const fs::path& file, ReportData& report) {
  report.text = sim::read_file(file, largest_text);
  const std::size_t end = report.text.find("\n\n");
  std::string first = report.text.substr(0, end);
  std::replace(first.begin(), first.end(), '\n', ' ');
  constexpr std::size_t longest = 300;
  if (!first.empty() && first.size() <= longest) {
    report.title = first;
  }
}

// What a study has found, claim by claim (studies/tables/claim.h): its answer.
void take_claims(const Table& table, ReportData& report) {
  constexpr std::size_t most = 12;
  const auto index_of = [&](std::string_view name) {
    const auto columns = table.columns();
    const auto at = std::find_if(columns.begin(), columns.end(),
                                 [&](const Column& column) { return column.name == name; });
    return at == columns.end() || at->type != ColumnType::text
               ? std::nullopt
               : std::optional(static_cast<std::size_t>(at - columns.begin()));
  };
  const auto subject = index_of("subject");
  const auto here = index_of("here");
  const auto verdict = index_of("verdict");
  if (!subject || !here || !verdict) {
    return;
  }
  for (const std::vector<Cell>& row : table.rows()) {
    const auto text = [&](std::size_t i) {
      const auto* found = std::get_if<std::string>(&row[i]);
      return found == nullptr ? std::string("?") : *found;
    };
    if (report.answer.size() < most) {
      report.answer.push_back(fmt::format("{}: {} ({}).", text(*subject), text(*here), text(*verdict)));
    }
  }
}

}  // namespace

ReportData read_study_report(const fs::path& directory) {
  const fs::path file = directory / "results.sqlite";
  ReportData report;
  report.kind = "study";
  report.title = "Study";
  SqliteConnection connection(file, SqliteConnection::Access::read);
  const Descriptions descriptions = descriptions_of(connection);
  std::size_t rows_left = most_rows;
  for (const std::string& name : tables_of(connection)) {
    Table table = read_table(connection, file, name, descriptions, rows_left);
    if (name == "provenance") {
      take_settings(table, report);
      continue;
    }
    take_claims(table, report);
    report.tables.push_back({std::move(table), true});
  }
  if (is_there(directory / "report.txt")) {
    take_text(directory / "report.txt", report);
  }
  std::map<std::string, fs::path> files;  // of the charts, by name
  for (const fs::path& chart : files_ending_in(directory, ".vl.json")) {
    report.charts.push_back(read_chart(chart));
    const auto [other, is_new] = files.emplace(report.charts.back().name, chart);
    if (!is_new) {
      throw sim::UserError(fmt::format("{} and {}: both would be the chart {}; rename or remove one of them",
                                       other->second.string(), chart.string(), other->first));
    }
  }
  for (const fs::path& image : files_ending_in(directory, ".png")) {
    take_image(image, image.stem().string(), report);
  }
  report.answer.push_back(fmt::format("{} tables and {} charts below; the study's own report follows them.",
                                      report.tables.size(), report.charts.size()));
  return report;
}

}  // namespace marti::studies
