#include "studies/limits/stored_limits.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "sim/error.h"
#include "studies/sweep/plan/sweep_keys.h"

namespace marti::studies::limits {

namespace {

using Settings = std::vector<std::pair<std::string, std::string>>;

sim::Config config_of(const sim::Schema& schema, const Settings& settings, const std::string& name) {
  std::vector<std::string> assignments;
  for (const auto& [key, value] : settings) {
    assignments.push_back(key + "=" + value);
  }
  return sim::Config::from_text(schema, "", name, assignments);
}

// The keys that are not equal in all machines. What a machine does not use is not among its settings.
class DifferingKeys {
 public:
  void add(const Settings& settings) {
    if (!first_) {
      first_ = std::map<std::string, std::string>(settings.begin(), settings.end());
      return;
    }
    std::size_t known = 0;
    for (const auto& [key, value] : settings) {
      const auto at = first_->find(key);
      known += at != first_->end() ? 1 : 0;
      if (at == first_->end() || at->second != value) {
        keys_.insert(key);
      }
    }
    if (known < first_->size()) {
      const std::map<std::string, std::string> here(settings.begin(), settings.end());
      for (const auto& [key, value] : *first_) {
        if (!here.contains(key)) {
          keys_.insert(key);
        }
      }
    }
  }
  [[nodiscard]] std::vector<std::string> keys() const { return {keys_.begin(), keys_.end()}; }

 private:
  std::optional<std::map<std::string, std::string>> first_;
  std::set<std::string> keys_;
};

}  // namespace

StoredLimits::StoredLimits(const sweep::SweepReader& sweep, const std::optional<keys::Prices>& prices) {
  const std::vector<sweep::StoredPoint> stored = sweep.points();
  if (std::ranges::count(stored, true, &sweep::StoredPoint::done) > most_limited_points) {
    return;
  }
  const sim::Schema& schema = sweep::sweep_schema();
  DifferingKeys differing;
  std::vector<LimitPoint> points;
  std::map<std::int64_t, std::optional<PointFigures>> one_node;  // by the id of a base machine
  for (const sweep::StoredPoint& point : stored) {
    const std::optional<sweep::SweepRow> row = sweep.read_result(point.machine);
    if (!row || figures::count_of(row->counters, "end").value_or(0) <= 0) {
      continue;
    }
    const Settings settings = sweep.settings(point.machine);
    try {
      points.push_back(
          {config_of(schema, settings, sweep.file().string()), point_figures(row->counters), std::nullopt});
    } catch (const sim::UserError&) {  // settings of another version of the program
      places_.clear();
      return;
    }
    differing.add(settings);
    places_.emplace(point.ordinal, points.size() - 1);
    // Many points have one base.
    const auto [base, is_new] = one_node.try_emplace(point.base);
    if (is_new) {
      const std::optional<sweep::SweepRow> result = sweep.read_result(point.base);
      if (result && figures::count_of(result->counters, "nodes") == 1) {
        base->second = point_figures(result->counters);
      }
    }
    points.back().one_node = base->second;
  }
  try {
    limits_.emplace(differing.keys(), std::move(points), prices);
  } catch (const sim::UserError&) {  // a combination that another version of the program allowed
    places_.clear();
  }
}

std::optional<PointLimit> StoredLimits::at(std::int64_t ordinal) const {
  const auto place = places_.find(ordinal);
  return place == places_.end() ? std::nullopt : std::optional(limits_->at(place->second));
}

}  // namespace marti::studies::limits
