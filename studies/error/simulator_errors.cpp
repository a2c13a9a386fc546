#include "studies/error/simulator_errors.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace marti::studies::error {

namespace {

// A method's answer to one case, as far as one figure goes.
struct Answer {
  std::size_t number = 0;  // of the case
  double error = 0.0;
  double half_width = 0.0;
  std::size_t load_class = 0;  // by the method's own estimate
  [[nodiscard]] double excess() const { return std::max(0.0, std::abs(error) - half_width); }
};

std::vector<Answer> answers_of(const SimulatorStudy& study, std::size_t method, estimate::Figure figure) {
  std::vector<Answer> answers;
  for (std::size_t number = 0; number < study.cases.size(); ++number) {
    // One node has a speed-up of exactly 1, whatever a method says.
    if (figure == estimate::Figure::speed_up && study.cases[number].nodes == 1) {
      continue;
    }
    const std::optional<estimate::Estimate>& estimate = study.estimates[method][number];
    // An interval without bounds holds everything and says nothing.
    if (estimate && std::isfinite(estimate->half_width[figure])) {
      answers.push_back(
          {number, estimate::error_of(figure, estimate->value[figure], study.truth[number].value[figure]),
           estimate->half_width[figure], estimate::load_class_of(estimate->value[estimate::Figure::use])});
    }
  }
  return answers;
}

// The allowance by the answers of one class of load, without those of scene `without`.
std::optional<double> allowance_of(const SimulatorStudy& study, const std::vector<Answer>& answers,
                                   std::size_t load_class, std::optional<std::size_t> without) {
  std::vector<double> excesses;
  for (const Answer& answer : answers) {
    if (answer.load_class == load_class && study.cases[answer.number].scene != without) {
      excesses.push_back(answer.excess());
    }
  }
  if (excesses.empty()) {
    return std::nullopt;
  }
  return estimate::upper_quantile(std::move(excesses), estimate::stated_confidence);
}

std::optional<double> cover_widened(const SimulatorStudy& study, const std::vector<Answer>& answers) {
  std::size_t asked = 0;
  std::size_t covered = 0;
  for (const Answer& answer : answers) {
    const ErrorCase& one = study.cases[answer.number];
    const std::optional<double> allowance = allowance_of(study, answers, answer.load_class, one.scene);
    if (allowance) {
      ++asked;
      covered += answer.excess() <= *allowance ? 1 : 0;
    }
  }
  if (asked == 0) {
    return std::nullopt;
  }
  return static_cast<double>(covered) / static_cast<double>(asked);
}

FigureErrors figure_errors(const SimulatorStudy& study, std::size_t method, estimate::Figure figure) {
  const std::vector<Answer> answers = answers_of(study, method, figure);
  FigureErrors result;
  if (answers.empty()) {
    return result;
  }
  std::vector<double> errors;
  std::size_t stated = 0;
  std::size_t covered = 0;
  for (const Answer& answer : answers) {
    errors.push_back(answer.error);
    stated += answer.half_width > 0.0 ? 1 : 0;
    covered += answer.half_width > 0.0 && answer.excess() == 0.0 ? 1 : 0;
  }
  result.summary = estimate::summarise(errors);
  result.summary.worst_case = answers[result.summary.worst_case].number;
  if (stated > 0) {
    result.covered = static_cast<double>(covered) / static_cast<double>(stated);
  }
  result.covered_widened = cover_widened(study, answers);
  for (std::size_t i = 0; i < estimate::load_classes.size(); ++i) {
    result.allowance[i] = allowance_of(study, answers, i, std::nullopt);
  }
  return result;
}

void add_ranks(const SimulatorStudy& study, std::size_t method, MethodErrors& errors) {
  const std::size_t frames = study.cases.back().frame + 1;
  bool ranked = false;
  errors.least_tau = std::numeric_limits<double>::infinity();
  for (std::size_t frame = 0; frame < frames; ++frame) {
    std::vector<double> truth;
    std::vector<double> found;
    std::vector<double> true_power;
    std::vector<double> found_power;
    for (std::size_t number = 0; number < study.cases.size(); ++number) {
      if (study.cases[number].frame != frame) {
        continue;
      }
      const estimate::MachineFigures& exact = study.truth[number].value;
      const std::optional<estimate::Estimate>& estimate = study.estimates[method][number];
      const double end = estimate ? estimate->value[estimate::Figure::end] : exact[estimate::Figure::end];
      const auto nodes = static_cast<double>(study.cases[number].nodes);
      truth.push_back(exact[estimate::Figure::end]);
      found.push_back(end);
      // Speed-up times efficiency is 1 / (end^2 nodes), but for a factor.
      true_power.push_back(exact[estimate::Figure::end] * exact[estimate::Figure::end] * nodes);
      found_power.push_back(end * end * nodes);
    }
    if (const std::optional<double> tau = estimate::kendall_tau(truth, found)) {
      ranked = true;
      errors.least_tau = std::min(errors.least_tau, *tau);
    }
    errors.regret = std::max(errors.regret, estimate::regret(truth, found));
    errors.power_regret = std::max(errors.power_regret, estimate::regret(true_power, found_power));
  }
  errors.least_tau = ranked ? errors.least_tau : 1.0;
}

}  // namespace

