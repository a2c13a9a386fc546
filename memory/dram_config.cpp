#include "memory/dram_config.h"

#include <algorithm>
#include <bit>
#include <string>
#include <utility>

#include "memory/dram_mapping.h"
#include "sim/key_error.h"

namespace marti::memory {

namespace {

[[noreturn]] void refuse(const char* key, const std::string& reason) { throw sim::KeyError(key, reason); }

void check_counts(const DramConfig& config) {
  const std::array<std::pair<const char*, std::uint32_t>, 7> counts = {
      {{"dram.channels", config.channels},
       {"dram.ranks", config.ranks},
       {"dram.bank_groups", config.bank_groups},
       {"dram.banks", config.banks},
       {"dram.rows", config.rows},
       {"dram.row", config.row_bytes},
       {"dram.burst", config.burst_bytes}}};
  for (const auto& [key, count] : counts) {
    if (!std::has_single_bit(count)) {
      refuse(key, "must be a power of two, not " + std::to_string(count));
    }
  }
  constexpr std::uint64_t most_banks = 65536;
  const std::uint64_t banks = std::uint64_t{config.channels} * config.ranks * config.banks_of_rank();
  if (banks > most_banks) {
    refuse("dram.banks", "makes " + std::to_string(banks) + " banks in all channels; at most " +
                             std::to_string(most_banks) + " are simulated");
  }
  if (config.row_bytes < config.burst_bytes) {
    refuse("dram.row", "must be at least one burst, " + std::to_string(config.burst_bytes) + " bytes");
  }
}

void check_timing(const DramConfig& config) {
  const DramTiming& timing = config.timing;
  if (timing.bl == 0) {
    refuse("dram.tbl", "must not be 0");
  }
  // Each rank may have rows to close, and then an access must be possible: from an activation to the next one
  // of the bank.
  const std::int64_t refresh = timing.rfc + std::int64_t{config.ranks} * (timing.rp + 2) + timing.ppd;
  const std::int64_t column = std::max(timing.rtp, std::max(timing.cl, timing.cwl) + timing.bl + timing.wr);
  const std::int64_t access = std::max({timing.rc, timing.ras + timing.rp, timing.faw,
                                        std::max(timing.rcd, timing.rcd_write) + column + timing.rp});
  if (timing.refi > 0 && timing.refi <= refresh + access) {
    refuse("dram.trefi", "must leave time for an access between two refreshes of " +
                             std::to_string(timing.rfc) + " cycles (dram.trfc)");
  }
  if (timing.rrd_l < timing.rrd_s || timing.ccd_l < timing.ccd_s || timing.wtr_l < timing.wtr_s) {
    refuse(timing.rrd_l < timing.rrd_s   ? "dram.trrd_l"
           : timing.ccd_l < timing.ccd_s ? "dram.tccd_l"
                                         : "dram.twtr_l",
           "must not be less than the time for different bank groups");
  }
  if (timing.ccd_s < timing.bl) {
    refuse("dram.tccd_s", "must be at least the " + std::to_string(timing.bl) +
                              " cycles that one burst has the data bus (dram.tbl)");
  }
}

}  // namespace

DramTiming DramConfig::timing_of_commands() const {
  DramTiming times = timing;
  times.rcd += activate_cycles - column_cycles;
  times.rcd_write += activate_cycles - column_cycles;
  times.rp += 1 - activate_cycles;
  times.rfc += 1 - activate_cycles;
  times.ras += activate_cycles - 1;
  times.rtp += column_cycles - 1;
  times.wr += column_cycles - 1;
  return times;
}

double DramConfig::peak_bandwidth() const {
  return static_cast<double>(sim::ticks_per_second) * burst_bytes * channels * (pseudo_channels ? ranks : 1) /
         (static_cast<double>(period) * static_cast<double>(timing.bl));
}

void check(const DramConfig& config, std::uint32_t line) {
  check_counts(config);
  check_timing(config);
  const DramMapping mapping(config);
  if (line > mapping.channel_interleave()) {
    refuse("dram.mapping", "one access of " + std::to_string(line) +
                               " bytes must lie in one channel and one row, but these change every " +
                               std::to_string(mapping.channel_interleave()) +
                               " bytes; put column bits below the other fields");
  }
  if (config.queue == 0) {
    refuse("dram.queue", "must not be 0");
  }
}

}  // namespace marti::memory
