#include "studies/run/record/interval_figures.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <span>
#include <string>
#include <utility>

#include "sim/error.h"
#include "sim/key_error.h"
#include "sim/units.h"

namespace marti::studies::run {

namespace {

using figures::FigureEntry;
using processors::walk::node_state_names;

std::span<const FigureEntry> counted_entries() { return figures::counted_figures(); }

// Whether a figure is counted little by little. The times of nodes are completed after the frame, and are
// told by the pieces of their time instead.
bool adds_up(const FigureEntry& entry) {
  return entry.merge == figures::Merge::sum && entry.of_machine() && !entry.name.starts_with("time_") &&
         entry.name != "node_finish";
}

// Whether a figure says something of an interval that it does not say of all. Shares of the nodes' times are
// told by the pieces of their time, too.
bool is_of_intervals(const FigureEntry& derived) {
  return derived.name != "area" && derived.name != "energy_delay" && derived.name != "saturation" &&
         !derived.name.starts_with("share_") && !derived.formula->is_relative();
}

}  // namespace

std::span<const std::size_t> counted_in_intervals() {
  static const std::vector<std::size_t> places = [] {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < counted_entries().size(); ++i) {
      if (adds_up(counted_entries()[i])) {
        found.push_back(i);
      }
    }
    return found;
  }();
  return places;
}

std::span<const FigureEntry> derived_in_intervals() {
  static const std::vector<FigureEntry> entries = [] {
    std::vector<FigureEntry> found;
    std::ranges::copy_if(figures::derived_figures(), std::back_inserter(found), is_of_intervals);
    return found;
  }();
  return entries;
}

IntervalFigures::IntervalFigures(const processors::machine::MachineConfig& machine, sim::Ticks length)
    : machine_(machine),
      length_(length),
      asked_{length, [this](const processors::replay::MachineResult& result) { counted(result); }} {}

void IntervalFigures::require(std::size_t intervals) const {
  if (intervals > most_intervals) {
    throw sim::KeyError("record.interval", "the frame takes more than " + std::to_string(most_intervals) +
                                               " intervals of " + sim::print_duration(length_) +
                                               "; make them longer");
  }
}

void IntervalFigures::spent(std::uint32_t /*node*/, processors::walk::NodeState state, sim::Ticks from,
                            sim::Ticks to, processors::walk::PixelPlace /*pixel*/) {
  while (from < to) {
    const auto interval = static_cast<std::size_t>(from / length_);
    if (interval >= states_.size()) {
      require(interval + 1);
      states_.resize(interval + 1);
    }
    // Up to the end of the interval, or of the piece.
    const sim::Ticks part = std::min(to - from, length_ - from % length_);
    states_[interval][static_cast<std::size_t>(state)] += part;
    from += part;
  }
}

void IntervalFigures::counted(const processors::replay::MachineResult& result) {
  require(so_far_.size());
  so_far_.push_back(figures::counts_of(machine_, result));
}

std::vector<bool> IntervalFigures::growing(const figures::Counts& whole) const {
  std::vector<bool> grows(counted_entries().size());
  for (std::size_t i = 0; i < counted_entries().size(); ++i) {
    const bool known =
        std::ranges::all_of(so_far_, [i](const figures::Counts& counts) { return counts[i].has_value(); });
    grows[i] = known && whole[i] && adds_up(counted_entries()[i]) && so_far_.front()[i] != whole[i];
  }
  return grows;
}

std::vector<figures::Counts> IntervalFigures::counts_of_each(const figures::Counts& whole,
                                                             const std::vector<bool>& grows) const {
  std::vector<figures::Counts> rows(states_.size(), figures::Counts(counted_entries().size()));
  for (std::size_t i = 0; i < counted_entries().size(); ++i) {
    const FigureEntry& entry = counted_entries()[i];
    if (!grows[i]) {
      // What is so of the machine all the time: links, banks, area.
      const bool constant = adds_up(entry) || entry.name == "nodes" || entry.name == "clusters";
      for (std::size_t row = 0; constant && row < rows.size(); ++row) {
        rows[row][i] = whole[i];
      }
      continue;
    }
    figures::Count before = 0;
    for (std::size_t row = 0; row < rows.size(); ++row) {
      const figures::Count after = row + 1 < rows.size() ? *so_far_[row + 1][i] : *whole[i];
      rows[row][i] = after - std::exchange(before, after);
    }
  }
  for (std::size_t row = 0; row < rows.size(); ++row) {
    rows[row][0] = std::min<figures::Count>(*whole[0], figures::Count{length_} * (row + 1)) -
                   figures::Count{length_} * row;
  }
  return rows;
}

