#include "studies/sweep/plan/sweep_filter.h"

#include <sqlite3.h>

#include <new>
#include <variant>

#include "sim/error.h"

namespace marti::studies::sweep {

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

}  // namespace

SweepFilter::SweepFilter(const sim::Schema& schema, std::string_view text, bool points,
                         const sim::Place& place)
    : text_(translate_filter(schema, text, points, place)),
      place_(place),
      database_(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_MEMORY | SQLite::OPEN_NOMUTEX) {
  constexpr int longest_pattern = 200;
  constexpr int deepest = 200;
  sqlite3_limit(database_.getHandle(), SQLITE_LIMIT_LIKE_PATTERN_LENGTH, longest_pattern);
  sqlite3_limit(database_.getHandle(), SQLITE_LIMIT_EXPR_DEPTH, deepest);
  sqlite3_set_authorizer(database_.getHandle(), authorize, nullptr);
  std::string columns;
  for (const std::size_t key : text_.columns) {
    columns += (columns.empty() ? "? AS \"" : ", ? AS \"") +
               (key == FilterText::point ? "point" : schema.names()[key]) + "\"";
  }
  try {
    statement_.emplace(database_, "SELECT (" + text_.sql + ") IS TRUE FROM (SELECT " + columns + ")");
  } catch (const SQLite::Exception& error) {
    fail("is no whole expression", error);
  }
  sim::ensure(statement_->getColumnCount() == 1, "a filter became more than one expression");
}

void SweepFilter::fail(const char* what, const SQLite::Exception& error) const {
  if (error.getErrorCode() == SQLITE_NOMEM) {
    throw std::bad_alloc();
  }
  throw sim::UserError(place_, std::string(what) + " (SQLite: " + error.what() + ")");
}

bool SweepFilter::passes(std::span<const sim::Value> values) {
  sim::ensure(values.size() == columns().size(), "a filter needs a value for each of its columns");
  try {
    int index = 0;
    for (const sim::Value& value : values) {
      ++index;
      const bool* boolean = std::get_if<bool>(&value);
      boolean != nullptr
          ? statement_->bind(index, *boolean ? 1 : 0)
          : std::visit([&](const auto& number_or_text) { statement_->bind(index, number_or_text); }, value);
    }
    const bool passes = statement_->executeStep() && statement_->getColumn(0).getInt() != 0;
    statement_->reset();
    return passes;
  } catch (const SQLite::Exception& error) {
    statement_->tryReset();
    fail("cannot be computed", error);
  }
}

}  // namespace marti::studies::sweep
