// A run's result as tables of SQL, which the charts and tables of its page ask.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "studies/tables/run_json.h"
#include "studies/tables/sqlite_connection.h"

namespace marti::studies::report {

/// A database in memory with these tables and views:
///
/// - result(json): the whole result.json, in one row
/// - figures(part, name, value, text): part is "frame" or "machine", text the value as it stands in
/// result.json
/// - settings(key, value): in the units of result.json
/// - activities(position, name, kind): kind is "computing", "memory", "queueing", "delay" or "idle"
/// - losses(position, name, text): parts of the lost speed-up, with their names for people
/// - records(position, name) and energy_parts(position, name): kinds of record, parts of the energy
/// - levels(level, branches, leaves, empty_leaves, entries): of the structure, from 1, the root
/// - level_references(level, record, references, misses): of counting caches
/// - node_times(node, activity, kind, ps)
/// - node_shares(node, what, share): of the frame; what is "compute", "memory", "waits" or "idle"
/// - waits(what, highest_ps, count): buckets of histograms; what is "interconnect", "bank" or "network"
///
/// Times are in ps, energies in fJ. A table lacks what the result lacks. Throws UserError, naming the file,
/// for a result whose parts have another form, and for a query whose numbers do not fit.
class ResultTables {
 public:
  explicit ResultTables(const tables::RunJson& run);

  /// A list of objects with the columns' names; null for what has no value.
  [[nodiscard]] nlohmann::ordered_json rows(const std::string& sql);

 private:
  tables::SqliteConnection connection_;
};

}  // namespace marti::studies::report