std::vector<MethodErrors> errors_of(const SimulatorStudy& study) {
  std::vector<MethodErrors> all(estimate::simulator_methods().size());
  for (std::size_t method = 0; method < all.size(); ++method) {
    const std::vector<std::optional<estimate::Estimate>>& estimates = study.estimates[method];
    MethodErrors& errors = all[method];
    errors.any = std::ranges::any_of(estimates, [](const auto& e) { return e.has_value(); });
    if (!errors.any) {
      continue;
    }
    for (std::size_t figure = 0; figure < estimate::figure_count; ++figure) {
      errors.figures[figure] = figure_errors(study, method, static_cast<estimate::Figure>(figure));
    }
    add_ranks(study, method, errors);
  }
  return all;
}

std::vector<estimate::MeasuredError> measured_errors_of(const SimulatorStudy& study) {
  using Answers = std::array<std::vector<Answer>, estimate::figure_count>;
  std::array<Answers, estimate::sample_sizes.size()> answers;
  for (std::size_t i = 0; i < estimate::figure_count; ++i) {
    for (std::size_t method = 0; method < estimate::simulator_methods().size(); ++method) {
      const std::uint64_t windows = 2 * estimate::simulator_methods()[method].strata;
      if (estimate::simulator_methods()[method].kind == estimate::MethodKind::sampled &&
          windows >= estimate::least_windows) {
        for (const Answer& answer : answers_of(study, method, static_cast<estimate::Figure>(i))) {
          answers[estimate::size_class_of(windows)][i].push_back(answer);
        }
      }
    }
  }
  std::vector<estimate::MeasuredError> errors;
  for (std::size_t row = 0; row < estimate::load_classes.size() * answers.size(); ++row) {
    const std::size_t load = row / answers.size();
    const std::size_t size = row % answers.size();
    estimate::MeasuredError error{estimate::load_classes[load], estimate::sample_sizes[size], 0, 1.0, {}};
    for (std::size_t i = 0; i < estimate::figure_count; ++i) {
      std::vector<Answer> of_class = answers[size][i];  // coverage is counted of the class alone
      std::erase_if(of_class, [&](const Answer& answer) { return answer.load_class != load; });
      if (const std::optional<double> allowance = allowance_of(study, of_class, load, std::nullopt)) {
        error.allowance[static_cast<estimate::Figure>(i)] = *allowance;
        error.covered = std::min(error.covered, cover_widened(study, of_class).value_or(0.0));
        error.cases = std::max(error.cases, of_class.size());
      }
    }
    if (error.cases > 0) {
      errors.push_back(error);
    }
  }
  return errors;
}

}  // namespace marti::studies::error
