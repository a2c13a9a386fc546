// Steps that change how often the caches miss.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "memory/cache.h"
#include "studies/limits/reuse_distances.h"
#include "studies/limits/step_predictor.h"
#include "studies/limits/step_values.h"

namespace marti::studies::limits {

namespace {

using processors::machine::MachineConfig;

constexpr std::array<std::string_view, 2> shape_keys = {"cache.size", "cache.ways"};

// The distribution of reuse distances is fitted to at most so many caches.
constexpr std::size_t most_fitted = 64;

CacheMisses misses_of(const MachineConfig& machine, double misses) {
  const memory::CacheShape shape = memory::shape_of(machine.cache.cache);
  return {static_cast<double>(shape.sets), static_cast<double>(shape.ways), misses};
}

}  // namespace

// The misses of the nearest caches that differ in size and ways only.
std::vector<CacheMisses> StepPredictor::known_misses() const {
  std::vector<std::pair<double, CacheMisses>> found;
  const CacheMisses here = misses_of(machine(), figures().misses);
  for (const std::size_t other : neighbours_.along(point_, shape_keys)) {
    const PointFigures& there = points_[other].figures;
    if (there.misses > 0.0) {
      const CacheMisses cache = misses_of(machines_[other], there.misses);
      found.emplace_back(
          std::abs(std::log(cache.sets / here.sets)) + std::abs(std::log(cache.ways / here.ways)), cache);
    }
  }
  std::ranges::stable_sort(found, {}, &std::pair<double, CacheMisses>::first);
  std::vector<CacheMisses> known;
  for (std::size_t i = 0; i < std::min(found.size(), most_fitted); ++i) {
    known.push_back(found[i].second);
  }
  return known;
}

double StepPredictor::end_with_misses(const MachineConfig& changed, double misses, double references) const {
  FrameWork work = model_->work_on(changed);
  work.reads *= misses / figures().misses;
  work.cache_access *= references / figures().references;
  return model_->end_of(changed, work);
}

std::optional<StepPredictor::Guess> StepPredictor::cache_shape(const helps::Resource& resource) const {
  const std::string_view key = resource.name == shape_keys[0] ? shape_keys[0] : shape_keys[1];
  const std::optional<double> from = neighbours_.number(point_, key);
  const std::optional<double> to = number_of(*resource.step);
  if (!from || !to || *from <= 0.0 || *to <= 0.0) {
    return std::nullopt;
  }
  const std::optional<std::size_t> beyond = next_on(key, *to);
  const std::optional<std::size_t> behind = next_on(key, *from * *from / *to);
  if (!beyond && !behind) {
    return std::nullopt;
  }
  const ReuseDistances reuse(known_misses());
  const auto fitted = [&](const MachineConfig& machine) {
    const CacheMisses shape = misses_of(machine, 0.0);
    return reuse.misses(shape.sets, shape.ways);
  };
  const MachineConfig& changed = resource.step->machine;
  double misses = fitted(changed) * figures().misses / fitted(machine());
  if (!beyond) {
    return Guess{end_with_misses(changed, misses, figures().references), LimitBasis::extended,
                 "extended: beyond " + saving(*behind, key)};
  }
  const PointFigures& next = points_[*beyond].figures;
  const double part = part_of_way(*from, *to, *neighbours_.number(*beyond, key));
  if (next.misses <= 0.0) {
    return std::nullopt;
  }
  // The error of the fit and that of the model at the neighbour, as far as the step goes towards it.
  const double fit_error = next.misses / fitted(machines_[*beyond]) * fitted(machine()) / figures().misses;
  misses *= std::pow(fit_error, part);
  const double model_error = next.end / end_with_misses(machines_[*beyond], next.misses, next.references);
  return Guess{end_with_misses(changed, misses, figures().references) * std::pow(model_error, part),
               LimitBasis::interpolated, "interpolated: " + saving(*beyond, key)};
}

std::optional<StepPredictor::Guess> StepPredictor::cache_line(const helps::Resource& resource) const {
  constexpr std::string_view key = "cache.line";
  const auto from = static_cast<double>(machine().cache.cache.line);
  const auto to = static_cast<double>(resource.step->machine.cache.cache.line);
  const std::optional<std::size_t> first = next_on(key, from * from / to);
  if (!first || points_[*first].figures.misses <= 0.0) {
    return std::nullopt;
  }
  const PointFigures& one = points_[*first].figures;
  const double near = *neighbours_.number(*first, key);
  const double part = part_of_way(from, to, near);  // negative
  const double slope = std::log(one.misses / figures().misses);
  double misses = std::log(figures().misses) + slope * part;
  if (const std::optional<std::size_t> second = next_on(key, near * near / from);
      second && points_[*second].figures.misses > 0.0) {
    const double far = part_of_way(from, *neighbours_.number(*second, key), near);
    const double bend =
        (std::log(points_[*second].figures.misses / figures().misses) / far - slope) / (far - 1.0);
    misses += bend * part * (part - 1.0);
  }
  const double references = figures().references * std::pow(one.references / figures().references, part);
  // No line can be missed more often than it is asked for.
  return Guess{end_with_misses(resource.step->machine, std::min(references, std::exp(misses)), references),
               LimitBasis::extended, "extended: beyond " + saving(*first, key)};
}

std::optional<StepPredictor::Guess> StepPredictor::smaller_packets(const helps::Resource& resource) const {
  const LimitPoint& point = points_[point_];
  if (!point.one_node || figures().misses <= 0.0) {
    return std::nullopt;
  }
  // See README.md.
  constexpr double part_at_borders = 0.75;
  const MachineConfig& changed = resource.step->machine;
  FrameWork work = model_->work_on(changed);
  const double more = part_at_borders * std::max(0.0, figures().misses - point.one_node->misses);
  work.reads *= 1.0 + more / figures().misses;
  work.delays *= packet_area(machine()) / packet_area(changed);
  return Guess{model_->end_of(changed, work), LimitBasis::model,
               fmt::format("model: nodes are idle for {:.1f} % of their time",
                           100.0 * figures().idle / (figures().end * machine().all_nodes()))};
}

}  // namespace marti::studies::limits
