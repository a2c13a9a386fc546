#include "studies/sweep/plan/sweep_filter.h"

#include <sqlite3.h>

#include <cstdint>
#include <new>
#include <variant>

#include "sim/error.h"

namespace marti::studies {

namespace {

constexpr int deny = SQLITE_DENY;

// Selecting from values and calling functions that compute: nothing else, whatever the text says.
int authorize(void* /*user*/, int action, const char* /*first*/, const char* function,
              const char* /*database*/, const char* /*trigger*/) {
  if (action == SQLITE_SELECT) {
    return SQLITE_OK;
  }
  if (action == SQLITE_FUNCTION && function != nullptr && is_filter_function(function)) {
    return SQLITE_OK;
  }
  return deny;
}

int bind(sqlite3_stmt* statement, int index, const sim::Value& value) {
  if (const bool* boolean = std::get_if<bool>(&value)) {
    return sqlite3_bind_int(statement, index, *boolean ? 1 : 0);
  }
  if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    return sqlite3_bind_int64(statement, index, *integer);
  }
  if (const double* real = std::get_if<double>(&value)) {
    return sqlite3_bind_double(statement, index, *real);
  }
  const std::string& text = std::get<std::string>(value);
  return sqlite3_bind_text64(statement, index, text.data(), text.size(), nullptr, SQLITE_UTF8);
}

}  // namespace

struct SweepFilter::Statement {
  FilterText text;
  std::string place;
  sqlite3* connection = nullptr;
  sqlite3_stmt* statement = nullptr;

  Statement() = default;
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;
  ~Statement() {
    sqlite3_finalize(statement);
    sqlite3_close_v2(connection);
  }

  void check(int status, bool preparing = false) const {
    if (status == SQLITE_OK) {
      return;
    }
    if (status == SQLITE_NOMEM || connection == nullptr) {
      throw std::bad_alloc();
    }
    throw sim::UserError(place + ": " + (preparing ? "is no whole expression" : "cannot be computed") +
                         " (SQLite: " + sqlite3_errmsg(connection) + ")");
  }
};

SweepFilter::SweepFilter(const sim::Schema& schema, std::string_view text, bool points,
                         std::string_view place)
    : statement_(std::make_unique<Statement>()) {
  Statement& made = *statement_;
  made.text = translate_filter(schema, text, points, place);
  made.place = place;
  made.check(sqlite3_open_v2(":memory:", &made.connection,
                             SQLITE_OPEN_READWRITE | SQLITE_OPEN_MEMORY | SQLITE_OPEN_NOMUTEX, nullptr));
  constexpr int longest_pattern = 200;
  constexpr int deepest = 200;
  sqlite3_limit(made.connection, SQLITE_LIMIT_LIKE_PATTERN_LENGTH, longest_pattern);
  sqlite3_limit(made.connection, SQLITE_LIMIT_EXPR_DEPTH, deepest);
  made.check(sqlite3_set_authorizer(made.connection, authorize, nullptr));
  std::string columns;
  for (std::size_t i = 0; i < made.text.columns.size(); ++i) {
    const std::size_t key = made.text.columns[i];
    columns += (i == 0 ? "?" : ", ?") + std::to_string(i + 1) + " AS \"" +
               (key == FilterText::point ? "point" : schema.names()[key]) + "\"";
  }
  const std::string sql = "SELECT (" + made.text.sql + ") IS TRUE FROM (SELECT " + columns + ")";
  const char* rest = nullptr;
  made.check(sqlite3_prepare_v2(made.connection, sql.c_str(), -1, &made.statement, &rest), true);
  sim::ensure(rest != nullptr && *rest == '\0' && made.statement != nullptr &&
                  sqlite3_stmt_readonly(made.statement) != 0 && sqlite3_column_count(made.statement) == 1,
              "a filter became more than one expression");
}

SweepFilter::~SweepFilter() = default;
SweepFilter::SweepFilter(SweepFilter&&) noexcept = default;

std::span<const std::size_t> SweepFilter::columns() const { return statement_->text.columns; }

bool SweepFilter::passes(std::span<const sim::Value> values) {
  sqlite3_stmt* statement = statement_->statement;
  sim::ensure(values.size() == columns().size(), "a filter needs a value for each of its columns");
  for (std::size_t i = 0; i < values.size(); ++i) {
    statement_->check(bind(statement, static_cast<int>(i) + 1, values[i]));
  }
  const int status = sqlite3_step(statement);
  const bool passes = status == SQLITE_ROW && sqlite3_column_int(statement, 0) != 0;
  const int reset = sqlite3_reset(statement);
  if (status != SQLITE_ROW) {
    statement_->check(reset == SQLITE_OK ? SQLITE_ERROR : reset);
  }
  return passes;
}

}  // namespace marti::studies
