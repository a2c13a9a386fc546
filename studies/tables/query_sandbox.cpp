#include "studies/tables/query_sandbox.h"

#include <SQLiteCpp/Column.h>
#include <SQLiteCpp/Statement.h>
#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <variant>

#include "sim/error.h"
#include "sim/shown.h"
#include "sim/units.h"
#include "studies/tables/sqlite_connection.h"
#include "studies/tables/text_units.h"

namespace marti::studies::tables {

namespace {

constexpr int steps_at_a_time = 100'000;
constexpr int most_times = 2'000;  // so many steps
constexpr std::size_t most_rows = 10'000;
constexpr std::size_t most_text = 10'000'000;  // of the rows' texts
constexpr std::int64_t most_memory = 256'000'000;
constexpr int longest_value = 100'000;
constexpr int longest_query_pattern = 200;
constexpr int deepest_query = 200;

// Functions of SQLite that depend on chance, on the time, on the version of SQLite or on other statements,
// reach beyond the table, or take memory at will.
constexpr std::array<std::string_view, 26> refused_functions = {"changes",
                                                                "current_date",
                                                                "current_time",
                                                                "current_timestamp",
                                                                "date",
                                                                "datetime",
                                                                "fts3_tokenizer",
                                                                "fts5_source_id",
                                                                "julianday",
                                                                "last_insert_rowid",
                                                                "load_extension",
                                                                "random",
                                                                "randomblob",
                                                                "readfile",
                                                                "rtreecheck",
                                                                "sqlite_compileoption_get",
                                                                "sqlite_compileoption_used",
                                                                "sqlite_log",
                                                                "sqlite_source_id",
                                                                "sqlite_version",
                                                                "strftime",
                                                                "time",
                                                                "timediff",
                                                                "total_changes",
                                                                "unixepoch",
                                                                "zeroblob"};
static_assert(std::ranges::is_sorted(refused_functions));

// What an authorizer and a progress handler know of the query that runs.
struct Watched {
  std::string_view table;
  std::set<std::string>* reads = nullptr;
  int times = 0;
  bool too_long = false;
};

int authorize(void* user, int action, const char* first, const char* second, const char* /*database*/,
              const char* /*trigger*/) {
  auto& watched = *static_cast<Watched*>(user);
  switch (action) {
    case SQLITE_SELECT:
      return SQLITE_OK;
    case SQLITE_READ:
      // Of a table within the query, as WITH makes one, SQLite asks as well. An empty column: only rows are
      // counted.
      if (first == watched.table && watched.reads != nullptr && second != nullptr && *second != '\0') {
        watched.reads->insert(second);
      }
      return std::string_view(first).starts_with("sqlite_") ? SQLITE_DENY : SQLITE_OK;
    case SQLITE_FUNCTION:
      return second != nullptr && std::ranges::binary_search(refused_functions, std::string_view(second))
                 ? SQLITE_DENY
                 : SQLITE_OK;
    default:
      return SQLITE_DENY;
  }
}

int one_more_time(void* user) {
  auto& watched = *static_cast<Watched*>(user);
  watched.too_long = ++watched.times > most_times;
  return watched.too_long ? 1 : 0;
}

// Has a connection ask these two while it lives, and SQLite take no more than so much more memory. That is a
// limit of all connections of the process, none of which is used by another thread meanwhile; it also bounds
// how far SQLite unfolds the parts of a query before it runs.
class Watching {
 public:
  Watching(sqlite3* database, Watched& watched)
      : database_(database), memory_limit_(sqlite3_hard_heap_limit64(sqlite3_memory_used() + most_memory)) {
    sqlite3_set_authorizer(database, authorize, &watched);
    sqlite3_progress_handler(database, steps_at_a_time, one_more_time, &watched);
  }
  Watching(const Watching&) = delete;
  Watching& operator=(const Watching&) = delete;
  ~Watching() {
    sqlite3_progress_handler(database_, 0, nullptr, nullptr);
    sqlite3_set_authorizer(database_, nullptr, nullptr);
    sqlite3_hard_heap_limit64(memory_limit_);
  }

