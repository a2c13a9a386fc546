#include "studies/error/error_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/joined.h"
#include "studies/figures/best_offer.h"
#include "studies/tables/text_units.h"

namespace marti::studies::error {

namespace {

// The error, as far as it is known.
double known_error(const std::vector<Setting>& settings, const Setting& setting) {
  return std::max(setting.error(), settings[setting.exact].noise);
}

std::string percent(double share) { return tables::figure_text(share, "fraction", ""); }

// "within 10 % for 2.10 % of that (smaller image 128 x 128: 4.20 %)", for each target that a cheaper setting
// meets.
std::string met_targets(const std::vector<Setting>& settings, std::size_t exact) {
  std::vector<std::string> met;
  std::size_t last = exact;
  for (const double target : targets) {
    const std::size_t best = cheapest(settings, exact, target);
    const Setting& setting = settings[best];
    if (best != exact && best != last) {
      met.push_back(fmt::format("within {:g} % for {} of that ({}{}: {})", 100.0 * target,
                                percent(share_of(settings, setting)),
                                setting.asked == frame_time ? setting.way + " " : "", setting.name,
                                percent(known_error(settings, setting))));
    }
    last = best;
  }
  return met.empty() ? "nothing faster is within 10 %" : sim::joined(met);
}

}  // namespace

double share_of(const std::vector<Setting>& settings, const Setting& setting) {
  const double exact = median(settings[setting.exact].seconds);
  return exact > 0.0 ? median(setting.seconds) / exact : 1.0;
}

std::size_t cheapest(const std::vector<Setting>& settings, std::size_t exact, double target) {
  std::size_t best = exact;
  for (std::size_t i = 0; i < settings.size(); ++i) {
    if (settings[i].exact == exact && known_error(settings, settings[i]) <= target &&
        median(settings[i].seconds) < median(settings[best].seconds)) {
      best = i;
    }
  }
  return best;
}

std::vector<std::string> answers_of(const std::vector<Setting>& settings) {
  std::vector<std::string> answers;
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const Setting& exact = settings[i];
    if (exact.exact == i) {
      const bool is_time = exact.asked == frame_time;
      answers.push_back(fmt::format("{}, in {} by {}: {}.", is_time ? "Frame time" : "Image by " + exact.way,
                                    tables::computed_seconds(1e12 * median(exact.seconds)),
                                    is_time ? "an exact run" : exact.name, met_targets(settings, i)));
    }
  }
  if (const std::optional<Exponent> exponent = exponent_of(settings, "samples")) {
    answers.push_back(fmt::format(
        "The error of samples goes as samples^p with p = {:.2f}{}, measured from {:.0f} to {:.0f} a pixel; "
        "independent samples of finite variance have p = -0.50.",
        exponent->value,
        std::isfinite(exponent->half_width) ? fmt::format(" +- {:.2f}", exponent->half_width) : "",
        exponent->from, exponent->to));
  }
  return answers;
}

tables::Table error_table(const std::vector<Setting>& settings) {
  tables::Table table(
      "host_error", "Error against run time",
      {tables::text_column("asked", "what is asked for"), tables::text_column("way", "what is turned"),
       tables::text_column("setting", "to what"), tables::real_column("value", "1", "the same as a number"),
       tables::real_column("error", "fraction",
                           "of the frame time the size; of the image the root mean square, over the exact"),
       tables::real_column("share", "fraction", "processor time over that of the exact setting"),
       tables::real_column("cpu", "s", "processor time, the median of the repeats"),
       tables::real_column("cpu_low", "s", "the shortest"),
       tables::real_column("cpu_high", "s", "the longest"),
       tables::integer_column("front", "", "1: nothing is both faster and better, of the frame time or knob"),
       tables::text_column("note", "what else is known")});
  std::vector<bool> front(settings.size());
  for (std::size_t exact = 0; exact < settings.size(); ++exact) {
    std::vector<std::size_t> compared;
    std::vector<figures::Offer> offers;
    for (std::size_t i = 0; i < settings.size(); ++i) {
      // Where pixels are infinite the error is no number.
      if (settings[i].exact == exact && !std::isnan(settings[i].error())) {
        compared.push_back(i);
        offers.push_back({median(settings[i].seconds), known_error(settings, settings[i])});
      }
    }
    for (const std::size_t offer : figures::pareto_front(offers, figures::Better::lower)) {
      front[compared[offer]] = true;
    }
  }
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const Setting& setting = settings[i];
    std::string note = setting.first.note;
    if (i == setting.exact) {
      note = setting.noise > 0.0 ? "exact, but for noise of " + percent(setting.noise) : "exact";
    } else if (setting.error() < settings[setting.exact].noise) {
      note = "below the noise of what it is held against";
    }
    const auto [low, high] = std::ranges::minmax(setting.seconds);
    table.add_row({setting.asked, setting.way, setting.name, setting.value, setting.error(),
                   share_of(settings, setting), median(setting.seconds), low, high,
                   static_cast<std::int64_t>(front[i]), note});
  }
  return table;
}

}  // namespace marti::studies::error
