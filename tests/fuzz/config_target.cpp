#include <string>
#include <string_view>
#include <vector>

#include "refusal.h"
#include "sim/error.h"
#include "studies/error/error_keys.h"
#include "studies/keys/frame_keys.h"
#include "studies/keys/machine_keys.h"
#include "studies/keys/price_keys.h"
#include "studies/keys/record_keys.h"
#include "studies/run/run_result.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "studies/sweep/plan/sweep_points.h"
#include "studies/sweep/plan/sweep_table.h"
#include "target.h"

namespace marti::fuzz {

namespace {

std::vector<sim::EffectiveValue> read_run(std::string_view text) {
  static const sim::Schema schema = studies::run::run_schema();
  sim::Config config = sim::Config::from_text(schema, text, "fuzz.toml");
  (void)studies::keys::read_frame(config);
  (void)studies::keys::read_machine(config);
  (void)studies::keys::read_record(config, true);
  config.refuse_unused();
  return config.effective_values();
}

void read_error_study(std::string_view text) {
  static const sim::Schema schema = studies::error::error_schema();
  sim::Config config = sim::Config::from_text(schema, text, "fuzz.toml");
  (void)studies::error::read_error(config);
}

void read_sweep(std::string_view text) {
  static const sim::Schema schema = studies::sweep::sweep_schema();
  const sim::Config config = sim::Config::from_text(schema, text, "fuzz.toml");
  const studies::sweep::SweepTable table = studies::sweep::read_sweep_table(config);
  promise(!table.axes.empty(), "a sweep without an axis");
  const std::uint64_t points = studies::sweep::SweepPoints(config, table).size();
  promise(points >= 1 && points <= studies::sweep::most_sweep_points, "too many points");
  (void)studies::keys::read_prices(config);
}

// Calls `read`; returns whether its input was accepted.
template <class Read>
bool accepted(const Read& read) {
  try {
    read();
    return true;
  } catch (const sim::UserError& error) {
    (void)refusal_of(error.what(), "fuzz.toml");
    return false;
  }
}

}  // namespace

void try_config(std::span<const std::uint8_t> bytes) {
  const std::string text(bytes.begin(), bytes.end());
  std::vector<sim::EffectiveValue> values;
  if (accepted([&] { values = read_run(text); })) {
    std::string again;
    for (const sim::EffectiveValue& value : values) {
      if (value.given) {
        again += value.key + " = " + value.value + "\n";
      }
    }
    const std::vector<sim::EffectiveValue> reread = read_run(again);
    promise(values.size() == reread.size(), "other keys are used when read again");
    for (std::size_t i = 0; i < values.size(); ++i) {
      promise(values[i].key == reread[i].key && values[i].value == reread[i].value,
              values[i].key + " = " + values[i].value + " is read again as " + reread[i].value);
    }
  }
  if (text.find("error") != std::string::npos) {
    (void)accepted([&] { read_error_study(text); });
  }
  if (text.find("sweep") != std::string::npos) {
    (void)accepted([&] { read_sweep(text); });
  }
}

}  // namespace marti::fuzz
