#include "studies/sweep/store/sweep_reader.h"

#include <algorithm>

#include "sim/error.h"
#include "sim/nearest.h"
#include "studies/sweep/store/store_rows.h"
#include "studies/sweep/store/store_schema.h"
#include "studies/sweep/store/store_sums.h"
#include "studies/tables/cell_number.h"
#include "studies/tables/sqlite_connection.h"

namespace marti::studies {

namespace {

// The columns of table points that are not axes.
constexpr std::size_t point_columns = 4;

const std::filesystem::path& existing_store(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (status.type() == std::filesystem::file_type::not_found) {
    throw sim::UserError(file.string() + ": there is no such file");
  }
  if (error) {
    throw sim::UserError(file.string() + ": cannot be read: " + error.message());
  }
  return check_store_file(file);
}

std::vector<std::string> columns_of(SqliteConnection& connection, const std::string& table) {
  const SqliteStatement statement(connection, "SELECT * FROM " + table + " LIMIT 0");
  std::vector<std::string> names;
  for (int i = 0; i < statement.columns(); ++i) {
    names.push_back(statement.column_name(i));
  }
  return names;
}

}  // namespace

bool is_begun(const std::filesystem::path& store) {
  std::error_code error;
  if (std::filesystem::status(store, error).type() == std::filesystem::file_type::not_found) {
    return false;
  }
  SqliteConnection connection(existing_store(store), SqliteConnection::Access::read);
  return !is_empty_database(connection);
}

class SweepReader::Implementation {
 public:
  explicit Implementation(const std::filesystem::path& file)
      : file_(file), connection_(existing_store(file), SqliteConnection::Access::read) {
    connection_.execute("BEGIN");  // from here on all reads are of one instant
    if (is_empty_database(connection_)) {
      throw sim::UserError(file.string() +
                           ": holds nothing: the sweep was ended before its plan was saved; run it again");
    }
    const std::int64_t format = check_store_format(connection_, file);
    check_whole(connection_, file, format);
    const Cell found = connection_.value("SELECT value FROM store WHERE what = 'version'");
    const auto* text = std::get_if<std::string>(&found);
    version_ = text == nullptr ? "unknown" : *text;
    rows_.emplace(connection_);
    settings_.emplace(connection_,
                      "SELECT key, value FROM machine_settings WHERE machine = ?1 UNION "
                      "SELECT key, value FROM frame_settings WHERE frame = "
                      "(SELECT frame FROM machines WHERE id = ?1) ORDER BY key");
    const std::vector<std::string> columns = columns_of(connection_, "points");
    if (columns.size() < point_columns) {
      throw sim::UserError(file.string() + ": its table points lacks columns: it is damaged");
    }
    axes_.assign(columns.begin() + point_columns, columns.end());
    figures_ = columns_of(connection_, "summary");
    summary_figures_ = figures_.size();
    for (const std::string& counter : columns_of(connection_, "results")) {
      if (counter != "checksum" && std::find(figures_.begin(), figures_.end(), counter) == figures_.end()) {
        figures_.push_back(counter);
      }
    }
  }

  void visit(std::span<const std::string> names,
             const std::function<void(const StoredPoint&, std::span<const Cell>)>& visit) {
    std::string sql = "SELECT s.ordinal, s.machine, s.base, s.cost, r.machine IS NOT NULL";
    for (const std::string& axis : axes_) {
      sql += ", s." + sql_name(axis);
    }
    for (const std::string& name : names) {
      const auto at = std::find(figures_.begin(), figures_.end(), name);
      if (at == figures_.end()) {
        throw sim::UserError(file_.string() + ": there is no figure \"" + name + "\"" +
                             sim::did_you_mean(name, figures_));
      }
      const bool in_summary = static_cast<std::size_t>(at - figures_.begin()) < summary_figures_;
      sql += (in_summary ? ", s." : ", r.") + sql_name(name);
    }
    SqliteStatement rows(
        connection_, sql + " FROM summary s LEFT JOIN results r ON r.machine = s.machine ORDER BY s.ordinal");
    std::vector<Cell> cells(names.size());
    const int first = 5;
    while (rows.next()) {
      StoredPoint point{rows.integer(0),      rows.integer(1),
                        rows.integer(2),      number_of(rows.cell(3)).value_or(0.0),
                        rows.integer(4) != 0, {}};
      int column = first;
      for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
        point.values.push_back(rows.cell(column++));
      }
      for (Cell& cell : cells) {
        cell = rows.cell(column++);
      }
      visit(point, cells);
    }
  }

