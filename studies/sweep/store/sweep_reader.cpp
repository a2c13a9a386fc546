#include "studies/sweep/store/sweep_reader.h"

#include <algorithm>

#include "sim/error.h"
#include "sim/nearest.h"
#include "studies/sweep/store/store_schema.h"
#include "studies/sweep/store/store_sums.h"
#include "studies/tables/cell_number.h"

namespace marti::studies::sweep {

namespace {

// The columns of table points that are not axes.
constexpr std::size_t columns_before_axes = 4;

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

std::vector<std::string> columns_of(tables::SqliteConnection& connection, const std::string& table) {
  return tables::SqliteStatement(connection, "SELECT * FROM " + table).column_names();
}

}  // namespace

bool is_begun(const std::filesystem::path& store) {
  std::error_code error;
  if (std::filesystem::status(store, error).type() == std::filesystem::file_type::not_found) {
    return false;
  }
  tables::SqliteConnection connection(existing_store(store), tables::SqliteConnection::Access::read);
  return !is_empty_database(connection);
}

SweepReader::SweepReader(const std::filesystem::path& file)
    : connection_(existing_store(file), tables::SqliteConnection::Access::read), file_(file) {
  connection_.execute("BEGIN");  // from here on all reads are of one instant
  if (is_empty_database(connection_)) {
    throw sim::UserError(file.string() +
                         ": holds nothing: the sweep was ended before its plan was saved; run it again");
  }
  check_store_format(connection_, file);
  check_whole(connection_, file);
  version_ = value_of(connection_, "version").value_or("unknown");
  rows_.emplace(connection_);
  settings_.emplace(connection_,
                    "SELECT key, value FROM machine_settings WHERE machine = ?1 UNION "
                    "SELECT key, value FROM frame_settings WHERE frame = "
                    "(SELECT frame FROM machines WHERE id = ?1) ORDER BY key");
  const std::vector<std::string> columns = columns_of(connection_, "points");
  if (columns.size() < columns_before_axes) {
    throw sim::UserError(file.string() + ": its table points lacks columns: it is damaged");
  }
  axes_.assign(columns.begin() + columns_before_axes, columns.end());
  figures_ = columns_of(connection_, "summary");
  summary_figures_ = figures_.size();
  for (const std::string& counter : columns_of(connection_, "results")) {
    if (counter != "checksum" && !counter.ends_with("_histogram") &&
        std::ranges::find(figures_, counter) == figures_.end()) {
      figures_.push_back(counter);
    }
  }
}

std::vector<StoredPoint> SweepReader::points() const {
  std::vector<StoredPoint> points;
  for_each_point({}, [&](const StoredPoint& point, std::span<const tables::Cell> /*figures*/) {
    points.push_back(point);
  });
  return points;
}

std::size_t SweepReader::point_count() const {
  return static_cast<std::size_t>(connection_.value<std::int64_t>("SELECT count(*) FROM points").value_or(0));
}

std::optional<std::int64_t> SweepReader::compare() const {
  return connection_.value<std::int64_t>("SELECT machine FROM compare");
}

std::optional<SweepRow> SweepReader::read_result(std::int64_t machine) const {
  return rows_->find_machine(machine);
}

std::optional<FrameRow> SweepReader::read_frame(std::int64_t machine) const {
  tables::SqliteStatement row(connection_, "SELECT frame FROM machines WHERE id = ?");
  return row.with({machine}).next() ? rows_->find_frame(row.integer(0)) : std::nullopt;
}

std::vector<std::pair<std::string, std::string>> SweepReader::settings(std::int64_t machine) const {
  std::vector<std::pair<std::string, std::string>> settings;
  settings_->with({machine});
  while (settings_->next()) {
    settings.emplace_back(settings_->text(0), settings_->text(1));
  }
  return settings;
}

Question SweepReader::question() const {
  Question question;
  tables::SqliteStatement rows(
      connection_,
      "SELECT kind, name, text, sql, place, agrees, agrees_place FROM question ORDER BY position");
  while (rows.next()) {
    const std::string kind = rows.text(0);
    const Query query{rows.text(3), {rows.text(4)}};
    if (kind == "answer") {
      question.asks = rows.text(2);
      question.answer = query;
    } else if (kind == "table") {
      question.tables.push_back({rows.text(1), rows.text(2), query});
    } else {
      question.claims.push_back({rows.text(1), rows.text(2), query, {rows.text(5), {rows.text(6)}}});
    }
  }
  return question;
}

std::map<std::int64_t, Advice> SweepReader::advice() const {
  std::map<std::int64_t, Advice> all;
  tables::SqliteStatement rows(connection_, "SELECT machine, sentence, settings, saves, noise FROM advice");
  while (rows.next()) {
    all[rows.integer(0)] = {rows.text(1), rows.text(2), rows.get<double>(3), rows.get<double>(4)};
  }
  return all;
}

Noise SweepReader::noise_of_seeds() const {
  Noise noise{0.0, true};
  const auto seed = std::ranges::find(axes_, "image.seed");
  if (seed == axes_.end()) {
    return noise;
  }
  std::map<std::vector<tables::Cell>, std::pair<double, double>> times;  // the shortest and the longest
  const std::vector<std::string> figures = {"end"};
  for_each_point(figures, [&](const StoredPoint& point, std::span<const tables::Cell> cells) {
    if (const std::optional<double> end = tables::number_of(cells[0])) {
      std::vector<tables::Cell> others = point.values;
      others.erase(others.begin() + (seed - axes_.begin()));
      auto& [shortest, longest] = times.try_emplace(std::move(others), *end, *end).first->second;
      shortest = std::min(shortest, *end);
      longest = std::max(longest, *end);
      noise.band = shortest > 0.0 ? std::max(noise.band, longest / shortest - 1.0) : noise.band;
    }
  });
  return noise;
}

Noise SweepReader::noise() const {
  return larger({connection_.value<double>("SELECT MAX(noise) FROM advice").value_or(0.0)}, noise_of_seeds());
}

void SweepReader::for_each_point(
    std::span<const std::string> names,
    const std::function<void(const StoredPoint&, std::span<const tables::Cell>)>& visit) const {
  std::string sql = "SELECT s.ordinal, s.machine, s.base, s.cost, r.machine IS NOT NULL";
  for (const std::string& axis : axes_) {
    sql += ", s." + tables::sql_name(axis);
  }
  for (const std::string& name : names) {
    const auto at = std::ranges::find(figures_, name);
    if (at == figures_.end()) {
      throw sim::UserError(file_.string() + ": there is no figure \"" + name + "\"" +
                           sim::did_you_mean(name, figures_));
    }
    const bool in_summary = static_cast<std::size_t>(at - figures_.begin()) < summary_figures_;
    sql += (in_summary ? ", s." : ", r.") + tables::sql_name(name);
  }
  tables::SqliteStatement rows(
      connection_, sql + " FROM summary s LEFT JOIN results r ON r.machine = s.machine ORDER BY s.ordinal");
  std::vector<tables::Cell> cells(names.size());
  while (rows.next()) {
    int column = 0;
    StoredPoint point;
    point.ordinal = rows.integer(column++);
    point.machine = rows.integer(column++);
    point.base = rows.integer(column++);
    point.cost = tables::number_of(rows.cell(column++)).value_or(0.0);
    point.done = rows.integer(column++) != 0;
    for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
      point.values.push_back(rows.cell(column++));
    }
    for (tables::Cell& cell : cells) {
      cell = rows.cell(column++);
    }
    visit(point, cells);
  }
}

}  // namespace marti::studies::sweep
