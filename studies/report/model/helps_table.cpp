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

}  // namespace

tables::Table helps_table(const tables::RunJson& run) {
  tables::Table table(
      "what_helps", "What would make the frame shorter",
      {tables::text_column("step", "what is changed, and nothing else"),
       tables::real_column("saved", "fraction", "of the frame time; empty: not replayed"),
       tables::real_column("most_saved", "fraction", "more cannot be saved, by the nodes' own work"),
       tables::real_column(
           "price", "1",
           "of the step, by [prices]; smaller packets, regions and another way of building cost nothing"),
       tables::text_column("at_best", "the same resource as if it cost nothing"),
       tables::real_column("saved_at_best", "fraction", "of the frame time; empty: not replayed")});
  for (const tables::RunJson& resource : run.list("machine.what_helps.resources")) {
    const tables::RunJson step = resource.part("step");
    const tables::RunJson best = resource.part("best");
    table.add_row({keys_text(step), step.number("saved"), step.number("most_saved"), step.number("price"),
                   keys_text(best), best.number("saved")});
  }
  return table;
}

}  // namespace marti::studies::report
