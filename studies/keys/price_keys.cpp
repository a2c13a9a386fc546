#include "studies/keys/price_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/config_errors.h"
#include "sim/joined.h"
#include "sim/mapped.h"
#include "sim/nearest.h"

namespace marti::studies::keys {

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
    {"prices.bank", &Prices::bank, "of a bank of shared memory, or of a DRAM channel"},
}};

}  // namespace

void declare_price_keys(sim::Schema& schema) {
  const Prices defaults;
  for (const PriceKey& key : price_keys) {
    schema.real(key.name, defaults.*key.member, {0.0, 1e12}, "", key.meaning);
  }
}

Prices read_prices(const sim::Config& config) {
  if (const sim::DocumentValue::Table& unknown = config.free_section("prices"); !unknown.empty()) {
    const std::vector<std::string> names =
        sim::mapped(price_keys, [&](const PriceKey& key) { return std::string(key.name); });
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

std::string text_of(const Prices& prices) {
  return sim::joined(sim::mapped(
      price_keys, [&](const PriceKey& key) { return fmt::format("{} = {}", key.name, prices.*key.member); }));
}

std::optional<Prices> read_given_prices(const sim::Config& config) {
  const bool given =
      !config.free_section("prices").empty() ||
      std::ranges::any_of(price_keys, [&](const PriceKey& key) { return config.given(key.name); });
  return given ? std::optional(read_prices(config)) : std::nullopt;
}

}  // namespace marti::studies::keys