 private:
  sqlite3* database_;
  sqlite3_int64 memory_limit_;  // as it was
};

Cell cell_of(sqlite3_value* value) {
  switch (sqlite3_value_type(value)) {
    case SQLITE_INTEGER:
      return std::int64_t{sqlite3_value_int64(value)};
    case SQLITE_FLOAT:
      return sqlite3_value_double(value);
    case SQLITE_NULL:
      return {};
    default: {
      const auto* const text = reinterpret_cast<const char*>(sqlite3_value_text(value));
      return text == nullptr ? Cell() : Cell(text);
    }
  }
}

// Texts and blobs as texts that can be printed.
Cell cell_of(const SQLite::Column& column) {
  return column.isNull()      ? Cell()
         : column.isInteger() ? Cell(std::int64_t{column.getInt64()})
         : column.isFloat()   ? Cell(column.getDouble())
                              : Cell(sim::shown(column.getString(), sim::all_shown));
}

// The SQL function shown(VALUE, UNIT).
void shown(sqlite3_context* context, int /*count*/, sqlite3_value** arguments) {
  try {
    const Cell unit = cell_of(arguments[1]);
    const auto* const name = std::get_if<std::string>(&unit);
    const Cell value = cell_of(arguments[0]);
    const auto* const whole = std::get_if<std::int64_t>(&value);
    const std::string text = name != nullptr && *name == "byte" && whole != nullptr && *whole >= 0
                                 ? sim::print_size(*whole)
                                 : figure_text(value, name == nullptr ? "" : *name, "-");
    sqlite3_result_text(context, text.c_str(), static_cast<int>(text.size()), SQLITE_TRANSIENT);
  } catch (const std::exception& error) {
    sqlite3_result_error(context, error.what(), -1);
  }
}

[[noreturn]] void fail(const sim::Place& place, const std::string& reason) {
  throw sim::UserError(place, sim::shown(reason));
}

// What is wrong with the statement that SQLite would accept: it leaves out without a word what follows the
// first, and explains instead of running it. Empty: nothing.
std::string refusal_of(sqlite3* database, const std::string& sql) {
  sqlite3_stmt* statement = nullptr;
  const char* tail = nullptr;
  if (sqlite3_prepare_v2(database, sql.c_str(), -1, &statement, &tail) != SQLITE_OK) {
    return {};  // it is refused later, with the reason
  }
  const bool runs = sqlite3_column_count(statement) > 0 && sqlite3_bind_parameter_count(statement) == 0 &&
                    sqlite3_stmt_isexplain(statement) == 0;
  sqlite3_finalize(statement);
  statement = nullptr;
  const bool alone =
      sqlite3_prepare_v2(database, tail, -1, &statement, nullptr) == SQLITE_OK && statement == nullptr;
  sqlite3_finalize(statement);
  return !alone ? "has more than one statement" : runs ? "" : "is no SELECT without parameters";
}

}  // namespace

QuerySandbox::QuerySandbox(std::string table, const std::vector<std::string>& columns)
    : database_(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_MEMORY | SQLite::OPEN_NOMUTEX),
      table_(std::move(table)) {
  std::string sql;
  for (const std::string& column : columns) {
    sql += (sql.empty() ? "" : ", ") + sql_name(column);
  }
  database_.exec("CREATE TABLE " + sql_name(table_) + " (" + sql + ")");
  sqlite3* const handle = database_.getHandle();
  // What a query sorts or puts aside is not written to files.
  database_.exec("PRAGMA temp_store = MEMORY");
  // A name that no column has is an error, not a text.
  sqlite3_db_config(handle, SQLITE_DBCONFIG_DQS_DML, 0, nullptr);
  sqlite3_limit(handle, SQLITE_LIMIT_LENGTH, longest_value);
  sqlite3_limit(handle, SQLITE_LIMIT_LIKE_PATTERN_LENGTH, longest_query_pattern);
  sqlite3_limit(handle, SQLITE_LIMIT_EXPR_DEPTH, deepest_query);
  database_.createFunction("shown", 2, true, nullptr, shown);
  insert_.emplace(database_, insert_sql(sql_name(table_), columns.size()));
}

void QuerySandbox::add_row(std::span<const Cell> cells) {
  bind_cells(*insert_, cells);
  (void)insert_->exec();
  insert_->reset();
}

QuerySandbox::Rows QuerySandbox::run(const std::string& sql, const sim::Place& place,
                                     std::set<std::string>* reads) {
  sqlite3* const handle = database_.getHandle();
  Watched watched{table_, reads};
  std::size_t bytes = 0;
  if (sql.find('\0') != std::string::npos) {
    fail(place, "has a character that no query has");
  }
  const Watching watching(handle, watched);
  Rows found;
  try {
    if (const std::string refusal = refusal_of(handle, sql); !refusal.empty()) {
      fail(place, refusal);
    }
    SQLite::Statement statement(database_, sql);
    for (int column = 0; column < statement.getColumnCount(); ++column) {
      found.names.emplace_back(statement.getColumnName(column));
    }
    while (statement.executeStep()) {
      if (found.rows.size() == most_rows) {
        fail(place, fmt::format("gives more than {} rows", most_rows));
      }
      std::vector<Cell>& row = found.rows.emplace_back();
      for (int column = 0; column < statement.getColumnCount(); ++column) {
        row.push_back(cell_of(statement.getColumn(column)));
        const auto* const text = std::get_if<std::string>(&row.back());
        bytes += text == nullptr ? 0 : text->size();
      }
      if (bytes > most_text) {
        fail(place, "gives more than 10 MB of text");
      }
    }
  } catch (const SQLite::Exception& error) {
    if (error.getErrorCode() == SQLITE_NOMEM) {
      fail(place, "takes more than 256 MB of memory");
    }
    const std::string_view reason = error.what();
    if (watched.too_long) {
      fail(place, "takes too long: more than 2e8 steps of SQLite");
    }
    if (error.getErrorCode() == SQLITE_AUTH || reason.starts_with("not authorized")) {
      fail(place, fmt::format("may only read the table {} and compute (SQLite: {})", table_, reason));
    }
    fail(place, fmt::format("SQLite: {}", reason));
  }
  return found;
}

}  // namespace marti::studies::tables
