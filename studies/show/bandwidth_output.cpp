#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <string_view>

#include "studies/show/result_parts.h"
#include "studies/tables/text_units.h"

namespace marti::studies::show {

namespace {

constexpr double giga = 1e9;

// Bytes a second that so many links move at most; 0 where data take no time, and without links.
double peak_of(const sim::Clock& clock, std::uint32_t width, std::int64_t cycles_per_beat,
               std::int64_t links) {
  const auto beat = static_cast<double>(clock.cycles(cycles_per_beat));
  return beat > 0.0 ? static_cast<double>(sim::ticks_per_second) * width * static_cast<double>(links) / beat
                    : 0.0;
}

// What the figures "<whose>_share_<part>" say, which add up to the whole; empty if nothing has links.
std::string line_of(const run::RunResult& r, const std::string& whose, double peak,
                    std::span<const std::string_view> parts) {
  if (!r.figure(whose + "_share_no_request")) {
    return {};
  }
  std::string text =
      fmt::format("  {:<12}{:.4g} GB/s", "bandwidth", r.figure(whose + "_bandwidth").value_or(0.0) / giga);
  text += peak > 0.0 ? fmt::format(" of {:.4g}", peak / giga) : std::string();
  std::string_view before = "; ";
  for (const std::string_view part : parts) {
    if (const double share = r.figure(whose + "_share_" + std::string(part)).value_or(0.0); share != 0.0) {
      std::string name(part);
      std::ranges::replace(name, '_', ' ');
      text += fmt::format("{}{} {}", before, name, tables::percent(share));
      before = ", ";
    }
  }
  return text + "\n";
}

}  // namespace

std::string interconnect_bandwidth_line(const run::RunResult& r) {
  const memory::InterconnectConfig& link = r.machine.interconnect;
  constexpr std::array<std::string_view, 4> parts = {"data", "address", "held", "no_request"};
  return line_of(r, "interconnect",
                 peak_of(link.clock, link.width, link.cycles_per_beat, r.count("interconnect_links")), parts);
}

std::string network_bandwidth_line(const run::RunResult& r) {
  const memory::NetworkConfig& link = r.machine.network;
  constexpr std::array<std::string_view, 3> parts = {"data", "latency", "no_request"};
  return line_of(r, "network",
                 peak_of(link.clock, link.width, link.cycles_per_beat, r.count("network_links")), parts);
}

std::string dram_bandwidth_line(const run::RunResult& r) {
  constexpr std::array<std::string_view, 5> parts = {"data", "rows", "refresh", "turn", "no_request"};
  return line_of(r, "dram", r.machine.banks.dram->peak_bandwidth() * r.machine.clusters, parts);
}

}  // namespace marti::studies::show
