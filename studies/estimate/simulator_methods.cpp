#include "studies/estimate/simulator_methods.h"

#include <limits>

#include "processors/replay/replay.h"
#include "sim/error.h"
#include "studies/estimate/simulator_analytic.h"
#include "studies/estimate/simulator_sample.h"
#include "studies/tables/text_units.h"

namespace marti::studies::estimate {

namespace {

constexpr std::uint32_t all_nodes = std::numeric_limits<std::uint32_t>::max();

std::vector<Method> make_methods() {
  std::vector<Method> methods = {{}};
  for (const std::uint64_t strata : {8, 16, 32, 64}) {
    methods.push_back({.kind = MethodKind::sampled, .strata = strata});
  }
  for (const std::uint32_t nodes : {std::uint32_t{1}, std::uint32_t{4}, all_nodes}) {
    methods.push_back({.kind = MethodKind::analytic, .walked_nodes = nodes});
  }
  methods.push_back({.kind = MethodKind::analytic, .walked_nodes = all_nodes, .all_caches = true});
  for (const bool over_caches : {false, true}) {
    for (const Curve curve : {Curve::linear, Curve::cubic}) {
      methods.push_back({.kind = MethodKind::interpolated, .over_caches = over_caches, .curve = curve});
    }
  }
  return methods;
}

}  // namespace

std::string Method::name() const {
  switch (kind) {
    case MethodKind::exact:
      return "exact";
    case MethodKind::sampled:
      return "sampled";
    case MethodKind::analytic:
      return "analytic";
    case MethodKind::interpolated:
      return "interpolated";
  }
  return {};
}

std::string Method::knob() const {
  switch (kind) {
    case MethodKind::exact:
      return "replay";
    case MethodKind::sampled:
      return std::to_string(2 * strata) + " windows";
    case MethodKind::analytic:
      return all_caches                  ? "all nodes walked, all caches at once"
             : walked_nodes == all_nodes ? "all nodes walked"
                                         : tables::counted(walked_nodes, "node") + " walked";
    case MethodKind::interpolated:
      return std::string(over_caches ? "cache sizes" : "node counts") +
             (curve == Curve::linear ? ", linear" : ", cubic");
  }
  return {};
}

std::span<const Method> simulator_methods() {
  static const std::vector<Method> methods = make_methods();
  return methods;
}

void check_method(const Method& method, const processors::machine::MachineConfig& machine) {
  switch (method.kind) {
    case MethodKind::exact:
    case MethodKind::interpolated:
      break;
    case MethodKind::sampled:
      check_sample(machine);
      break;
    case MethodKind::analytic:
      check_analytic(machine);
      break;
  }
}

Estimate estimate(const Method& method, const processors::program::WorkLog& log,
                  const processors::machine::MachineConfig& machine) {
  sim::ensure(answers_alone(method), "a method that does not answer for one machine alone");
  switch (method.kind) {
    case MethodKind::analytic: {
      check_analytic(machine);
      const memory::CacheShape shape = memory::shape_of(machine.cache.cache);
      return estimate_analytically(log, machine, {&shape, 1}, {method.walked_nodes})[0];
    }
    case MethodKind::sampled:
    case MethodKind::interpolated:
    case MethodKind::exact:
      break;
  }
  const processors::replay::MachineResult result = processors::replay::replay(log, machine);
  Estimate estimate;
  estimate.value = figures_of(machine, result);
  estimate.references = static_cast<double>(result.references().references());
  estimate.events = result.events;
  for (const processors::program::LogRow& row : log.rows) {
    estimate.words += row.words.size();
  }
  return estimate;
}

}  // namespace marti::studies::estimate
