#include "studies/limits/sweep_limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "sim/mapped.h"
#include "studies/helps/resources.h"
#include "studies/helps/verdict.h"
#include "studies/keys/machine_keys.h"
#include "studies/limits/step_predictor.h"

namespace marti::studies::limits {

namespace {

// A count of a store that somebody may have changed.
std::uint64_t counted(double count) {
  constexpr double most = 1e15;
  return static_cast<std::uint64_t>(std::clamp(count, 0.0, most));
}

helps::FrameFacts facts_of(const PointFigures& figures) {
  helps::FrameFacts facts;
  facts.packets = counted(figures.packets);
  facts.pixels = counted(figures.pixels);
  facts.database_bytes = counted(figures.database_bytes);
  facts.writes_waited = figures.queue_full_wait > 0.0;
  facts.waited_for_banks = figures.bank_waits > 0.0;
  return facts;
}

}  // namespace

const PredictedStep* PointLimit::best() const {
  return !steps.empty() && steps[0].basis != LimitBasis::unknown && steps[0].saved >= helps::worth_naming
             ? &steps[0]
             : nullptr;
}

std::vector<const PredictedStep*> PointLimit::open() const {
  const PredictedStep* const first = best();
  const double least = first != nullptr ? first->saved : helps::worth_naming;
  std::vector<const PredictedStep*> found;
  for (const PredictedStep& step : steps) {
    if (step.basis == LimitBasis::unknown && step.most_saved > least) {
      found.push_back(&step);
    }
  }
  return found;
}

std::string PointLimit::sentence() const {
  const PredictedStep* const first = best();
  std::string text = first != nullptr
                         ? fmt::format("{}: frame {}{:.1f} % shorter; {}", helps::describe(first->keys),
                                       first->basis == LimitBasis::neighbour ? "" : "about ",
                                       100.0 * first->saved, first->rests_on)
                         : fmt::format("no step that can be predicted makes the frame {:.1f} % shorter",
                                       100.0 * helps::worth_naming);
  if (std::ranges::all_of(steps, [](const auto& step) { return step.basis == LimitBasis::unknown; })) {
    text = "no step can be predicted";
  }
  constexpr std::size_t most_named = 4;
  const std::vector<const PredictedStep*> unknown = open();
  for (std::size_t i = 0; i < std::min(unknown.size(), most_named); ++i) {
    text += (i == 0 ? "; not known: " : "; ") + helps::describe(unknown[i]->keys);
  }
  if (unknown.size() > most_named) {
    text += fmt::format(" and {} more", unknown.size() - most_named);
  }
  return text;
}

SweepLimits::SweepLimits(std::vector<std::string> axes, std::vector<LimitPoint> points,
                         std::optional<keys::Prices> prices)
    : points_(std::move(points)), neighbours_(std::move(axes), configs_of(points_)), prices_(prices) {
  for (const LimitPoint& point : points_) {
    sim::Config config = point.config;
    machines_.push_back(keys::read_machine(config));
  }
}

std::vector<const sim::Config*> SweepLimits::configs_of(const std::vector<LimitPoint>& points) {
  return sim::mapped(points, [](const LimitPoint& point) { return &point.config; });
}

PointLimit SweepLimits::at(std::size_t point) const {
  const processors::machine::MachineConfig& machine = machines_[point];
  const helps::Changer changer(points_[point].config);
  const StepPredictor predictor(points_, machines_, neighbours_, point);
  PointLimit limit;
  for (const helps::Resource& resource :
       helps::resources_of(changer, machine, facts_of(points_[point].figures))) {
    if (resource.step) {
      limit.steps.push_back(predictor.predict(resource));
      if (prices_) {
        limit.steps.back().price =
            keys::cost_of(*prices_, resource.step->machine) - keys::cost_of(*prices_, machine);
      }
    }
  }
  const auto order = [](const PredictedStep& step) {
    return step.basis == LimitBasis::unknown ? std::pair(-1, 0.0) : helps::worth(step.saved, step.price);
  };
  std::ranges::stable_sort(
      limit.steps, [&](const PredictedStep& a, const PredictedStep& b) { return order(a) > order(b); });
  return limit;
}

}  // namespace marti::studies::limits