std::vector<IntervalRow> IntervalFigures::rows(const figures::Counts& whole) const {
  const figures::Count nodes = *figures::count_of(whole, "nodes");
  sim::ensure(
      counted_entries()[0].name == "end" && so_far_.size() >= std::max<std::size_t>(states_.size(), 1),
      "an interval was not looked at");
  const std::vector<bool> grows = growing(whole);
  std::vector<figures::Counts> counts = counts_of_each(whole, grows);
  std::vector<IntervalRow> rows(counts.size());
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const sim::Ticks from = length_ * static_cast<sim::Ticks>(row);
    rows[row] = {from, from + static_cast<sim::Ticks>(*counts[row][0]), states_[row], std::move(counts[row])};
    for (std::size_t i = 0; i < grows.size(); ++i) {
      if (!grows[i]) {
        rows[row].counts[i].reset();
      }
    }
    sim::ensure(std::accumulate(states_[row].begin(), states_[row].end(), sim::Sum{0}) ==
                    (rows[row].to - from) * nodes,
                "the states of an interval are all of the nodes' time");
  }
  return rows;
}

tables::Table IntervalFigures::table(const figures::Counts& whole) const {
  const figures::Count nodes = *figures::count_of(whole, "nodes");
  const std::vector<IntervalRow> of_each = this->rows(whole);
  const std::vector<bool> grows = growing(whole);
  const std::vector<figures::Counts> rows = counts_of_each(whole, grows);

  std::vector<tables::Column> columns = {
      tables::integer_column("from_ps", "ps", "begin of the interval"),
      tables::integer_column("to_ps", "ps",
                             "end of the interval: the next one's begin, or that of the frame")};
  std::vector<std::vector<tables::Cell>> cells(rows.size());
  for (std::size_t row = 0; row < rows.size(); ++row) {
    cells[row] = {of_each[row].from, of_each[row].to};
  }
  const auto add = [&](tables::Column column, const auto& value_of) {
    columns.push_back(std::move(column));
    for (std::size_t row = 0; row < rows.size(); ++row) {
      cells[row].emplace_back(value_of(row));
    }
  };
  for (std::size_t state = 0; state < node_state_names.size(); ++state) {
    if (std::ranges::all_of(states_, [state](const States& of) { return of[state] == 0; })) {
      continue;
    }
    const std::string name(node_state_names[state]);
    add(tables::integer_column("spent_" + name, "ps", "time that nodes were in this state (observing.md)"),
        [&](std::size_t row) { return states_[row][state]; });
    add(tables::real_column("share_" + name, "fraction", "share of the nodes' time in this state"),
        [&](std::size_t row) {
          return static_cast<double>(states_[row][state]) /
                 (static_cast<double>(nodes) * static_cast<double>(*rows[row][0]));
        });
  }
  for (std::size_t i = 0; i < counted_entries().size(); ++i) {
    if (grows[i]) {
      add(tables::integer_column(counted_entries()[i].name, counted_entries()[i].unit,
                                 counted_entries()[i].description),
          [&](std::size_t row) { return rows[row][i]; });
    }
  }
  for (const FigureEntry& entry : derived_in_intervals()) {
    const auto value_in = [&](const auto& counts) { return figures::figure_of({&counts}, entry.name); };
    const auto value_of = [&](std::size_t row) { return value_in(rows[row]); };
    if (std::ranges::any_of(rows, [&](const auto& counts) { return value_in(counts).has_value(); })) {
      add(tables::real_column(entry.name, entry.unit, entry.description), value_of);
    }
  }
  tables::Table table("intervals", "What the machine did in each interval of the frame", std::move(columns));
  for (std::vector<tables::Cell>& row : cells) {
    table.add_row(std::move(row));
  }
  return table;
}

}  // namespace marti::studies::run
