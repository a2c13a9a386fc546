#include "studies/error/setting.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "sim/cpu_time.h"
#include "sim/error.h"
#include "sim/finished_parts.h"
#include "studies/estimate/regression_estimate.h"
#include "studies/run/functional_run.h"
#include "studies/run/voxel_report.h"

namespace marti::studies::error {

namespace {

double root_mean_square(const processors::program::Image& image) {
  double squares = 0.0;
  for (const glm::vec3& pixel : image.pixels) {
    for (int channel = 0; channel < 3; ++channel) {
      squares += static_cast<double>(pixel[channel]) * static_cast<double>(pixel[channel]);
    }
  }
  return std::sqrt(squares / (3.0 * static_cast<double>(std::max<std::size_t>(1, image.pixels.size()))));
}

double relative(double error, double exact) {
  if (error == 0.0) {
    return 0.0;
  }
  return exact > 0.0 ? error / exact : std::numeric_limits<double>::infinity();
}

bool is_equal(const Answer& a, const Answer& b) {
  return a.ps == b.ps && run::image_hash(a.image) == run::image_hash(b.image);
}

}  // namespace

double error_of(const Answer& answer, const Answer& exact) {
  return exact.image.pixels.empty()
             ? relative(std::abs(answer.ps - exact.ps), exact.ps)
             : relative(run::image_error(answer.image, exact.image).rmse, root_mean_square(exact.image));
}

double Setting::error() const {
  return seconds.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(seconds.size()));
}

void measure(std::vector<Setting>& settings, std::uint32_t repeats, sim::WorkMeter* meter) {
  const auto is_reference = [&](const Setting& setting) {
    return setting.drawn && &setting == &settings[setting.exact];
  };
  const auto references = static_cast<std::size_t>(std::ranges::count_if(settings, is_reference));
  sim::plan_parts(meter, "runs", (settings.size() - references) * repeats + references);
  for (std::uint32_t repeat = 0; repeat < repeats; ++repeat) {
    for (std::size_t i = 0; i < settings.size(); ++i) {
      Setting& setting = settings[i];
      const bool reference = is_reference(setting);
      if (reference && repeat > 0) {
        continue;
      }
      sim::begin_part(meter, setting.way + " " + setting.name);
      Answer answer;
      double seconds = 0.0;
      const auto run = [&] {
        const double before = sim::process_cpu_seconds();
        answer = setting.run(repeat);
        seconds = sim::process_cpu_seconds() - before;
        if (reference) {
          // Two references with equal errors that know nothing of each other.
          setting.noise = error_of(setting.run(1), answer) / std::sqrt(2.0);
        }
      };
      sim::once(meter, "runs", std::to_string(i) + " " + std::to_string(repeat), run, answer.ps,
                answer.image.width, answer.image.height, answer.image.pixels, answer.note, seconds,
                setting.noise);
      setting.seconds.push_back(seconds);
      if (repeat == 0) {
        setting.first = answer;
      } else {
        sim::ensure(setting.drawn || is_equal(answer, setting.first),
                    "an answer differs when it is repeated");
      }
      const double error = error_of(answer, settings[setting.exact].first);
      setting.squares += error * error;
    }
  }
}

double median(std::vector<double> values) {
  sim::ensure(!values.empty(), "a median of no values");
  std::ranges::sort(values);
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

std::optional<Exponent> exponent_of(const std::vector<Setting>& settings, std::string_view way) {
  std::vector<double> xs;
  std::vector<double> ys;
  for (const Setting& setting : settings) {
    // What is not drawn, such as the one sample in a pixel's centre, has another kind of error.
    if (setting.way == way && setting.drawn && setting.error() > settings[setting.exact].noise) {
      xs.push_back(std::log(setting.value));
      ys.push_back(std::log(setting.error()));
    }
  }
  if (xs.size() < 2) {
    return std::nullopt;
  }
  const auto n = static_cast<double>(xs.size());
  const double mean_x = std::accumulate(xs.begin(), xs.end(), 0.0) / n;
  const double mean_y = std::accumulate(ys.begin(), ys.end(), 0.0) / n;
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  for (std::size_t i = 0; i < xs.size(); ++i) {
    xx += (xs[i] - mean_x) * (xs[i] - mean_x);
    xy += (xs[i] - mean_x) * (ys[i] - mean_y);
    yy += (ys[i] - mean_y) * (ys[i] - mean_y);
  }
  Exponent found{xy / xx, std::numeric_limits<double>::infinity(), std::exp(xs.front()), std::exp(xs.back())};
  if (xs.size() > 2) {
    const double residues = std::max(0.0, yy - found.value * xy);
    found.half_width = estimate::student_95(xs.size() - 2) * std::sqrt(residues / (n - 2.0) / xx);
  }
  return found;
}

}  // namespace marti::studies::error
