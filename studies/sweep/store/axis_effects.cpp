#include "studies/sweep/store/axis_effects.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "sim/joined.h"
#include "studies/sweep/plan/axis_text.h"
#include "studies/tables/cell_number.h"
#include "studies/tables/text_units.h"

namespace marti::studies::sweep {

namespace {

constexpr std::size_t most_named = 4;

// Means of what is left of each point, by the value of something.
std::vector<double> means(std::span<const double> left, std::size_t values,
                          const std::function<std::size_t(std::size_t)>& value_of) {
  std::vector<double> sums(values, 0.0);
  std::vector<double> counts(values, 0.0);
  for (std::size_t point = 0; point < left.size(); ++point) {
    sums[value_of(point)] += left[point];
    counts[value_of(point)] += 1.0;
  }
  for (std::size_t value = 0; value < values; ++value) {
    sums[value] = counts[value] > 0.0 ? sums[value] / counts[value] : 0.0;
  }
  return sums;
}

// The parts of each axis' values, by Gauss and Seidel's method; takes them away from `left`. One round is
// enough where all values are combined with all others.
std::vector<std::vector<double>> fit(std::span<const AxisColumn> axes, std::vector<double>& left) {
  constexpr int most_rounds = 100;
  constexpr double enough = 1e-9;
  std::vector<std::vector<double>> parts;
  for (const AxisColumn& axis : axes) {
    parts.emplace_back(axis.values.size(), 0.0);
  }
  double changed = 1.0;
  for (int round = 0; round < most_rounds && changed > enough; ++round) {
    changed = 0.0;
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
      const std::vector<std::size_t>& index = axes[axis].index;
      const std::vector<double> more =
          means(left, parts[axis].size(), [&](std::size_t point) { return index[point]; });
      for (std::size_t point = 0; point < left.size(); ++point) {
        left[point] -= more[index[point]];
      }
      for (std::size_t value = 0; value < more.size(); ++value) {
        parts[axis][value] += more[value];
        changed = std::max(changed, std::abs(more[value]));
      }
    }
  }
  return parts;
}

AxisEffect effect_of(const AxisColumn& axis, const std::vector<double>& parts) {
  const auto [least, most] = std::ranges::minmax_element(parts);
  std::vector<std::string> names = {axis.name};
  names.insert(names.end(), axis.followers.begin(), axis.followers.end());
  // Parts are relative to the mean of the points, in which each value counts as often as it occurs.
  double mean = 0.0;
  for (const std::size_t value : axis.index) {
    mean += parts[value] / static_cast<double>(axis.index.size());
  }
  const auto text = [&](auto at) {
    return axis_text(axis.name, axis.values[static_cast<std::size_t>(at - parts.begin())]);
  };
  return {sim::joined(names, " + "), text(least), text(most), std::exp(*least - mean),
          std::exp(*most - mean)};
}

Interaction interaction_of(const AxisColumn& a, const AxisColumn& b, std::span<const double> left) {
  const std::vector<double> cells = means(left, a.values.size() * b.values.size(), [&](std::size_t point) {
    return a.index[point] * b.values.size() + b.index[point];
  });
  const auto [least, most] = std::ranges::minmax_element(cells);
  return {a.name, b.name, std::exp(*most - *least)};
}

}  // namespace

AxisEffects axis_effects(std::span<const AxisColumn> axes, std::span<const double> times) {
  AxisEffects effects;
  std::vector<double> left;
  double mean = 0.0;
  for (const double time : times) {
    left.push_back(std::log(time));
    mean += left.back() / static_cast<double>(times.size());
  }
  for (double& each : left) {
    each -= mean;
  }
  const std::vector<std::vector<double>> parts = fit(axes, left);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    effects.axes.push_back(effect_of(axes[axis], parts[axis]));
    least = std::min(least, effects.axes.back().ratio());
  }
  for (std::size_t a = 0; a < axes.size(); ++a) {
    for (std::size_t b = a + 1; b < axes.size(); ++b) {
      // With more combinations than points most have one point, which tells nothing of the two axes.
      if (axes[a].values.size() * axes[b].values.size() > times.size()) {
        continue;
      }
      if (const Interaction both = interaction_of(axes[a], axes[b], left); both.ratio > least) {
        effects.interactions.push_back(both);
      }
    }
  }
  std::ranges::stable_sort(effects.axes, std::greater<>(), &AxisEffect::ratio);
  std::ranges::stable_sort(effects.interactions, std::greater<>(), &Interaction::ratio);
  return effects;
}

AxisEffects axis_effects(const SweepReader& reader) {
  std::vector<std::vector<tables::Cell>> values;
  std::vector<double> times;
  const std::vector<std::string> figures = {"end"};
  reader.for_each_point(figures, [&](const StoredPoint& point, std::span<const tables::Cell> cells) {
    const double time = tables::number_of(cells[0]).value_or(0.0);
    if (time > 0.0) {
      values.push_back(point.values);
      times.push_back(time);
    }
  });
  AxisEffects effects = axis_effects(order_axes(reader.axes(), values), times);
  effects.noise = reader.noise();
  return effects;
}

std::string effects_text(const AxisEffects& effects) {
  std::vector<std::string> axes;
  std::size_t small = 0;
  for (const AxisEffect& axis : effects.axes) {
    if (axis.ratio() <= 1.0 + effects.noise.band) {
      ++small;
    } else if (axes.size() < most_named) {
      axes.push_back(fmt::format("{} {:.2f} times", axis.axis, axis.ratio()));
    }
  }
  std::string text = sim::joined(axes, ", ");
  if (effects.axes.size() - small > most_named) {
    text += fmt::format(", {} more", effects.axes.size() - small - most_named);
  }
  if (small > 0) {
    text += fmt::format("{}{} no more than {}, {}", text.empty() ? "" : ", ",
                        small == 1 ? "one axis" : fmt::format("{} axes", small), effects.noise.cause(),
                        tables::figure_text(effects.noise.band, "fraction", "-"));
  }
  if (!effects.interactions.empty() && effects.interactions.front().ratio > 1.0 + effects.noise.band) {
    const Interaction& largest = effects.interactions.front();
    text += fmt::format("; {} and {} together {:.2f} times", largest.first, largest.second, largest.ratio);
  }
  return text;
}

}  // namespace marti::studies::sweep
