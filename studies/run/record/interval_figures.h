// The figures of a machine by intervals of simulated time: what it counted in each, and how its nodes spent
// it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "processors/replay/replay.h"
#include "processors/walk/observer.h"
#include "studies/figures/counted_figures.h"
#include "studies/figures/derived_figures.h"
#include "studies/tables/table.h"

namespace marti::studies::run {

/// No frame is divided into more.
inline constexpr std::size_t most_intervals = 1000;

/// What a machine did in one interval.
struct IntervalRow {
  sim::Ticks from = 0;
  sim::Ticks to = 0;  ///< the next one's `from`, or the end of the frame
  /// Time that nodes were in each NodeState; together the interval's length times the nodes.
  std::array<sim::Sum, processors::walk::node_states> spent{};
  /// One for each of counted_figures(); only those that grow during the frame have a value.
  figures::Counts counts;
  bool operator==(const IntervalRow&) const = default;
};

/// The places among counted_figures() of those that may grow little by little during a frame.
[[nodiscard]] std::span<const std::size_t> counted_in_intervals();
/// The derived figures that say something of an interval.
[[nodiscard]] std::span<const figures::FigureEntry> derived_in_intervals();

/// Watches a replay, and is told what it has counted. Counts belong to intervals as
/// processors/replay/replay.h says; times of nodes are exact.
class IntervalFigures final : public processors::walk::Observer {
 public:
  /// Intervals of `length`, from 0 on; the last one ends with the frame.
  IntervalFigures(const processors::machine::MachineConfig& machine, sim::Ticks length);
  IntervalFigures(const IntervalFigures&) = delete;
  IntervalFigures& operator=(const IntervalFigures&) = delete;
  IntervalFigures(IntervalFigures&&) = delete;
  IntervalFigures& operator=(IntervalFigures&&) = delete;
  ~IntervalFigures() override = default;

  /// For ReplayOptions::intervals, where this object must also be among the observers.
  [[nodiscard]] const processors::replay::Intervals& asked() const { return asked_; }

  /// Throws KeyError for a frame of more than most_intervals.
  void spent(std::uint32_t node, processors::walk::NodeState state, sim::Ticks from, sim::Ticks to,
             processors::walk::PixelPlace pixel) override;

  /// `whole` are the counts of the finished frame, to which the intervals of each counted figure add up; one
  /// that is what is left of others (time without requests, branches that are not split) may be below 0 in
  /// an interval. Throws InternalError unless the states of each interval add up to its length times the
  /// nodes.
  [[nodiscard]] std::vector<IntervalRow> rows(const figures::Counts& whole) const;

  /// The table "intervals": a row for each interval, with the columns `from_ps` and `to_ps` and then, where
  /// it has values,
  /// - `spent_STATE` and `share_STATE`: the time that nodes were in a NodeState, in ps and of their time
  /// - each counted figure that grows during the frame, under its name
  /// - each derived figure of these, under its name, by the formula of the frame
  [[nodiscard]] tables::Table table(const figures::Counts& whole) const;

 private:
  using States = decltype(IntervalRow::spent);

  void require(std::size_t intervals) const;
  void counted(const processors::replay::MachineResult& result);
  // Which counted figures grow during the frame.
  [[nodiscard]] std::vector<bool> growing(const figures::Counts& whole) const;
  // What each interval counted of the figures that grow, its length as `end`, and the figures that have one
  // value all the time.
  [[nodiscard]] std::vector<figures::Counts> counts_of_each(const figures::Counts& whole,
                                                            const std::vector<bool>& grows) const;

  const processors::machine::MachineConfig& machine_;
  sim::Ticks length_;
  std::vector<States> states_;
  std::vector<figures::Counts> so_far_;  // at the beginning of each interval
  processors::replay::Intervals asked_;
};

}  // namespace marti::studies::run
