#include "studies/keys/record_keys.h"

#include <optional>
#include <string>

#include "sim/units.h"

namespace marti::studies::keys {

void declare_record_keys(sim::Schema& schema) {
  schema.section("record", "what `marti run` records beside the result, in the directory of -o");
  schema.boolean("record.timeline", false,
                 "write timeline.json, what each node does when, for Perfetto (https://ui.perfetto.dev)");
  schema.duration("record.timeline_from", "0 ps", {"0 ps", std::nullopt},
                  "timeline: simulated time from which it shows the nodes");
  schema.duration("record.timeline_to", "0 ps", {"0 ps", std::nullopt},
                  "timeline: simulated time up to which it shows them; 0: to the end of the frame");
  schema.integer(
      "record.timeline_events", 1'000'000, {1, 1'000'000'000}, "slices",
      "timeline: slices of nodes written at most, of about 120 bytes each, and as many of the critical "
      "path; the rest is left out");
  schema.boolean(
      "record.heat_maps", false,
      "write what each pixel cost: heat.exr and three maps in false colours, of cycles, misses and "
      "waits");
  schema.duration("record.interval", "0 ps", {"0 ps", std::nullopt},
                  "write what the machine counts in each interval of this length, energy among it; the frame "
                  "must not have more than 1000 of them; 0: not asked for");
  schema.boolean(
      "record.critical_path", false,
      "find the chain of computing, transfers, messages, bank accesses and dispatches that sets the end of "
      "the frame (docs/internals/model.md)");
}

RecordConfig read_record(sim::Config& config, bool has_directory) {
  RecordConfig record;
  record.timeline = config.boolean("record.timeline");
  record.heat_maps = config.boolean("record.heat_maps");
  record.critical_path = config.boolean("record.critical_path");
  record.interval = config.duration("record.interval");
  for (const char* key : {"record.timeline", "record.heat_maps"}) {
    if (!has_directory && config.boolean(key)) {
      config.fail(key, "is written to a directory, which `marti run` has with -o");
    }
  }
  if (!record.timeline) {
    for (const char* key : {"record.timeline_from", "record.timeline_to", "record.timeline_events"}) {
      config.mark_unused_reason(key, "it has no effect with record.timeline = false", "record.timeline");
    }
    return record;
  }
  run::TimelineOptions& options = record.timeline_options;
  options.from = config.duration("record.timeline_from");
  options.most_events = config.integer("record.timeline_events");
  if (const sim::Ticks to = config.duration("record.timeline_to"); to != 0) {
    options.to = to;
  }
  if (options.from >= options.to) {
    config.fail("record.timeline_from",
                "must lie before record.timeline_to = " + sim::print_duration(options.to));
  }
  return record;
}

}  // namespace marti::studies::keys
