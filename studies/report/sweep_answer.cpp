#include "studies/report/sweep_answer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "studies/sweep/sweep_best.h"
#include "studies/text_units.h"

namespace marti::studies {

namespace {

std::string time_text(double ps) { return seconds(static_cast<sim::Ticks>(std::llround(ps))); }

double price_of(const ReportPoint& point) { return point.figure("price"); }

// The point of the front farthest below the line between its ends.
std::size_t knee_of(const SweepPoints& sweep, const std::vector<std::size_t>& front) {
  const auto place = [&](std::size_t i) {
    const ReportPoint& point = sweep.points[i];
    return std::pair(std::log(std::max(price_of(point), 1e-12)),
                     std::log(std::max(point.figure("end"), 1e-12)));
  };
  const auto [x0, y0] = place(front.front());
  const auto [x1, y1] = place(front.back());
  std::size_t best = front.back();
  double deepest = 0.0;
  for (const std::size_t i : front) {
    const auto [x, y] = place(i);
    const double depth = x1 > x0 ? y0 + (y1 - y0) * (x - x0) / (x1 - x0) - y : 0.0;
    if (depth > deepest + 1e-12) {
      deepest = depth;
      best = i;
    }
  }
  return best;
}

// The same machine with the next value up of an axis, if it was timed.
std::optional<std::size_t> step_up(const SweepPoints& sweep, const ReportPoint& from, std::size_t axis) {
  for (std::size_t i = 0; i < sweep.points.size(); ++i) {
    const ReportPoint& point = sweep.points[i];
    bool matches = point.place[axis] == from.place[axis] + 1;
    for (std::size_t j = 0; matches && j < point.place.size(); ++j) {
      matches = j == axis || point.place[j] == from.place[j];
    }
    if (matches) {
      return i;
    }
  }
  return std::nullopt;
}

// What the next step on each axis buys, the best first.
std::string advice(const SweepPoints& sweep, const ReportPoint& from) {
  struct Step {
    std::string text;
    double gain;
  };
  constexpr double little = 0.0005;  // of the frame: less is shown as 0.0 %
  std::vector<Step> steps;
  for (std::size_t axis = 0; axis < sweep.axes.size(); ++axis) {
    const std::optional<std::size_t> next = step_up(sweep, from, axis);
    if (!sweep.axes[axis].numeric || !next) {
      continue;
    }
    const ReportAxis& each = sweep.axes[axis];
    const double gain = 1.0 - sweep.points[*next].figure("end") / from.figure("end");
    const std::string effect = std::abs(gain) < little
                                   ? std::string("changes nothing")
                                   : fmt::format("makes the frame {:.1f} % {}", 100.0 * std::abs(gain),
                                                 gain > 0.0 ? "shorter" : "longer");
    steps.push_back({fmt::format("{} from {} to {} {}", each.name, each.texts[from.place[axis]],
                                 each.texts[from.place[axis] + 1], effect),
                     gain});
  }
  std::stable_sort(steps.begin(), steps.end(), [](const Step& a, const Step& b) { return a.gain > b.gain; });
  std::string text;
  for (const Step& step : steps) {
    text += (text.empty() ? "" : "; ") + step.text;
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

}  // namespace

Chosen choose(const SweepPoints& sweep) {
  Chosen chosen;
  std::vector<Offer> offers;
  for (const ReportPoint& point : sweep.points) {
    offers.push_back({price_of(point), point.figure("end")});
  }
  chosen.front = pareto_front(offers, Better::lower);
  chosen.fastest = chosen.front.back();
  chosen.knee = knee_of(sweep, chosen.front);
  return chosen;
}

std::string place_text(const SweepPoints& sweep, const ReportPoint& point) {
  std::string text;
  for (std::size_t i = 0; i < sweep.axes.size(); ++i) {
    text += (i == 0 ? "" : ", ") + sweep.axes[i].name + " = " + sweep.axes[i].texts[point.place[i]];
  }
  return text.empty() ? "the only machine" : text;
}

std::string limit_sentence(const ReportPoint& point) {
  const auto share = [&](std::initializer_list<const char*> names) {
    double sum = 0.0;
    for (const char* name : names) {
      sum += point.figure(std::string("share_") + name);
    }
    return sum;
  };
  struct Limit {
    double share;
    std::string what;
    std::string remedy;
  };
  const std::vector<Limit> limits = {
      {share({"interconnect_wait"}), "waiting for the interconnect",
       "a wider or faster interconnect, larger caches or fewer nodes would help"},
      {share({"bank_wait"}), "waiting for memory banks", "more or faster banks would help"},
      {share({"transfer", "bank_access"}), "transfers and bank accesses that meet no queue",
       "fewer misses or faster memory would help"},
      {share({"dispatch_wait"}), "waiting for packets or for the initial tree",
       "larger packets or a faster host would help"},
      {share({"lock_wait"}), "waiting for branches that others split",
       "a higher build.initial_level would help"},
      {share({"idle"}), "idling because the work is uneven at the end of the frame",
       "smaller packets or fewer nodes would help"},
      {share({"queue_full_wait"}), "waiting for room in a buffer or queue", "longer queues would help"},
      {share({"message_wait"}), "waiting for rays and messages", "more rays in flight would help"},
      {share({"traversal", "intersection", "shading", "building", "cache_access", "switching", "messaging"}),
       "computing", "more or faster nodes would help"}};
  const auto most = std::max_element(limits.begin(), limits.end(),
                                     [](const Limit& a, const Limit& b) { return a.share < b.share; });
  return fmt::format("its nodes spend {:.1f} % of their time {}; {}", 100.0 * most->share, most->what,
                     most->remedy);
}

std::vector<std::string> answer_of(const SweepPoints& sweep, const Chosen& chosen) {
  const ReportPoint& fastest = sweep.points[chosen.fastest];
  const ReportPoint& knee = sweep.points[chosen.knee];
  const std::string unit = sweep.priced ? "at a price of" : "with a node count of";
  std::vector<std::string> answer;
  answer.push_back(fmt::format("The fastest of {} machines takes {} a frame{} {} {:g}: {}.",
                               sweep.points.size(), time_text(fastest.figure("end")), speed_text(fastest),
                               unit, price_of(fastest), place_text(sweep, fastest)));
  answer.push_back(fmt::format("What limits it: {}.", limit_sentence(fastest)));
  if (chosen.knee != chosen.fastest) {
    const double time = knee.figure("end") / fastest.figure("end");
    const double price = price_of(knee) / std::max(price_of(fastest), 1e-12);
    answer.push_back(
        fmt::format("Worth its price (the knee of the {} machines that no other beats in price and time): {} "
                    "a frame{} {} {:g}, "
                    "{:.2f} times the time of the fastest for {:.1f} % of its price: {}.",
                    chosen.front.size(), time_text(knee.figure("end")), speed_text(knee), unit,
                    price_of(knee), time, 100.0 * price, place_text(sweep, knee)));
    answer.push_back(fmt::format("What limits that one: {}.", limit_sentence(knee)));
  }
  if (const std::string steps = advice(sweep, knee); !steps.empty()) {
    answer.push_back(fmt::format("What to change there, one step at a time: {}.", steps));
  }
  if (sweep.points.size() < sweep.planned) {
    answer.push_back(
        fmt::format("{} of {} points have been timed so far; run `marti sweep` again for the rest.",
                    sweep.points.size(), sweep.planned));
  }
  return answer;
}

}  // namespace marti::studies
