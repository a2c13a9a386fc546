#include "studies/sweep/plan/sweep_keys.h"

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/config_errors.h"
#include "sim/nearest.h"
#include "studies/keys/record_keys.h"
#include "studies/run/run_result.h"

namespace marti::studies {

namespace {

struct PriceKey {
  std::string_view name;
  double Prices::*member;
  std::string_view meaning;
};

// In no currency: a node costs 1.
constexpr std::array<PriceKey, 8> price_keys = {{
    {"prices.cluster", &Prices::cluster, "of a cluster, beside what is in it"},
    {"prices.node", &Prices::node, "of a node without its caches"},
    {"prices.context", &Prices::context, "of each context of a node beyond the first"},
    {"prices.cache_kib", &Prices::cache_kib, "of a KiB of first-level cache, in every node"},
    {"prices.l2_kib", &Prices::l2_kib,
     "of a KiB of second-level cache, in every node or once in each cluster"},
    {"prices.interconnect_byte", &Prices::interconnect_byte,
     "of a byte of the interconnect's width, in each cluster; of a crossbar, for each bank"},
    {"prices.network_byte", &Prices::network_byte,
     "of a byte of the network's width, for each node, where there is a network"},
    {"prices.bank", &Prices::bank, "of a bank of shared memory"},
}};

}  // namespace

void declare_sweep_keys(sim::Schema& schema) {
  schema.text("sweep.filter", "",
              "which points are timed: an expression over keys, as \"cache.size * machine.nodes <= 1 MiB and "
              "cache.ways <= 8\"; empty: all");
  schema.boolean("sweep.skip_invalid", false,
                 "leave out points whose machine cannot be built, instead of refusing the sweep");
  const Prices defaults;
  for (const PriceKey& key : price_keys) {
    schema.real(key.name, defaults.*key.member, {0.0, 1e12}, "", key.meaning);
  }
}

sim::Schema sweep_schema() {
  sim::Schema schema = run_schema();
  declare_sweep_keys(schema);
  return schema;
}

Prices read_prices(const sim::Config& config) {
  if (const sim::DocumentValue::Table& unknown = config.free_section("prices"); !unknown.empty()) {
    std::vector<std::string> names;
    for (const PriceKey& key : price_keys) {
      names.emplace_back(key.name);
    }
    const std::string name = "prices." + unknown.front().name;
    sim::fail_at(config, unknown.front().line, name,
                 "unknown key" + sim::did_you_mean(name, names) + "; `marti config` lists all keys");
  }
  Prices prices;
  for (const PriceKey& key : price_keys) {
    prices.*key.member = config.real(key.name);
  }
  return prices;
}

void refuse_records(sim::Config& config) {
  for (const std::string_view key : {"record.timeline", "record.heat_maps"}) {
    if (config.boolean(key)) {
      config.fail(key, "a sweep records nothing beside its counters; leave it out, or use `marti run`");
    }
  }
  (void)read_record(config, true);
  if (config.boolean("count.working_set")) {
    config.fail("count.working_set", "a sweep keeps no working sets; leave it out, or use `marti run`");
  }
}

}  // namespace marti::studies
