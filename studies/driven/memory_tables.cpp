#include "studies/driven/memory_tables.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "processors/energy/energy.h"
#include "studies/tables/provenance.h"

namespace marti::studies::driven {

namespace {

using tables::Cell;
using tables::Table;

// A page has a place for few curves and for so many points of an axis.
constexpr std::size_t most_shown = 8;
constexpr std::size_t most_points = 1000;

double in_nanoseconds(std::int64_t time) { return static_cast<double>(time) / nanosecond; }

bool any(std::span<const Memory> memories, bool (*has)(const Served&)) {
  return std::ranges::any_of(memories, [&](const Memory& memory) { return has(memory.served); });
}
bool has_caches(const Served& served) {
  return served.driven.references.all_hits() + served.driven.references.all_misses() > 0;
}
bool has_energy(const Served& served) { return served.result.timed.energy.has_value(); }
bool has_dram(const Served& served) { return served.result.machine.banks.dram.has_value(); }

// Those that the page shows in detail: of all that there are, in their order, the ones with the fastest
// reads.
std::vector<const Memory*> fastest(std::span<const Memory> memories) {
  std::vector<const Memory*> chosen;
  for (const Memory& memory : memories) {
    chosen.push_back(&memory);
  }
  if (chosen.size() > most_shown) {
    const auto end = chosen.begin() + most_shown;
    std::ranges::stable_sort(chosen, {}, [](const Memory* memory) { return memory->served.mean_latency(); });
    chosen.erase(end, chosen.end());
    std::ranges::sort(chosen);  // they stand in one array
  }
  return chosen;
}

Table axis_table(std::span<const Memory> memories) {
  Table table(
      "memory_axis", "Over the first axis",
      {tables::text_column("value", "of the first axis"),
       tables::text_column("others", "settings of the other axes"),
       tables::text_column("figure", "what is shown"), tables::real_column("number", "", "its value")});
  for (const Memory& memory : memories) {
    if (memory.settings.empty() || memories.size() > most_points) {
      continue;
    }
    std::string others;
    for (std::size_t i = 1; i < memory.settings.size(); ++i) {
      others += (i == 1 ? "" : ", ") + memory.settings[i].first + " = " + memory.settings[i].second;
    }
    const auto add = [&](const char* figure, double number) {
      table.add_row({memory.settings[0].second, others, figure, number});
    };
    add("bandwidth, GB/s", memory.served.bytes_a_second() / giga);
    add("mean latency of reads, ns", memory.served.mean_latency() / nanosecond);
    add("latency of 95 % of the reads, ns", in_nanoseconds(memory.served.latency(late)));
    if (has_energy(memory.served)) {
      add("energy, pJ a byte", memory.served.picojoules_a_byte());
    }
  }
  return table;
}

Table latency_table(std::span<const Memory* const> memories) {
  Table table(
      "memory_latency", "Latencies of reads",
      {tables::text_column("memory", "its settings"), tables::real_column("at_least", "ns", "latency"),
       tables::real_column("at_most", "ns", "latency"), tables::count_column("reads", "that took so long"),
       tables::real_column("share", "fraction", "reads that took at most as long")});
  for (const Memory* const memory : memories) {
    std::int64_t so_far = 0;
    for (const sim::LogHistogram::Bucket& bucket : memory->served.driven.latency.histogram.buckets()) {
      so_far += bucket.count;
      table.add_row({memory->name(), in_nanoseconds(bucket.lowest), in_nanoseconds(bucket.highest),
                     bucket.count,
                     static_cast<double>(so_far) / static_cast<double>(memory->served.driven.latency.count)});
    }
  }
  return table;
}

Table bandwidth_table(std::span<const Memory* const> memories) {
  Table table(
      "memory_bandwidth", "What the time of links and data buses is spent on",
      {tables::text_column("memory", "its settings"), tables::text_column("what", "interconnect or dram"),
       tables::text_column("part", "data, or what keeps them from moving data"),
       tables::real_column("share", "fraction", "of the time")});
  constexpr std::array<std::string_view, 9> shares = {
      "interconnect_share_data", "interconnect_share_address",
      "interconnect_share_held", "interconnect_share_no_request",
      "dram_share_data",         "dram_share_rows",
      "dram_share_refresh",      "dram_share_turn",
      "dram_share_no_request"};
  constexpr std::string_view between = "_share_";
  for (const Memory* const memory : memories) {
    for (const std::string_view figure : shares) {
      const std::optional<double> share = memory->served.result.figure(figure);
      if (share && *share > 0.0) {
        const std::size_t at = figure.find(between);
        table.add_row({memory->name(), figure.substr(0, at), figure.substr(at + between.size()), *share});
      }
    }
  }
  return table;
}

Table rows_table(std::span<const Memory* const> memories) {
  Table table(
      "memory_rows", "Rows of DRAM that bursts find",
      {tables::text_column("memory", "its settings"),
       tables::text_column("found", "open: their row, none: no row, another: another row that is open"),
       tables::count_column("bursts", "that find it so"),
       tables::real_column("share", "fraction", "of all bursts")});
  for (const Memory* const memory : memories) {
    const run::RunResult& result = memory->served.result;
    const std::array<std::pair<const char*, std::int64_t>, 3> found = {
        {{"open", result.count("dram_row_hits")},
         {"none", result.count("dram_row_misses")},
         {"another", result.count("dram_row_conflicts")}}};
    const std::int64_t all = found[0].second + found[1].second + found[2].second;
    for (const auto& [name, bursts] : found) {
      if (all > 0) {
        table.add_row({memory->name(), name, bursts, static_cast<double>(bursts) / static_cast<double>(all)});
      }
    }
  }
  return table;
}

// By Little's law the mean length of a queue is the sum of its waits by the time.
Table queue_table(std::span<const Memory* const> memories) {
  Table table(
      "memory_queue", "Who waits",
      {tables::text_column("memory", "its settings"),
       tables::text_column("queue",
                           "of the interconnect, the banks, or accesses of DRAM with their commands to come"),
       tables::real_column("length", "1", "mean number that wait"),
       tables::real_column("wait", "ns", "mean, those of no length included; not known of DRAM")});
  for (const Memory* const memory : memories) {
    const run::RunResult& result = memory->served.result;
    const auto end = static_cast<double>(result.timed.end);
    const auto add = [&](const char* queue, const char* sum, std::optional<double> mean) {
      const std::optional<figures::Count> all = figures::count_of(result.counts, sum);
      if (all && end > 0.0) {
        table.add_row({memory->name(), queue, static_cast<double>(*all) / end,
                       mean ? Cell(*mean / nanosecond) : Cell()});
      }
    };
    add("interconnect", "interconnect_wait_sum", result.figure("mean_interconnect_wait"));
    add("banks", "bank_wait_sum", result.figure("mean_bank_wait"));
    add("dram", "dram_queued", std::nullopt);
  }
  return table;
}

Table energy_table(std::span<const Memory* const> memories) {
  Table table("memory_energy", "Energy by part",
              {tables::text_column("memory", "its settings"), tables::text_column("part", "of the memory"),
               tables::real_column("energy", "nJ", "for the whole trace")});
  constexpr double femtojoules = 1e6;  // of a nJ
  constexpr auto counters = processors::energy::EnergyResult::counters();
  for (const Memory* const memory : memories) {
    for (std::size_t i = 0; has_energy(memory->served) && i < processors::energy::energy_parts; ++i) {
      const std::int64_t part = (*memory->served.result.timed.energy).*counters[i].member;
      if (part > 0) {
        table.add_row({memory->name(), counters[i].name, static_cast<double>(part) / femtojoules});
      }
    }
  }
  return table;
}

}  // namespace

std::string Memory::name() const {
  std::string text;
  for (const auto& [key, value] : settings) {
    text += (text.empty() ? "" : ", ") + key + " = " + value;
  }
  return text.empty() ? "the memory" : text;
}

Table memories_table(std::span<const Memory> memories) {
  std::vector<tables::Column> columns;
  for (const auto& setting : memories.front().settings) {
    columns.push_back(tables::text_column(setting.first, "a setting"));
  }
  const bool caches = any(memories, has_caches);
  const bool energy = any(memories, has_energy);
  const bool dram = any(memories, has_dram);
  columns.push_back(tables::real_column("bandwidth", "GB/s", "what was asked for in the time it took"));
  columns.push_back(tables::real_column("latency", "ns", "of reads, mean"));
  columns.push_back(tables::real_column("latency_95", "ns", "of 95 % of the reads at most"));
  columns.push_back(tables::real_column("latency_max", "ns", "of a read at most"));
  columns.push_back(tables::real_column("end", "us", "when the last request was served"));
  if (caches) {
    columns.push_back(tables::real_column("hit_ratio", "fraction", "hits of the private caches"));
  }
  if (dram) {
    columns.push_back(
        tables::real_column("dram_row_hit_ratio", "fraction", "bursts that find their row open"));
  }
  if (energy) {
    columns.push_back(
        tables::real_column("energy", "pJ/B", "of caches, interconnect and memory, a byte asked for"));
  }
  Table table("memories", "A trace served by each memory", std::move(columns));
  for (const Memory& memory : memories) {
    const Served& served = memory.served;
    std::vector<Cell> row;
    for (const auto& setting : memory.settings) {
      row.emplace_back(setting.second);
    }
    row.insert(row.end(), {served.bytes_a_second() / giga, served.mean_latency() / nanosecond,
                           in_nanoseconds(served.latency(late)), in_nanoseconds(served.driven.latency.max),
                           in_nanoseconds(served.result.timed.end) / 1e3});
    if (caches) {
      row.emplace_back(served.hit_ratio());
    }
    if (dram) {
      row.emplace_back(served.result.figure("dram_row_hit_ratio"));
    }
    if (energy) {
      row.push_back(has_energy(served) ? Cell(served.picojoules_a_byte()) : Cell());
    }
    table.add_row(std::move(row));
  }
  return table;
}

std::vector<Table> page_tables(std::span<const Memory> memories, std::span<const std::string> answer) {
  const std::vector<const Memory*> shown = fastest(memories);
  std::vector<Table> all = {tables::answer_table("memory_answer", "Answer", answer),
                            memories_table(memories)};
  for (Table& table : std::array{axis_table(memories), latency_table(shown), bandwidth_table(shown),
                                 rows_table(shown), queue_table(shown), energy_table(shown)}) {
    if (!table.rows().empty()) {
      all.push_back(std::move(table));
    }
  }
  all.push_back(tables::provenance_table(memories.front().served.result.values));
  return all;
}

}  // namespace marti::studies::driven
