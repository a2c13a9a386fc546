#include "studies/sweep/store/store_columns.h"

#include "processors/cost/accounting.h"
#include "studies/sweep/plan/sweep_row.h"
#include "studies/tables/sqlite_connection.h"

namespace marti::studies {

namespace {

// A figure of the view summary. r is the result of the point's machine, b of its base, c of the machine that
// all are compared with. SQL has no value where it divides by 0.
struct Derived {
  std::string name;
  std::string unit;
  std::string description;
  std::string sql;
};

std::string quotient(const std::string& part, const std::string& whole) {
  return "CAST(" + part + " AS REAL) / (" + whole + ")";
}

std::vector<Derived> derived() {
  std::vector<Derived> all = {
      {"end", "ps", "frame time", "r.\"end\""},
      {"nodes", "1", "nodes of all clusters", "r.nodes"},
      {"speed_up", "1", "frame time of the base machine / frame time", quotient("b.\"end\"", "r.\"end\"")},
      {"efficiency", "1", "speed_up * nodes of the base machine / nodes",
       quotient("b.\"end\"", "r.\"end\"") + " * b.nodes / r.nodes"},
      {"times_faster", "1", "frame time of the machine compared with / frame time",
       quotient("c.\"end\"", "r.\"end\"")},
      {"hit_ratio", "1", "hits / (hits + misses), first level", quotient("r.hits", "r.hits + r.misses")},
      {"l2_hit_ratio", "1", "l2_hits / (l2_hits + l2_misses)",
       quotient("r.l2_hits", "r.l2_hits + r.l2_misses")},
      {"interconnect_utilisation", "1", "share of the frame time that the busiest cluster's links transfer",
       quotient("r.most_interconnect_busy", "r.\"end\" * (r.interconnect_links / r.clusters)")},
      {"bank_utilisation", "1", "share of the frame time that the busiest bank is busy, at most 1",
       "MIN(1.0, " + quotient("r.most_bank_busy", "r.\"end\"") + ")"},
      {"network_utilisation", "1", "share of the frame time that the busiest cluster's network is busy",
       quotient("r.most_network_busy", "r.\"end\" * (r.network_links / r.clusters)")},
      {"mean_interconnect_wait", "ps", "interconnect_wait_sum / interconnect_wait_count",
       quotient("r.interconnect_wait_sum", "r.interconnect_wait_count")},
      {"mean_bank_wait", "ps", "bank_wait_sum / bank_wait_count",
       quotient("r.bank_wait_sum", "r.bank_wait_count")},
      {"finish_balance", "1", "mean finish of the nodes / the latest",
       quotient("r.node_finish", "r.nodes * r.latest_finish")},
  };
  for (const std::string_view activity : processors::activity_names) {
    const std::string name(activity);
    all.push_back({"share_" + name, "1", "share of the nodes' time: " + name,
                   quotient("r.time_" + name, "r.nodes * r.\"end\"")});
  }
  return all;
}

std::vector<StoreColumn> point_columns(const std::string& table, std::span<const std::string> axes) {
  std::vector<StoreColumn> columns = {
      {table, "ordinal", "1", "number of the point, from 0"},
      {table, "machine", "", "id of its machine"},
      {table, "base", "", "id of the machine its speed-up is measured against"},
      {table, "cost", "1", "cost by the prices of the configuration"}};
  for (const std::string& axis : axes) {
    columns.push_back({table, axis, "", "the point's value of this key"});
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
      {"waits", "id", "", "number of a kind of wait"},
      {"waits", "name", "", "its name"},
      {"buckets", "lowest", "ps", "the shortest wait of a bucket"},
      {"buckets", "highest", "ps", "the longest"},
      {"wait_buckets", "machine", "", "the machine"},
      {"wait_buckets", "wait", "", "the kind of wait"},
      {"wait_buckets", "lowest", "ps", "the shortest wait of the bucket"},
      {"wait_buckets", "highest", "ps", "the longest, where it is not that of table buckets"},
      {"wait_buckets", "count", "1", "waits in the bucket"},
      {"compare", "machine", "", "the machine that all are compared with"},
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
      {"results", "checksum", "", "of the row and its histograms"}};
  for (const Column& column : sweep_columns()) {
    all.push_back({"results", column.name, column.unit, column.description});
  }
  append(all, {{"frame_results", "frame", "", "the frame"},
               {"frame_results", "scene", "", "the scene's own name"},
               {"frame_results", "scene_hash", "", "of what the frame depends on, FNV-1a"},
               {"frame_results", "image_hash", "", "of the bits of all pixels, FNV-1a"},
               {"frame_results", "hit_hash", "", "of the outcome of every ray"},
               {"frame_results", "checksum", "", "of the row and its notes"}});
  for (const Column& column : frame_columns()) {
    all.push_back({"frame_results", column.name, column.unit, column.description});
  }
  append(all, point_columns("points", axes));
  append(all, point_columns("summary", axes));
  for (const Derived& figure : derived()) {
    all.push_back({"summary", figure.name, figure.unit, figure.description});
  }
  return all;
}

std::string summary_view(std::span<const std::string> axes) {
  std::string sql = "CREATE VIEW summary AS SELECT ";
  std::string separator;
  for (const StoreColumn& column : point_columns("points", axes)) {
    sql += separator + "p." + sql_name(column.name) + " AS " + sql_name(column.name);
    separator = ", ";
  }
  for (const Derived& figure : derived()) {
    sql += ", " + figure.sql + " AS " + sql_name(figure.name);
  }
  return sql +
         " FROM points p LEFT JOIN results r ON r.machine = p.machine LEFT JOIN results b ON b.machine = "
         "p.base "
         "LEFT JOIN results c ON c.machine = (SELECT machine FROM compare)";
}

}  // namespace marti::studies
