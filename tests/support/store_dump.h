// The contents of the store of a sweep, as text.
#pragma once

#include <sqlite3.h>

#include <algorithm>
#include <filesystem>
#include <string>

namespace marti::test {

/// The rows of a query, one a line, each value with its type; an error's message when it fails. Rows are what
/// is committed, also while a sweep is writing.
inline std::string rows_of(const std::filesystem::path& store, const std::string& query) {
  std::string text;
  sqlite3* connection = nullptr;
  if (sqlite3_open_v2(store.c_str(), &connection, SQLITE_OPEN_READONLY, nullptr) != SQLITE_OK) {
    sqlite3_close(connection);
    return "cannot be opened";
  }
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(connection, query.c_str(), -1, &statement, nullptr) != SQLITE_OK) {
    text = std::string("fails: ") + sqlite3_errmsg(connection);
  }
  while (statement != nullptr && sqlite3_step(statement) == SQLITE_ROW) {
    for (int i = 0; i < sqlite3_column_count(statement); ++i) {
      const unsigned char* value = sqlite3_column_text(statement, i);
      text += std::to_string(sqlite3_column_type(statement, i)) +
              (value == nullptr ? std::string("NULL") : std::string(reinterpret_cast<const char*>(value))) +
              "|";
    }
    text += "\n";
  }
  sqlite3_finalize(statement);
  sqlite3_close(connection);
  return text;
}

/// The number that a query gives; -1 if it gives no number.
inline long number_of(const std::filesystem::path& store, const std::string& query) {
  const std::string text = rows_of(store, query);
  return text.size() > 1 && text[0] == '1' ? std::stol(text.substr(1)) : -1;
}

/// Every row of every table that is not of the host, as SQL writes values: equal for equal stores.
inline std::string dump(const std::filesystem::path& store) {
  const std::string names = rows_of(store,
                                    "SELECT name FROM sqlite_schema WHERE type IN ('table', 'view') AND name "
                                    "NOT LIKE 'host_%' ORDER BY name");
  std::string text;
  for (std::size_t at = 0; at < names.size();) {
    const std::size_t end = names.find("|\n", at);
    const std::string name = names.substr(at + 1, end - at - 1);
    text += "== " + name + "\n" + rows_of(store, "SELECT * FROM \"" + name + "\"");
    at = end + 2;
  }
  const std::string integrity = rows_of(store, "PRAGMA integrity_check");
  return text + "integrity: " + integrity.substr(std::min<std::size_t>(1, integrity.size()));
}

}  // namespace marti::test
