// The configuration keys of [prices]: what the parts of a machine cost.
#pragma once

#include <optional>
#include <string>

#include "sim/config.h"
#include "sim/schema.h"
#include "studies/keys/machine_cost.h"

namespace marti::studies::keys {

/// The schema must have [prices] as a free section.
void declare_price_keys(sim::Schema& schema);

/// Throws UserError for an unknown key of [prices].
[[nodiscard]] Prices read_prices(const sim::Config& config);

/// As read_prices(), if any price is given; else no key is read.
[[nodiscard]] std::optional<Prices> read_given_prices(const sim::Config& config);

/// "prices.node = 1, prices.bank = 0.5, ...".
[[nodiscard]] std::string text_of(const Prices& prices);

}  // namespace marti::studies::keys
