#include "studies/report/model/sweep_answer.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include "studies/figures/best_offer.h"
#include "studies/report/model/answer_text.h"
#include "studies/sweep/store/points_table.h"
#include "studies/tables/text_units.h"

namespace marti::studies::report {

namespace {

double price_of(const ReportPoint& point) { return point.figure("price"); }

// What a step up or down on each axis gains, the best first; steps that gain nothing are left out.
struct Advice {
  bool any_step = false;  ///< a machine one step away was timed on the same frame
  std::string text;
};

Advice advice(const ReportPoints& sweep, const ReportPoint& from) {
  struct Step {
    std::string text;
    double gain;
  };
  constexpr double little = 0.0005;  // of the frame: less is shown as 0.0 %
  std::map<std::vector<std::size_t>, const ReportPoint*> timed;
  for (const ReportPoint& point : sweep.points) {
    if (point.frame == from.frame) {
      timed.emplace(point.place, &point);
    }
  }
  Advice advice;
  std::vector<Step> steps;
  for (std::size_t axis = 0; axis < sweep.axes.size(); ++axis) {
    const ReportAxis& each = sweep.axes[axis];
    for (const int direction : {1, -1}) {
      std::vector<std::size_t> place = from.place;
      if (!each.numeric || (direction < 0 && place[axis] == 0)) {
        continue;
      }
      place[axis] = direction > 0 ? place[axis] + 1 : place[axis] - 1;
      const auto next = timed.find(place);
      if (next == timed.end()) {
        continue;
      }
      advice.any_step = true;
      const double gain = 1.0 - next->second->figure("end") / from.figure("end");
      if (gain >= little) {
        steps.push_back({fmt::format("{} from {} to {} makes the frame {:.1f} % shorter", each.name,
                                     each.texts[from.place[axis]], each.texts[place[axis]], 100.0 * gain),
                         gain});
      }
    }
  }
  std::ranges::stable_sort(steps, std::greater{}, &Step::gain);
  for (const Step& step : steps) {
    advice.text += (advice.text.empty() ? "" : "; ") + step.text;
  }
  return advice;
}

// Values that all machines of a frame share and other machines have not: "image.width = 512".
std::string frame_text(const ReportPoints& sweep, std::size_t frame) {
  std::string text;
  for (std::size_t axis = 0; axis < sweep.axes.size(); ++axis) {
    std::set<std::size_t> values;
    for (const ReportPoint& point : sweep.points) {
      if (point.frame == frame) {
        values.insert(point.place[axis]);
      }
    }
    if (values.size() == 1) {
      text += (text.empty() ? ": " : ", ") + sweep.axes[axis].name + " = " +
              sweep.axes[axis].texts[*values.begin()];
    }
  }
  return text;
}

std::string speed_text(const ReportPoint& point) {
  if (!point.has("speed_up")) {
    return {};
  }
  return fmt::format(", {:.2f} times as fast as its base machine (efficiency {:.0f} %)",
                     point.figure("speed_up"), 100.0 * point.figure("efficiency"));
}

struct Front {
  std::vector<std::size_t> points;
  std::vector<figures::Offer> offers;  // of each of them
};

// Of the points of this frame that have the figure, those that no other beats in it and in frame time.
Front front_by(const ReportPoints& sweep, std::string_view figure, std::size_t frame) {
  std::vector<figures::Offer> offers;
  std::vector<std::size_t> offered;
  for (std::size_t i = 0; i < sweep.points.size(); ++i) {
    const ReportPoint& point = sweep.points[i];
    if (point.frame == frame && point.has(figure)) {
      offers.push_back({point.figure(figure), point.figure("end")});
      offered.push_back(i);
    }
  }
  Front front;
  for (const std::size_t i : figures::pareto_front(offers, figures::Better::lower)) {
    front.points.push_back(offered[i]);
    front.offers.push_back(offers[i]);
  }
  return front;
}

}  // namespace

Chosen choose(const ReportPoints& sweep, std::optional<double> budget) {
  const auto shortest = std::ranges::min_element(
      sweep.points,
      [](const ReportPoint& a, const ReportPoint& b) { return a.figure("end") < b.figure("end"); });
  Chosen chosen;
  const Front by_price = front_by(sweep, "price", shortest->frame);
  chosen.front = by_price.points;
  chosen.energy_front = front_by(sweep, "energy", shortest->frame).points;
  chosen.fastest = chosen.front.back();
  chosen.knee = chosen.front[figures::knee_of(by_price.offers)];
  chosen.budget = budget;
  for (const std::size_t i : chosen.front) {  // ascending by price: each is faster than the one before
    if (budget && price_of(sweep.points[i]) <= *budget) {
      chosen.within = i;
    }
  }
  return chosen;
}

std::string place_text(const ReportPoints& sweep, const ReportPoint& point) {
  std::string text;
  for (std::size_t i = 0; i < sweep.axes.size(); ++i) {
    text += (i == 0 ? "" : ", ") + sweep.axes[i].name + " = " + sweep.axes[i].texts[point.place[i]];
  }
  return text.empty() ? "the only machine" : text;
}

std::vector<std::string> answer_of(const ReportPoints& sweep, const Chosen& chosen) {
  const ReportPoint& fastest = sweep.points[chosen.fastest];
  const ReportPoint& knee = sweep.points[chosen.knee];
  const std::string unit = sweep.priced ? "at a price of" : "with a node count of";
  const auto compared = static_cast<std::size_t>(std::ranges::count_if(
      sweep.points, [&](const ReportPoint& point) { return point.frame == fastest.frame; }));
  std::vector<std::string> answer;
  const auto add_advice = [&](const char* begin, const ReportPoint& point) {
    if (!point.advice.empty()) {
      answer.push_back(fmt::format("{}: {}.", begin, point.advice));
    }
  };
  answer.push_back(fmt::format(
      "{} takes {} a frame{} {} {:g}: {}.",
      compared == 1 ? "The only machine compared" : fmt::format("The fastest of {} machines", compared),
      tables::computed_seconds(fastest.figure("end")), speed_text(fastest), unit, price_of(fastest),
      place_text(sweep, fastest)));
  if (sweep.frames > 1) {
    answer.push_back(fmt::format(
        "The sweep has {} different frames, which are not the same work: only the machines of the frame with "
        "the shortest time are compared here{}.",
        sweep.frames, frame_text(sweep, fastest.frame)));
  }
  const sweep::Noise& largest = sweep.effects.noise;
  if (const std::optional<sweep::Noise> noise =
          sweep::noise_of_fastest(fastest.noise, largest.of_seeds ? largest : sweep::Noise{})) {
    std::vector<double> times;
    for (const ReportPoint& point : sweep.points) {
      if (point.frame == fastest.frame) {
        times.push_back(point.figure("end"));
      }
    }
    answer.push_back("Noise: " + sweep::fastest_noise_text(*noise, sweep::within_noise(times, noise->band)) +
                     ".");
  }
  add_advice("What would help it, measured", fastest);
  if (chosen.knee != chosen.fastest) {
    const double time = knee.figure("end") / fastest.figure("end");
    const double price = price_of(knee) / price_of(fastest);  // dearer than the knee: above 0
    answer.push_back(
        fmt::format("Worth its price (the knee of the {} machines that no other beats in price and time): {} "
                    "a frame{} {} {:g}, "
                    "{:.2f} times the time of the fastest for {:.1f} % of its price: {}.",
                    chosen.front.size(), tables::computed_seconds(knee.figure("end")), speed_text(knee), unit,
                    price_of(knee), time, 100.0 * price, place_text(sweep, knee)));
    add_advice("What would help that one, measured", knee);
  }
  if (chosen.within) {
    const ReportPoint& within = sweep.points[*chosen.within];
    answer.push_back(fmt::format("The fastest within a budget of {:g}: {} a frame{} {} {:g}: {}.",
                                 *chosen.budget, tables::computed_seconds(within.figure("end")),
                                 speed_text(within), unit, price_of(within), place_text(sweep, within)));
  } else if (chosen.budget) {
    answer.push_back(fmt::format("No machine is within a budget of {:g}; the cheapest is {} {:g}.",
                                 *chosen.budget, unit, price_of(sweep.points[chosen.front.front()])));
  }
  if (const Advice steps = advice(sweep, knee); !steps.text.empty()) {
    answer.push_back(fmt::format("What to change there, one step at a time: {}.", steps.text));
  } else if (steps.any_step) {
    answer.push_back(
        "What to change there: no single step of a numeric axis saves 0.05 % of its time, of those timed.");
  }
  if (const std::string effects = sweep::effects_text(sweep.effects); !effects.empty()) {
    answer.push_back("What matters most, frame times at the worst value of an axis by those at its best: " +
                     effects + ".");
  }
  if (sweep.points.size() < sweep.planned) {
    answer.push_back(
        fmt::format("{} of {} points have been timed so far; run `marti sweep` again for the rest.",
                    sweep.points.size(), sweep.planned));
  }
  return answer;
}

}  // namespace marti::studies::report
