#include "studies/sweep/store/store_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "processors/walk/observer.h"
#include "sim/mapped.h"
#include "studies/figures/derived_figures.h"
#include "studies/run/frame_figures.h"
#include "studies/run/record/interval_figures.h"
#include "studies/sweep/plan/axis_text.h"
#include "studies/sweep/plan/sweep_row.h"
#include "studies/tables/sqlite_connection.h"

namespace marti::studies::sweep {

namespace {

StoreColumn column_of(const std::string& table, const figures::FigureEntry& figure) {
  return {table,
          figure.name,
          figure.unit,
          figure.description,
          std::string(figures::merge_names.at(static_cast<std::size_t>(figure.merge))),
          std::string(figures::better_names.at(static_cast<std::size_t>(figure.better))),
          figure.formula ? figure.formula->text() : std::string()};
}

// The columns of what nodes did in each interval, under the names that files of intervals have.
std::vector<StoreColumn> state_columns(const std::string& table, const std::string& kind,
                                       const std::string& unit, const std::string& description) {
  return sim::mapped(processors::walk::node_state_names, [&](std::string_view state) {
    return StoreColumn{table, kind + "_" + std::string(state), unit, description};
  });
}

// The figures of the view summary: those by which points are told apart at a glance.
std::vector<figures::FigureEntry> summary_figures() {
  std::vector<figures::FigureEntry> figures = {figures::figure_named("end"), figures::figure_named("nodes")};
  figures.insert(figures.end(), figures::derived_figures().begin(), figures::derived_figures().end());
  return figures;
}

std::vector<StoreColumn> point_columns(const std::string& table, std::span<const std::string> axes) {
  std::vector<StoreColumn> columns = {
      {table, "ordinal", "1", "number of the point, from 0"},
      {table, "machine", "", "id of its machine"},
      {table, "base", "", "id of the machine its speed-up is measured against"},
      {table, "cost", "1", "cost by the prices of the configuration"}};
  for (const std::string& axis : axes) {
    columns.push_back({table, axis, axis_unit(axis), "the point's value of this key"});
  }
  return columns;
}

void append(std::vector<StoreColumn>& into, std::vector<StoreColumn> more) {
  into.insert(into.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

}  // namespace

std::vector<StoreColumn> store_columns(std::span<const std::string> axes) {
  std::vector<StoreColumn> all = {
      {"store", "what", "", "format, version, build or checksum"},
      {"store", "value", "", "of the store, of the program that made it, of the plan"},
      {"provenance", "what", "", "property of the present plan"},
      {"provenance", "value", "", "its value"},
      {"settings", "id", "", "number of the setting"},
      {"settings", "key", "", "key of the configuration"},
      {"settings", "value", "", "its value, as in a TOML file"},
      {"sections", "section", "", "settings of one section of the configuration that occur together"},
      {"sections", "setting", "", "one of them"},
      {"frames", "id", "", "number of the frame"},
      {"frames", "key", "", "fingerprint of its settings and the program's version"},
      {"frame_sections", "frame", "", "the frame"},
      {"frame_sections", "section", "", "a section of its settings"},
      {"frame_notes", "frame", "", "the frame"},
      {"frame_notes", "ordinal", "1", "number of the note"},
      {"frame_notes", "note", "", "what the loader or builder chose or left out"},
      {"machines", "id", "", "number of the machine"},
      {"machines", "key", "", "fingerprint of its settings and its frame"},
      {"machines", "frame", "", "the frame it is timed on"},
      {"machine_sections", "machine", "", "the machine"},
      {"machine_sections", "section", "", "a section of its settings"},
      {"compare", "machine", "", "the machine that all are compared with"},
      {"question", "position", "1", "order within the configuration"},
      {"question", "kind", "", "answer, table or claim"},
      {"question", "name", "", "of a table, or what a claim is about"},
      {"question", "text", "", "what is asked, the title of a table, or what is claimed"},
      {"question", "sql", "", "query over the points that gives the answer, the table, or what was measured"},
      {"question", "place", "", "where it stands in the configuration"},
      {"question", "agrees", "", "query that says whether the claim holds"},
      {"question", "agrees_place", "", "where it stands in the configuration"},
      {"advice", "machine", "", "a machine that matters: the fastest, or one that no other beats"},
      {"advice", "sentence", "", "what would help it most, measured when the sweep ended"},
      {"advice", "settings", "", "that make this step, each as for --set; between them semicolons"},
      {"advice", "saves", "fraction", "of the frame time that the step saves"},
      {"advice", "noise", "fraction", "by which its frames differ with packets in other orders"},
      {"advice", "checksum", "", "of the row"},
      {"machine_settings", "machine", "", "the machine"},
      {"machine_settings", "key", "", "a key of its own; those of its frame are in frame_settings"},
      {"machine_settings", "value", "", "its value, as in a TOML file"},
      {"frame_settings", "frame", "", "the frame"},
      {"frame_settings", "key", "", "a key"},
      {"frame_settings", "value", "", "its value, as in a TOML file"},
      {"histograms", "machine", "", "the machine"},
      {"histograms", "what", "", "the kind of wait"},
      {"histograms", "lowest", "ps", "the shortest wait of the bucket"},
      {"histograms", "highest", "ps", "the longest"},
      {"histograms", "count", "1", "waits in the bucket"},
      {"results", "machine", "", "the machine"},
      {"results", "checksum", "", "of the row and its intervals"}};
  for (const std::string_view name : histogram_names) {
    all.push_back({"results", std::string(name) + "_histogram", "ps",
                   "waits as JSON: [lowest, highest, count] of each bucket that holds some"});
  }
  for (const figures::FigureEntry& figure : figures::counted_figures()) {
    all.push_back(column_of("results", figure));
  }
  append(all, {{"frame_results", "frame", "", "the frame"},
               {"frame_results", "scene", "", "the scene's own name"},
               {"frame_results", "scene_hash", "", "of what the frame depends on, FNV-1a"},
               {"frame_results", "image_hash", "", "of the bits of all pixels, FNV-1a"},
               {"frame_results", "hit_hash", "", "of the outcome of every ray"},
               {"frame_results", "checksum", "", "of the row and its notes"}});
  for (const figures::FigureEntry& figure : run::frame_figures()) {
    all.push_back(column_of("frame_results", figure));
  }
  append(all, {{"intervals", "machine", "", "a machine with record.interval"},
               {"intervals", "ordinal", "1", "number of the interval, from 0"},
               {"intervals", "from_ps", "ps", "begin of the interval"},
               {"intervals", "to_ps", "ps", "its end: the next one's begin, or that of the frame"}});
  append(all, state_columns("intervals", "spent", "ps", "time that nodes were in this state"));
  for (const std::size_t place : run::counted_in_intervals()) {
    all.push_back(column_of("intervals", figures::counted_figures()[place]));
  }
  append(all, {{"interval_figures", "machine", "", "a machine with record.interval"},
               {"interval_figures", "ordinal", "1", "number of the interval, from 0"},
               {"interval_figures", "from_ps", "ps", "begin of the interval"},
               {"interval_figures", "to_ps", "ps", "its end"}});
  append(all,
         state_columns("interval_figures", "share", "fraction", "share of the nodes' time in this state"));
  for (const figures::FigureEntry& figure : run::derived_in_intervals()) {
    all.push_back(column_of("interval_figures", figure));
  }
  append(all, point_columns("points", axes));
  append(all, point_columns("summary", axes));
  for (const figures::FigureEntry& figure : summary_figures()) {
    all.push_back(column_of("summary", figure));
  }
  return all;
}

std::string intervals_sql() {
  std::string table =
      "CREATE TABLE intervals (machine INTEGER NOT NULL, ordinal INTEGER NOT NULL, from_ps INTEGER NOT NULL, "
      "to_ps INTEGER NOT NULL";
  std::string view =
      "CREATE VIEW interval_figures AS SELECT r.machine AS machine, r.ordinal AS ordinal, "
      "r.from_ps AS from_ps, r.to_ps AS to_ps";
  for (const std::string_view state : processors::walk::node_state_names) {
    table += fmt::format(", spent_{} INTEGER NOT NULL", state);
    view +=
        fmt::format(", CAST(r.spent_{0} AS REAL) / (r.nodes * (r.to_ps - r.from_ps)) AS share_{0}", state);
  }
  for (const figures::FigureEntry& figure : run::derived_in_intervals()) {
    view += ", " + figure.formula->sql() + " AS " + tables::sql_name(figure.name);
  }
  // What does not grow during the frame and is a sum is so of the machine all the time: links, banks.
  const auto places = run::counted_in_intervals();
  std::string own;
  for (std::size_t i = 0; i < figures::counted_figures().size(); ++i) {
    const std::string name = tables::sql_name(figures::counted_figures()[i].name);
    if (std::ranges::binary_search(places, i)) {
      table += ", " + name + " INTEGER";
      own += fmt::format(", COALESCE(i.{0}, w.{0}) AS {0}", name);
    } else if (name == "\"nodes\"" || name == "\"clusters\"") {
      own += fmt::format(", w.{0} AS {0}", name);
    } else {
      own += (name == "\"end\"" ? ", i.to_ps - i.from_ps AS " : ", NULL AS ") + name;
    }
  }
  for (const std::string_view state : processors::walk::node_state_names) {
    own += fmt::format(", i.spent_{0} AS spent_{0}", state);
  }
  return table + ", PRIMARY KEY (machine, ordinal)) WITHOUT ROWID; " + view +
         " FROM (SELECT i.machine AS machine, i.ordinal AS ordinal, i.from_ps AS from_ps, i.to_ps AS to_ps" +
         own + " FROM intervals i JOIN results w ON w.machine = i.machine) r";
}

std::string summary_view(std::span<const std::string> axes) {
  std::string sql = "CREATE VIEW summary AS SELECT ";
  std::string separator;
  for (const StoreColumn& column : point_columns("points", axes)) {
    sql += separator + "p." + tables::sql_name(column.name) + " AS " + tables::sql_name(column.name);
    separator = ", ";
  }
  // r is the result of the point's machine, b of its base, c of the machine that all are compared with.
  for (const figures::FigureEntry& figure : summary_figures()) {
    sql += ", " + (figure.formula ? figure.formula->sql() : "r." + tables::sql_name(figure.name)) + " AS " +
           tables::sql_name(figure.name);
  }
  return sql +
         " FROM points p LEFT JOIN results r ON r.machine = p.machine LEFT JOIN results b ON b.machine = "
         "p.base "
         "LEFT JOIN results c ON c.machine = (SELECT machine FROM compare)";
}

}  // namespace marti::studies::sweep
