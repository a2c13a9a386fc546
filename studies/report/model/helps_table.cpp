#include "studies/report/model/helps_table.h"

#include <string>
#include <vector>

#include "studies/helps/change.h"
#include "studies/keys/setting_value.h"

namespace marti::studies::report {

namespace {

// "machine.nodes 16 -> 18", several keys with commas between them.
std::string keys_text(const tables::RunJson& change) {
  std::vector<helps::KeyChange> keys;
  if (const tables::RunJson found = change.part("keys"); found.json().is_object()) {
    for (const auto& [key, json] : found.json().items()) {
      const tables::RunJson values = found.of(json);
      keys.push_back(
          {key, keys::setting_toml(key, values.find("from")), keys::setting_toml(key, values.find("to"))});
    }
  }
  return helps::describe(keys);
}

tables::Cell cell(const std::optional<double>& value) {
  return value ? tables::Cell(*value) : tables::Cell();
}

}  // namespace

tables::Table helps_table(const tables::RunJson& run) {
  tables::Table table(
      "what_helps", "What would make the frame shorter",
      {{"step", tables::ColumnType::text, "", "what is changed, and nothing else"},
       {"saved", tables::ColumnType::real, "fraction", "of the frame time; empty: not replayed"},
       {"most_saved", tables::ColumnType::real, "fraction", "more cannot be saved, by the nodes' own work"},
       {"price", tables::ColumnType::real, "1",
        "of the step, by [prices]; smaller packets, regions and another way of building cost nothing"},
       {"at_best", tables::ColumnType::text, "", "the same resource as if it cost nothing"},
       {"saved_at_best", tables::ColumnType::real, "fraction", "of the frame time; empty: not replayed"}});
  for (const tables::RunJson& resource : run.list("machine.what_helps.resources")) {
    const tables::RunJson step = resource.part("step");
    const tables::RunJson best = resource.part("best");
    table.add_row({keys_text(step), cell(step.number("saved")), cell(step.number("most_saved")),
                   cell(step.number("price")), keys_text(best), cell(best.number("saved"))});
  }
  return table;
}

}  // namespace marti::studies::report
