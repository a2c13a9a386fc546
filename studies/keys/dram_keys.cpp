#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "memory/dram_mapping.h"
#include "memory/dram_presets.h"
#include "sim/error.h"
#include "studies/keys/key_parts.h"
#include "studies/keys/machine_sections.h"

namespace marti::studies::keys {

namespace {

using memory::DramConfig;
using memory::DramTiming;

enum class Model : std::uint8_t { fixed, dram };

struct TimeKey {
  std::string_view key;
  std::int64_t DramTiming::*member;
  std::string_view meaning;
};

constexpr std::array times = std::to_array<TimeKey>({
    {"dram.tbl", &DramTiming::bl, "cycles for which one burst has the data bus"},
    {"dram.tcl", &DramTiming::cl, "cycles from a read command to its first data"},
    {"dram.tcwl", &DramTiming::cwl, "cycles from a write command to its first data"},
    {"dram.trcd", &DramTiming::rcd, "cycles from an activation to a read of the row"},
    {"dram.trcd_write", &DramTiming::rcd_write, "cycles from an activation to a write of the row"},
    {"dram.trp", &DramTiming::rp, "cycles from a precharge to an activation of the bank"},
    {"dram.tras", &DramTiming::ras, "cycles from an activation to a precharge of the bank"},
    {"dram.trc", &DramTiming::rc, "cycles from an activation to the next one of the bank"},
    {"dram.trrd_s", &DramTiming::rrd_s, "cycles between activations of two bank groups"},
    {"dram.trrd_l", &DramTiming::rrd_l, "cycles between activations of one bank group"},
    {"dram.tfaw", &DramTiming::faw, "cycles in which a rank may have four activations"},
    {"dram.tccd_s", &DramTiming::ccd_s, "cycles between two reads, or two writes, of two bank groups"},
    {"dram.tccd_l", &DramTiming::ccd_l, "cycles between two reads of one bank group"},
    {"dram.tccd_l_write", &DramTiming::ccd_l_write, "cycles between two writes of one bank group"},
    {"dram.tccd_stack", &DramTiming::ccd_stack, "cycles between two reads of two stacks of a rank"},
    {"dram.twr", &DramTiming::wr, "cycles from the last data written to a precharge"},
    {"dram.twtr_s", &DramTiming::wtr_s, "cycles from the last data written to a read of another bank group"},
    {"dram.twtr_l", &DramTiming::wtr_l, "cycles from the last data written to a read of the same bank group"},
    {"dram.trtp", &DramTiming::rtp, "cycles from a read to a precharge"},
    {"dram.tppd", &DramTiming::ppd, "cycles between two precharges of a rank"},
    {"dram.trefi", &DramTiming::refi, "cycles between two refreshes; 0: no refresh"},
    {"dram.trfc", &DramTiming::rfc, "cycles of one refresh"},
});

struct CountKey {
  std::string_view key;
  std::uint32_t DramConfig::*member;
  std::int64_t most;
  std::string_view meaning;
};

constexpr std::array counts = std::to_array<CountKey>({
    {"dram.channels", &DramConfig::channels, 256, "channels, each with buses of its own"},
    {"dram.ranks", &DramConfig::ranks, 64, "ranks of a channel"},
    {"dram.stacks", &DramConfig::stacks, 64, "groups of dies of a rank, as the stack IDs of HBM3"},
    {"dram.bank_groups", &DramConfig::bank_groups, 64, "bank groups of a stack"},
    {"dram.banks", &DramConfig::banks, 64, "banks of a bank group"},
    {"dram.rows", &DramConfig::rows, 1 << 24, "rows of a bank"},
});

constexpr std::array sizes = std::to_array<CountKey>({
    {"dram.row", &DramConfig::row_bytes, 0, "bytes of a row, over all devices of a rank"},
    {"dram.burst", &DramConfig::burst_bytes, 0, "bytes that one read or write command moves"},
});

void read_preset(const sim::Config& config, DramConfig& dram) {
  dram = memory::dram_preset(config.choice("dram.preset"));
  if (const std::int64_t period = config.integer("dram.tck"); period > 0) {
    dram.period = period;
  }
  for (const CountKey& count : counts) {
    if (const std::int64_t given = config.integer(count.key); given > 0) {
      dram.*count.member = static_cast<std::uint32_t>(given);
    }
  }
  for (const CountKey& size : sizes) {
    if (const std::int64_t given = config.size(size.key); given > 0) {
      dram.*size.member = static_cast<std::uint32_t>(given);
    }
  }
  for (const TimeKey& time : times) {
    if (const std::int64_t given = config.integer(time.key); given >= 0) {
      dram.timing.*time.member = given;
    }
  }
}

void read_controller(sim::Config& config, DramConfig& dram) {
  dram.policy = config.choice_as<memory::DramPolicy>("dram.policy");
  dram.page = config.choice_as<memory::DramPage>("dram.page");
  if (dram.policy == memory::DramPolicy::frfcfs) {
    dram.queue = count(config, "dram.queue");
    dram.reorder_cap = count(config, "dram.reorder_cap");
  }
  dram.mapping.clear();
  for (const std::string& text : config.texts("dram.mapping")) {
    try {
      dram.mapping.push_back(memory::parse_dram_field(text));
    } catch (const sim::UserError& error) {
      config.fail("dram.mapping", error.what());
    }
  }
}

}  // namespace

void declare_memory_model(sim::Schema& schema) {
  schema.choice(
      "memory.model", "fixed", {"fixed", "dram"},
      "fixed: banks whose every access takes the same time; dram: channels of DRAM, whose banks have "
      "open rows ([dram])");
}

void declare_dram_keys(sim::Schema& schema) {
  schema.section("dram", "the DRAM of a cluster's shared memory, with memory.model = \"dram\"");
  schema.choice("dram.preset", memory::dram_preset_names[0], names(memory::dram_preset_names),
                "the memory whose times and counts are taken where the keys below do not give others");
  schema.choice("dram.policy", memory::dram_policy_names[0], names(memory::dram_policy_names),
                "fcfs: first come, first served; frfcfs: the oldest access whose next command is allowed");
  schema.choice("dram.page", memory::dram_page_names[0], names(memory::dram_page_names),
                "open: a row stays open until its bank needs another; closed: each access closes its row");
  schema.integer("dram.queue", 32, {1, 1024}, "",
                 "frfcfs: bursts read, and as many written, that a channel chooses from");
  schema.integer("dram.reorder_cap", 16, {0, 1'000'000}, "",
                 "frfcfs: younger bursts that may go before one; 0: any number");
  schema.texts(
      "dram.mapping", {"column", "channel", "rank", "bank_group", "bank", "row"},
      "the fields of an address above a burst, from the lowest bits upwards; \"column:3\" is three of "
      "a field's bits, and the rest may come later; \"stack\" may be left out and then follows the rank");
  schema.integer("dram.tck", -1, {-1, 1'000'000}, "ps",
                 "one cycle of the DRAM's clock; -1 or 0: the preset's");
  for (const CountKey& count : counts) {
    schema.integer(count.key, 0, {0, count.most}, "",
                   std::string(count.meaning) + ", a power of two; 0: the preset's");
  }
  for (const CountKey& size : sizes) {
    schema.size(size.key, "0 B", {"0 B", "64 KiB"},
                std::string(size.meaning) + ", a power of two; 0: the preset's");
  }
  for (const TimeKey& time : times) {
    schema.integer(time.key, -1, {-1, 1'000'000}, "cycles", std::string(time.meaning) + "; -1: the preset's");
  }
}

void read_memory(sim::Config& config, processors::machine::MachineConfig& machine) {
  if (config.choice_as<Model>("memory.model") == Model::fixed) {
    machine.banks.count = count(config, "memory.banks");
    machine.banks.clock = clock(config, "memory.clock");
    machine.banks.access_cycles = config.integer("memory.access_cycles");
    machine.banks.busy_cycles = config.integer("memory.busy_cycles");
    config.mark_unused_reason("dram", "it has no effect without memory.model = \"dram\"", "memory.model");
    return;
  }
  DramConfig& dram = machine.banks.dram.emplace();
  read_preset(config, dram);
  read_controller(config, dram);
  config.mark_unused_reason("dram.queue", "only dram.policy = \"frfcfs\" has a queue to choose from",
                            "dram.policy");
  config.mark_unused_reason("dram.reorder_cap", "only dram.policy = \"frfcfs\" changes the order",
                            "dram.policy");
  config.mark_unused_reason("memory", "a memory of DRAM has its times and banks from [dram]", "memory.model");
}

}  // namespace marti::studies::keys
