#include "studies/limits/step_predictor.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "studies/limits/step_reasons.h"
#include "studies/limits/step_values.h"

namespace marti::studies::limits {

namespace {

using processors::machine::MachineConfig;

// Steps that change clocks, times and numbers of the model and nothing else.
bool is_modelled(std::string_view name) {
  constexpr std::array<std::string_view, 13> names = {
      "node.clock",           "machine.nodes",      "cache.hit_cycles",
      "interconnect.width",   "interconnect.clock", "interconnect.address_cycles",
      "memory.clock",         "memory.banks",       "interconnect.latency_cycles",
      "memory.access_cycles", "memory.busy_cycles", "host.latency_cycles",
      "host.occupancy_cycles"};
  return std::ranges::find(names, name) != names.end();
}

// Whether misses of other caches follow from those of the neighbours.
bool has_plain_cache(const MachineConfig& machine) {
  return machine.cache.organisation == processors::machine::CacheOrganisation::unified &&
         machine.l2.sharing == processors::machine::SecondLevel::none;
}

// Of the host, in ps a request.
double host_time(const MachineConfig& machine) {
  return static_cast<double>(
      machine.host.clock.cycles(machine.host.latency_cycles + machine.host.occupancy_cycles));
}

}  // namespace

StepPredictor::StepPredictor(std::span<const LimitPoint> points, std::span<const MachineConfig> machines,
                             const Neighbours& neighbours, std::size_t point)
    : points_(points),
      machines_(machines),
      neighbours_(neighbours),
      point_(point),
      model_(FrameModel::of(machines[point], points[point].figures)) {}

PredictedStep StepPredictor::predict(const helps::Resource& resource) const {
  PredictedStep step;
  step.name = resource.name;
  step.part = resource.part;
  step.keys = resource.step->keys;
  if (resource.same_frame) {
    step.basis = LimitBasis::model;
    step.rests_on = "nothing has waited for it";
    return step;
  }
  if (const std::optional<std::size_t> there = neighbours_.changed(point_, step.keys)) {
    step.basis = LimitBasis::neighbour;
    step.saved = 1.0 - points_[*there].figures.end / figures().end;
    step.rests_on = "neighbour: it has been timed";
    return step;
  }
  std::optional<Guess> guess = model_ ? from_model(resource) : std::nullopt;
  if (!guess) {
    guess = from_line(resource);
  }
  if (guess && std::isfinite(guess->end)) {
    step.basis = guess->basis;
    step.saved = 1.0 - guess->end / figures().end;
    step.rests_on = guess->rests_on;
  } else {
    step.most_saved = most_saved(resource);
  }
  return step;
}

std::optional<StepPredictor::Guess> StepPredictor::from_model(const helps::Resource& resource) const {
  const MachineConfig& changed = resource.step->machine;
  if (is_modelled(resource.name)) {
    FrameWork work = model_->work_on(changed);
    const double less = figures().host_requests * (host_time(machine()) - host_time(changed));
    work.delays = std::max(0.0, work.delays - less);
    const bool full_part = is_full(resource.part, machine(), figures());
    return Guess{model_->end_of(changed, work), full_part ? LimitBasis::bound : LimitBasis::model,
                 reason_of(resource.part, machine(), figures())};
  }
  if (resource.name.starts_with("packets.")) {
    return smaller_packets(resource);
  }
  if (!has_plain_cache(machine()) || figures().misses <= 0.0) {
    return std::nullopt;
  }
  if (resource.name == "cache.size" || resource.name == "cache.ways") {
    return cache_shape(resource);
  }
  return resource.name.starts_with("cache.line") ? cache_line(resource) : std::nullopt;
}

std::optional<StepPredictor::Guess> StepPredictor::from_line(const helps::Resource& resource) const {
  const std::string& key = resource.step->keys[0].key;
  const std::optional<double> from = neighbours_.number(point_, key);
  const std::optional<double> to = number_of(*resource.step);
  if (!from || !to || *from <= 0.0 || *to <= 0.0) {
    return std::nullopt;
  }
  const std::optional<std::size_t> beyond = next_on(key, *to);
  if (!beyond) {
    return std::nullopt;
  }
  const double part = part_of_way(*from, *to, *neighbours_.number(*beyond, key));
  return Guess{figures().end * std::pow(points_[*beyond].figures.end / figures().end, part),
               LimitBasis::interpolated, "interpolated: " + saving(*beyond, key)};
}

double StepPredictor::most_saved(const helps::Resource& resource) const {
  const double all = figures().end * machine().all_nodes();
  switch (resource.part) {
    case helps::Part::queues:
      return machine().scheme == processors::machine::Scheme::image ? figures().queue_full_wait / all : 1.0;
    case helps::Part::caches:
    case helps::Part::second_level:
      return model_ ? 1.0 - std::min(1.0, (figures().computing + figures().cache_access) / all) : 1.0;
    case helps::Part::nodes:
      // Smaller packets spread the same work more evenly.
      return resource.name.starts_with("packets.") ? figures().idle / all : 1.0;
    default:
      return 1.0;
  }
}

std::optional<std::size_t> StepPredictor::next_on(std::string_view key, double value) const {
  const std::optional<double> from = neighbours_.number(point_, key);
  if (!from) {
    return std::nullopt;
  }
  const bool up = value > *from;
  std::optional<std::size_t> nearest;
  double best = 0.0;
  for (const std::size_t other : neighbours_.along(point_, std::array{key})) {
    const std::optional<double> there = neighbours_.number(other, key);
    const bool on_side = there && *there > 0.0 && (up ? *there >= value : *there <= value);
    if (on_side && (!nearest || (up ? *there < best : *there > best))) {
      nearest = other;
      best = *there;
    }
  }
  return nearest;
}

std::string StepPredictor::saving(std::size_t neighbour, std::string_view key) const {
  const double saved = 1.0 - points_[neighbour].figures.end / figures().end;
  return fmt::format("{} {} -> {} {} {:.1f} %", key, neighbours_.text(point_, key),
                     neighbours_.text(neighbour, key), saved < 0.0 ? "costs" : "saves",
                     100.0 * std::abs(saved));
}

}  // namespace marti::studies::limits
