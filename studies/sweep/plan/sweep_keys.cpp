#include "studies/sweep/plan/sweep_keys.h"

#include <string_view>

#include "studies/keys/price_keys.h"
#include "studies/keys/record_keys.h"
#include "studies/run/run_result.h"

namespace marti::studies::sweep {

void declare_sweep_keys(sim::Schema& schema) {
  schema.text("sweep.filter", "",
              "which points are timed: an expression over keys, as \"cache.size * machine.nodes <= 1 MiB and "
              "cache.ways <= 8\"; empty: all");
  schema.boolean("sweep.skip_invalid", false,
                 "leave out points whose machine cannot be built, instead of refusing the sweep");
  keys::declare_price_keys(schema);
}

const sim::Schema& sweep_schema() {
  static const sim::Schema schema = [] {
    sim::Schema keys = run::run_schema();
    declare_sweep_keys(keys);
    return keys;
  }();
  return schema;
}

void refuse_records(sim::Config& config) {
  for (const std::string_view key : {"record.timeline", "record.heat_maps", "record.critical_path"}) {
    if (config.boolean(key)) {
      config.fail(key, "a sweep records nothing beside its counters; leave it out, or use `marti run`");
    }
  }
  (void)keys::read_record(config, true);
  if (config.boolean("count.working_set")) {
    config.fail("count.working_set", "a sweep keeps no working sets; leave it out, or use `marti run`");
  }
}

}  // namespace marti::studies::sweep
