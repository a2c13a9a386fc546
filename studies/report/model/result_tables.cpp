#include "studies/report/model/result_tables.h"

#include <array>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include "memory/record_kind.h"
#include "processors/cost/accounting.h"
#include "processors/energy/energy.h"
#include "sim/mapped.h"
#include "studies/figures/derived_figures.h"
#include "studies/tables/json_table.h"

namespace marti::studies::report {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* schema = R"sql(
CREATE TABLE result(json TEXT);
CREATE TABLE figures(part TEXT, name TEXT, value, text TEXT);
CREATE TABLE settings(key TEXT PRIMARY KEY, value);
CREATE TABLE activities(position INTEGER, name TEXT, kind TEXT);
CREATE TABLE records(position INTEGER, name TEXT);
CREATE TABLE losses(position INTEGER, name TEXT, text TEXT);
CREATE TABLE energy_parts(position INTEGER, name TEXT);

CREATE VIEW levels AS
SELECT level.key + 1 AS level, level.value ->> 'branches' AS branches, level.value ->> 'leaves' AS leaves,
  level.value ->> 'empty_leaves' AS empty_leaves, level.value ->> 'entries' AS entries
FROM result, json_each(result.json, '$.structure.levels') AS level;

CREATE VIEW level_references AS
SELECT part.value ->> 'level' AS level, part.value ->> 'record' AS record,
  part.value ->> 'references' AS "references", part.value ->> 'misses' AS misses
FROM result, json_each(result.json, '$.machine.counts.attribution') AS part
WHERE part.value ->> 'level' > 0;

CREATE VIEW node_times AS
SELECT node.key AS node, activities.name AS activity, kind, time.value AS ps
FROM result, json_each(result.json, '$.machine.per_node') AS node, json_each(node.value, '$.time_ps') AS time
  JOIN activities ON activities.name = time.key;

CREATE VIEW node_shares AS
SELECT node, CASE kind WHEN 'computing' THEN 'compute' WHEN 'memory' THEN 'memory' WHEN 'idle' THEN 'idle'
  ELSE 'waits' END AS what, TOTAL(ps) / (SELECT value FROM figures WHERE name = 'end') AS share
FROM node_times GROUP BY node, what;

CREATE VIEW waits AS
WITH histograms(what, buckets) AS (
  SELECT 'interconnect', value -> '$.interconnect.waits.histogram_ps'
  FROM result, json_each(result.json, '$.machine.per_cluster')
  UNION ALL SELECT 'network', value -> '$.distributed.network.waits.histogram_ps'
  FROM result, json_each(result.json, '$.machine.per_cluster')
  UNION ALL SELECT 'bank', bank.value -> '$.waits.histogram_ps'
  FROM result, json_each(result.json, '$.machine.per_cluster') AS cluster,
    json_each(cluster.value, '$.banks') AS bank)
SELECT what, bucket.value ->> 1 AS highest_ps, bucket.value ->> 2 AS count
FROM histograms, json_each(buckets) AS bucket;
)sql";

constexpr std::array<std::string_view, 5> kind_names = {"computing", "memory", "queueing", "delay", "idle"};
static_assert(static_cast<std::size_t>(processors::cost::ActivityKind::idle) + 1 == kind_names.size());

void insert_names(tables::SqliteConnection& connection, const std::string& table,
                  std::span<const std::string_view> names) {
  tables::SqliteStatement insert(connection, tables::insert_sql(table, 2));
  std::int64_t position = 0;
  for (const std::string_view name : names) {
    insert.run({position++, name});
  }
}

}  // namespace

ResultTables::ResultTables(const tables::RunJson& run)
    : connection_(run.file(), tables::SqliteConnection::Access::memory) {
  connection_.execute(schema);
  connection_.transact([&] {
    tables::SqliteStatement(connection_, tables::insert_sql("result", 1))
        .run({run.json().dump(-1, ' ', false, Json::error_handler_t::replace)});
    tables::SqliteStatement figure(connection_, tables::insert_sql("figures", 4));
    for (const std::string part : {"frame", "machine"}) {
      for (const auto& [name, value] : run.find("figures." + part).items()) {
        if (value.is_number() || value.is_string()) {
          figure.run({part, name, tables::cell_of(value),
                      value.is_string() ? value.get<std::string>() : value.dump()});
        }
      }
    }
    tables::SqliteStatement setting(connection_, tables::insert_sql("settings", 2));
    for (const auto& [key, each] : run.find("config.keys").items()) {
      setting.run({key, tables::cell_of(run.of(each).find("value"))});
    }
    tables::SqliteStatement activity(connection_, tables::insert_sql("activities", 3));
    for (std::size_t i = 0; i < processors::cost::activities; ++i) {
      activity.run({i, processors::cost::activity_names[i],
                    kind_names.at(static_cast<std::size_t>(processors::cost::activity_kinds[i]))});
    }
    insert_names(connection_, "records", memory::record_kind_names);
    tables::SqliteStatement loss(connection_, tables::insert_sql("losses", 3));
    for (std::size_t i = 0; i < figures::loss_names.size(); ++i) {
      loss.run({i, figures::loss_names.at(i), figures::loss_text(figures::loss_names.at(i))});
    }
    const auto energies = sim::mapped(processors::energy::EnergyResult::counters(),
                                      [](const auto& counter) { return std::string_view(counter.name); });
    insert_names(connection_, "energy_parts", std::span(energies).first(processors::energy::energy_parts));
  });
}

Json ResultTables::rows(const std::string& sql) {
  tables::SqliteStatement statement(connection_, sql);
  const std::vector<std::string> names = statement.column_names();
  Json rows = Json::array();
  while (statement.next()) {
    Json& row = rows.emplace_back(Json::object());
    for (std::size_t i = 0; i < names.size(); ++i) {
      row[names[i]] = tables::json_of(statement.cell(static_cast<int>(i)));
    }
  }
  return rows;
}

}  // namespace marti::studies::report