  std::vector<std::pair<std::string, std::string>> settings(std::int64_t machine) {
    SqliteStatement& rows = *settings_;
    rows.reset();
    rows.bind(1, machine);
    std::vector<std::pair<std::string, std::string>> settings;
    while (rows.next()) {
      settings.emplace_back(rows.text(0), rows.text(1));
    }
    return settings;
  }

  std::optional<FrameRow> frame(std::int64_t machine) {
    SqliteStatement row(connection_, "SELECT frame FROM machines WHERE id = ?");
    row.bind(1, machine);
    return row.next() ? rows_->find_frame(row.integer(0)) : std::nullopt;
  }

  std::vector<std::string> keys(const std::string& sql) {
    std::vector<std::string> found;
    SqliteStatement statement(connection_, sql);
    while (statement.next()) {
      found.push_back(statement.text(0));
    }
    std::sort(found.begin(), found.end());
    return found;
  }

  std::optional<std::int64_t> compare() {
    const Cell cell = connection_.value("SELECT machine FROM compare");
    const auto* id = std::get_if<std::int64_t>(&cell);
    return id == nullptr ? std::nullopt : std::optional(*id);
  }

  std::optional<SweepRow> result(std::int64_t machine) { return rows_->find_machine(machine); }
  [[nodiscard]] const std::string& version() const { return version_; }
  [[nodiscard]] const std::vector<std::string>& axes() const { return axes_; }
  [[nodiscard]] const std::vector<std::string>& figures() const { return figures_; }

 private:
  std::filesystem::path file_;
  SqliteConnection connection_;
  std::optional<RowReader> rows_;  // made once the tables are known to exist
  std::optional<SqliteStatement> settings_;
  std::string version_;
  std::vector<std::string> axes_;
  std::vector<std::string> figures_;
  std::size_t summary_figures_ = 0;  // so many of `figures_`, from the first
};

SweepReader::SweepReader(const std::filesystem::path& file)
    : implementation_(std::make_unique<Implementation>(file)) {}

SweepReader::~SweepReader() = default;

const std::string& SweepReader::version() const { return implementation_->version(); }

const std::vector<std::string>& SweepReader::axes() const { return implementation_->axes(); }

std::vector<StoredPoint> SweepReader::points() const {
  std::vector<StoredPoint> points;
  implementation_->visit(
      {}, [&](const StoredPoint& point, std::span<const Cell> /*figures*/) { points.push_back(point); });
  return points;
}

std::optional<std::int64_t> SweepReader::compare() const { return implementation_->compare(); }

std::vector<std::string> SweepReader::machines_done() const {
  return implementation_->keys("SELECT m.key FROM machines m JOIN results r ON r.machine = m.id");
}

std::vector<std::string> SweepReader::frames_done() const {
  return implementation_->keys("SELECT f.key FROM frames f JOIN frame_results r ON r.frame = f.id");
}

std::optional<SweepRow> SweepReader::read_result(std::int64_t machine) const {
  return implementation_->result(machine);
}

std::optional<FrameRow> SweepReader::read_frame(std::int64_t machine) const {
  return implementation_->frame(machine);
}

std::vector<std::pair<std::string, std::string>> SweepReader::settings(std::int64_t machine) const {
  return implementation_->settings(machine);
}

std::vector<std::string> SweepReader::figures() const { return implementation_->figures(); }

void SweepReader::for_each_point(
    std::span<const std::string> names,
    const std::function<void(const StoredPoint&, std::span<const Cell>)>& visit) const {
  implementation_->visit(names, visit);
}

}  // namespace marti::studies
