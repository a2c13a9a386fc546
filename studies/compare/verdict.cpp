// What a comparison says in sentences: which is faster, by how much and why.
#include "studies/compare/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string_view>

#include "sim/joined.h"
#include "studies/report/model/answer_text.h"
#include "studies/tables/cell_number.h"
#include "studies/tables/text_units.h"

namespace marti::studies::compare {

namespace {

// A sentence names no more than so much of a list.
constexpr std::size_t most_named = 6;
constexpr std::size_t most_activities = 3;

// A figure with its values in A and B, whether they differ or not; null where neither has it.
const FigureDifference* figure(const Comparison& found, std::string_view name) {
  for (const std::vector<FigureDifference>* figures : {&found.figures, &found.equal}) {
    const auto at = std::ranges::find(*figures, name, &FigureDifference::name);
    if (at != figures->end()) {
      return &*at;
    }
  }
  return nullptr;
}

// "cache.size is 16 KiB in A and 4 KiB in B".
std::string settings_sentence(const std::vector<Difference>& settings) {
  std::vector<std::string> parts;
  for (const Difference& setting : settings) {
    // A setting that only one machine uses follows from another one.
    if (!setting.is_one_sided() && parts.size() < most_named) {
      parts.push_back(fmt::format("{} ({} in A, {} in B)", setting.name, setting_text(setting.a),
                                  setting_text(setting.b)));
    }
  }
  if (parts.empty()) {
    return tables::counted(settings.size(), "setting");
  }
  if (parts.size() < settings.size()) {
    parts.push_back(fmt::format("{} more", settings.size() - parts.size()));
  }
  return sim::listed(parts);
}

// Where the nodes' time changes most.
std::string changes_sentence(const Comparison& found) {
  std::vector<std::string> parts;
  for (const ActivityTime& time : found.times) {
    if (time.change != 0.0 && parts.size() < most_activities) {
      parts.push_back(fmt::format("{} ({}, {} of A's frame)", report::words(time.activity),
                                  tables::signed_seconds(std::llround(time.change)),
                                  tables::signed_percent(time.of_frame)));
    }
  }
  return parts.empty() ? ""
                       : fmt::format("What changes most, as the mean of a node{}: {}.",
                                     found.join == Join::one ? "" : " and of all points", sim::listed(parts));
}

// Where differences are no more than the noise, where that is known of either result.
std::string noise_sentence(const Comparison& found) {
  const std::size_t points = found.points_within_noise();
  if (points == 0) {
    return {};
  }
  const bool one = found.join == Join::one;
  return fmt::format("{} no more than {} does, {}{}: it does not say which machine is faster{}.",
                     one ? "That is" : fmt::format("At {} of these points the difference is", points),
                     found.noise.cause(), one ? "" : "up to ", tables::percent(found.noise.band),
                     one ? "" : " there");
}

std::string misses_sentence(const Comparison& found) {
  const FigureDifference* const misses = figure(found, "misses");
  const FigureDifference* const ratio = figure(found, "hit_ratio");
  if (misses == nullptr || ratio == nullptr || !misses->relative() || !ratio->relative()) {
    return {};
  }
  const double a = *tables::number_of(misses->a);
  const double b = *tables::number_of(misses->b);
  constexpr double least = 0.01;  // a smaller change is not worth a sentence
  if (a <= 0.0 || std::abs(b - a) < least * a) {
    return {};
  }
  return fmt::format(
      "The nodes of B miss {} times as often ({} lines, {} in A); their hit ratio is {}, {} in A.",
      tables::times(b / a), tables::figure_text(misses->b, "1", "-"),
      tables::figure_text(misses->a, "1", "-"), tables::percent(*tables::number_of(ratio->b)),
      tables::percent(*tables::number_of(ratio->a)));
}

// "B is slower: its frame takes 69.061 ms, that of A 40.858 ms, 1.69 times as long (+69.0 %)".
std::string speed_text(std::int64_t a, std::int64_t b) {
  if (a == b) {
    return fmt::format("A and B are equally fast: a frame takes {}", tables::seconds(a));
  }
  const double ratio = static_cast<double>(b) / static_cast<double>(a);
  return fmt::format("B is {}: its frame takes {}, that of A {}, {} times as {} ({})",
                     b < a ? "faster" : "slower", tables::seconds(b), tables::seconds(a),
                     tables::times(b < a ? 1.0 / ratio : ratio), b < a ? "fast" : "long",
                     tables::signed_percent(ratio - 1.0));
}

// "point 10 of A (machine.nodes 8, cache.size 4 KiB)".
std::string point_text(const Comparison& found, const JoinedPoint& point) {
  return fmt::format("point {} of {}{}", found.point(point), found.sweep_is_a ? "A" : "B",
                     point.name.empty() ? "" : " (" + point.name + ")");
}

using Sentences = std::vector<std::string>;

Sentences verdict_of_two(const Comparison& found) {
  const std::int64_t a = found.points.front().end_a;
  const std::int64_t b = found.points.front().end_b;
  if (a == 0 || b == 0) {
    return {};
  }
  if (found.comparable == 0) {
    return {fmt::format(
        "A and B render different frames{}: their times, {} and {}, are of different work and say "
        "nothing about the machines.",
        found.frame.empty() ? "" : ", by " + settings_sentence(found.frame), tables::seconds(a),
        tables::seconds(b))};
  }
  Sentences sentences = {
      speed_text(a, b) + ".", noise_sentence(found), a == b ? "" : changes_sentence(found),
      misses_sentence(found),
      found.alike.empty() ? "No setting differs." : "What differs: " + settings_sentence(found.alike) + "."};
  std::erase(sentences, "");
  return sentences;
}

// How many comparable points are faster in B, equal, slower; where B gains and loses most; and the mean.
void say_which_is_faster(const Comparison& found, Sentences& sentences) {
  const std::span<const JoinedPoint> points(found.points.data(), found.comparable);
  const auto count = [&](auto is) { return std::ranges::count_if(points, is); };
  sentences.push_back(fmt::format("Of {}{}, B is faster at {}, as fast as A at {} and slower at {}.",
                                  tables::counted(points.size(), "point"),
                                  found.join == Join::each ? "" : " that both have",
                                  count([](const JoinedPoint& point) { return point.end_b < point.end_a; }),
                                  count([](const JoinedPoint& point) { return point.end_b == point.end_a; }),
                                  count([](const JoinedPoint& point) { return point.end_b > point.end_a; })));
  sentences.push_back(noise_sentence(found));
  const auto [best, worst] = std::ranges::minmax_element(points, {}, &JoinedPoint::ratio);
  const auto say = [&](const char* what, const JoinedPoint& point) {
    sentences.push_back(fmt::format("B {} most at {}: {}.", what, point_text(found, point),
                                    speed_text(point.end_a, point.end_b)));
  };
  if (best->end_b < best->end_a) {
    say("gains", *best);
  }
  if (worst->end_b > worst->end_a) {
    say("loses", *worst);
  }
  if (best->ratio() != worst->ratio()) {
    sentences.push_back(fmt::format("In the geometric mean B takes {} times as long as A.",
                                    tables::times(*mean_ratio(found))));
    sentences.push_back(changes_sentence(found));
  }
  std::erase(sentences, "");
}

// The machine of a sweep that is most like the result's.
std::string nearest_sentence(const Comparison& found) {
  const JoinedPoint& nearest = found.points[found.nearest];
  return fmt::format("The nearest machine is that of {}, which differs in {}: its frame takes {}{}.",
                     point_text(found, nearest), tables::counted(nearest.distance, "setting"),
                     tables::seconds(found.end(nearest)),
                     nearest.same_frame ? fmt::format(", B / A = {:.4f}", nearest.ratio()) : "");
}

}  // namespace

Sentences verdict_of(const Comparison& found) {
  if (found.join == Join::one) {
    return verdict_of_two(found);
  }
  if (found.points.empty()) {
    return {"No point is timed in both sweeps, so there is nothing to compare."};
  }
  Sentences sentences;
  if (found.comparable > 0) {
    say_which_is_faster(found, sentences);
  }
  if (const std::size_t others = found.points.size() - found.comparable; others > 0) {
    sentences.push_back(fmt::format("{} {} different frames: their times say nothing about the machines.",
                                    tables::counted(others, "joined point"),
                                    others == 1 ? "renders" : "render"));
  }
  if (found.equal_points == found.points.size()) {
    sentences.emplace_back("All points are equal in every counter.");
  }
  if (found.join == Join::each) {
    sentences.push_back(nearest_sentence(found));
  }
  return sentences;
}

Sentences helps_of(const Comparison& found) {
  Sentences sentences;
  for (const Side* side : {&found.a, &found.b}) {
    if (!side->helps.empty()) {
      sentences.push_back(fmt::format("What helps {}: {}.", side == &found.a ? "A" : "B", side->helps));
    }
  }
  return sentences;
}

std::optional<double> mean_ratio(const Comparison& found) {
  double sum = 0.0;
  for (std::size_t i = 0; i < found.comparable; ++i) {
    sum += std::log(found.points[i].ratio());
  }
  return found.comparable == 0 ? std::nullopt
                               : std::optional(std::exp(sum / static_cast<double>(found.comparable)));
}

}  // namespace marti::studies::compare
