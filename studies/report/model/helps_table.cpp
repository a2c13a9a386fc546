#include "studies/report/model/helps_table.h"

#include <string>
#include <vector>

#include "studies/helps/change.h"
#include "studies/keys/setting_value.h"

namespace marti::studies {

namespace {

// "machine.nodes 16 -> 18", several keys with commas between them.
std::string keys_text(const RunJson& change) {
  std::vector<KeyChange> keys;
  if (const RunJson found = change.part("keys"); found.json().is_object()) {
    for (const auto& [key, json] : found.json().items()) {
      const RunJson values = found.of(json);
      keys.push_back({key, setting_toml(key, values.find("from")), setting_toml(key, values.find("to"))});
    }
  }
  return describe(keys);
}

Cell cell(const std::optional<double>& value) { return value ? Cell(*value) : Cell(); }

}  // namespace

Table helps_table(const RunJson& run) {
  Table table(
      "what_helps", "What would make the frame shorter",
      {{"step", ColumnType::text, "", "what is changed, and nothing else"},
       {"saved", ColumnType::real, "fraction", "of the frame time; empty: not replayed"},
       {"most_saved", ColumnType::real, "fraction", "more cannot be saved, by the nodes' own work"},
       {"price", ColumnType::real, "1",
        "of the step, by [prices]; smaller packets, regions and another way of building cost nothing"},
       {"at_best", ColumnType::text, "", "the same resource as if it cost nothing"},
       {"saved_at_best", ColumnType::real, "fraction", "of the frame time; empty: not replayed"}});
  for (const RunJson& resource : run.list("machine.what_helps.resources")) {
    const RunJson step = resource.part("step");
    const RunJson best = resource.part("best");
    table.add_row({keys_text(step), cell(step.number("saved")), cell(step.number("most_saved")),
                   cell(step.number("price")), keys_text(best), cell(best.number("saved"))});
  }
  return table;
}

}  // namespace marti::studies
