#include "studies/report/model/helps_table.h"

#include <string>

namespace marti::studies {

namespace {

using Json = nlohmann::ordered_json;

std::string unquoted(std::string text) {
  std::erase(text, '"');
  return text;
}

// "machine.nodes 16 -> 18", several keys with commas between them.
std::string keys_text(const RunJson& change) {
  std::string text;
  const Json& keys = change.find("keys");
  if (!keys.is_object()) {
    return text;
  }
  for (const auto& [key, values] : keys.items()) {
    const RunJson value(values, change.file());
    text += (text.empty() ? "" : ", ") + key + " " + unquoted(value.text("from")) + " -> " +
            unquoted(value.text("to"));
  }
  return text;
}

Cell cell(const std::optional<double>& value) { return value ? Cell(*value) : Cell(); }

}  // namespace

Table helps_table(const RunJson& run) {
  Table table("what_helps", "What would make the frame shorter",
              {{"step", ColumnType::text, "", "what is changed, and nothing else"},
               {"saved", ColumnType::real, "fraction", "of the frame time; empty: not replayed"},
               {"most_saved", ColumnType::real, "fraction", "more cannot be saved, by the nodes' own work"},
               {"price", ColumnType::real, "1", "of the step, by [prices]"},
               {"at_best", ColumnType::text, "", "the same resource as if it cost nothing"},
               {"saved_at_best", ColumnType::real, "fraction", "of the frame time; empty: not replayed"}});
  for (const RunJson& resource : run.list("machine.what_helps.resources")) {
    const RunJson step(resource.find("step"), run.file());
    const RunJson best(resource.find("best"), run.file());
    table.add_row({keys_text(step), cell(step.number("saved")), cell(step.number("most_saved")),
                   cell(step.number("price")), keys_text(best), cell(best.number("saved"))});
  }
  return table;
}

}  // namespace marti::studies
