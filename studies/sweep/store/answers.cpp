#include "studies/sweep/store/answers.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "sim/error.h"
#include "sim/mapped.h"
#include "studies/sweep/store/points_table.h"
#include "studies/sweep/store/store_columns.h"
#include "studies/tables/cell_number.h"
#include "studies/tables/json_table.h"
#include "studies/tables/query_sandbox.h"
#include "studies/tables/text_table.h"
#include "studies/tables/text_units.h"

namespace marti::studies::sweep {

namespace {

constexpr const char* table_name = "points";

// The columns of points.csv that are figures.
std::vector<std::string> columns_of_points(std::span<const std::string> axes) {
  std::vector<std::string> names;
  std::set<std::string> seen;
  for (const StoreColumn& column : store_columns(axes)) {
    if ((column.table == "summary" || column.table == "results") && column.name != "checksum" &&
        seen.insert(column.name).second) {
      names.push_back(column.name);
    }
  }
  return names;
}

// Calls `use` with each query of the question.
template <class Use>
void for_each_query(const Question& question, const Use& use) {
  use(question.answer);
  for (const QuestionTable& table : question.tables) {
    use(table.rows);
  }
  for (const QuestionClaim& claim : question.claims) {
    use(claim.here);
    use(claim.agrees);
  }
}

// A cell in a column of that type: of numbers and texts in one column all are texts.
tables::Cell as_column(const tables::Cell& cell, tables::ColumnType type) {
  return type == tables::ColumnType::text && tables::number_of(cell)
             ? tables::Cell(tables::short_text(cell, ""))
             : tables::as_type(cell, type);
}

tables::Table table_of(const QuestionTable& wanted, const tables::QuerySandbox::Rows& found) {
  std::vector<tables::Column> columns;
  std::set<std::string> seen;
  for (std::size_t i = 0; i < found.names.size(); ++i) {
    const std::string& name = found.names[i];
    if (!tables::is_plain_name(name, true) || !seen.insert(name).second) {
      throw sim::UserError(wanted.rows.place,
                           "each column needs a name of its own, of lower-case letters, digits, '_' and "
                           "'.': AS name (column " +
                               std::to_string(i + 1) + ")");
    }
    columns.push_back(point_column(name));
    columns.back().type = tables::common_type(
        found.rows.size(), [&](std::size_t row) -> const tables::Cell& { return found.rows[row][i]; });
    if (columns.back().type == tables::ColumnType::text) {
      columns.back().unit.clear();
    }
  }
  tables::Table table(wanted.name, wanted.title, columns);
  for (const std::vector<tables::Cell>& row : found.rows) {
    std::vector<tables::Cell> cells;
    for (std::size_t i = 0; i < row.size(); ++i) {
      cells.push_back(as_column(row[i], columns[i].type));
    }
    table.add_row(std::move(cells));
  }
  return table;
}

std::string text_of(const tables::Cell& cell) {
  const auto* const text = std::get_if<std::string>(&cell);
  return text != nullptr ? *text : tables::short_text(cell, "");
}

// The first column of the first row.
tables::Cell value_of(const tables::QuerySandbox::Rows& found) {
  return found.rows.empty() ? tables::Cell() : found.rows.front().front();
}

tables::Verdict verdict_of(const tables::Cell& agrees, const sim::Place& place) {
  if (std::holds_alternative<std::string>(agrees)) {
    throw sim::UserError(place, "must give 1, 0 or nothing, not a text");
  }
  const std::optional<double> number = tables::number_of(agrees);
  return number ? tables::verdict_of(*number != 0.0) : tables::Verdict::not_measured;
}

// All answers from points that are in the sandbox.
Answers answers_from(const Question& question, tables::QuerySandbox& points) {
  Answers answers;
  answers.asks = question.asks;
  const auto run = [&](const Query& query) { return points.run(query.sql, query.place); };
  for (const std::vector<tables::Cell>& row : run(question.answer).rows) {
    if (const std::string sentence = text_of(row.front()); !sentence.empty()) {
      answers.answer.push_back(sentence);
    }
  }
  for (const QuestionTable& table : question.tables) {
    answers.tables.push_back(table_of(table, run(table.rows)));
  }
  for (const QuestionClaim& claim : question.claims) {
    answers.claims.push_back({claim.subject, claim.says, text_of(value_of(run(claim.here))),
                              verdict_of(value_of(run(claim.agrees)), claim.agrees.place)});
  }
  return answers;
}

}  // namespace

void check_question(const Question& question, std::span<const std::string> axes) {
  if (question.asks.empty()) {
    return;
  }
  tables::QuerySandbox points(table_name, columns_of_points(axes));
  (void)answers_from(question, points);
}

Answers answers_of(const SweepReader& reader) {
  const Question question = reader.question();
  if (question.asks.empty()) {
    return {};
  }
  std::set<std::string> read;
  tables::QuerySandbox empty(table_name, reader.figures());
  for_each_query(question, [&](const Query& query) { (void)empty.run(query.sql, query.place, &read); });
  // A query that only counts rows reads no column; a table needs one.
  std::vector<std::string> columns = {"ordinal"};
  std::ranges::copy_if(reader.figures(), std::back_inserter(columns),
                       [&](const std::string& name) { return name != "ordinal" && read.contains(name); });
  tables::QuerySandbox points(table_name, columns);
  reader.for_each_point(columns, [&](const StoredPoint& point, std::span<const tables::Cell> cells) {
    if (point.done) {
      points.add_row(cells);
    }
  });
  return answers_from(question, points);
}

nlohmann::ordered_json answers_json(const Answers& answers) {
  if (answers.asks.empty()) {
    return nullptr;
  }
  return {{"asks", answers.asks},
          {"answer", answers.answer},
          {"tables", sim::mapped(answers.tables, tables::table_json)},
          {"claims", tables::rows_json(tables::claim_table(answers.claims))}};
}

std::string answer_text(const Answers& answers) {
  if (answers.asks.empty()) {
    return {};
  }
  std::string text = "question      " + answers.asks + "\n";
  std::string name = "answer        ";
  for (const std::string& sentence : answers.answer) {
    text += name + sentence + "\n";
    name = "              ";
  }
  return text + (answers.answer.empty() ? name + "-\n" : "");
}

std::string tables_text(const Answers& answers) {
  std::string text;
  for (const tables::Table& table : answers.tables) {
    text += "\n" + tables::text_of(table);
  }
  return text + (answers.claims.empty() ? "" : "\n" + tables::text_of(answers.claims));
}

}  // namespace marti::studies::sweep
