#include "studies/compare/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "sim/joined.h"
#include "studies/compare/compare_text.h"
#include "studies/compare/differences.h"
#include "studies/report/model/answer_text.h"
#include "studies/tables/cell_number.h"
#include "studies/tables/text_units.h"

namespace marti::studies::compare {

namespace {

// A sentence names no more than this of a list.
constexpr std::size_t most_named = 6;
// Activities are named until they explain this part of the change, and no more than so many.
constexpr double enough = 0.9;
constexpr std::size_t most_activities = 3;
// Beyond this part of the change, what goes the other way is told too.
constexpr double most_against = 0.25;

std::optional<double> figure(const ComparedResult& result, const std::string& name) {
  const auto at = result.figures.find(name);
  return at == result.figures.end() ? std::nullopt : tables::number_of(at->second);
}

// "cache.size is 16 KiB in A and 4 KiB in B".
std::string settings_sentence(const std::vector<Difference>& settings) {
  std::vector<std::string> parts;
  for (const Difference& setting : settings) {
    // A setting that only one machine uses follows from another one.
    if (setting.a != tables::Cell() && setting.b != tables::Cell() && parts.size() < most_named) {
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

// Where the activities pull in both directions: the largest changes of either.
std::string both_ways(const ComparedPair& pair) {
  std::vector<std::string> parts;
  for (const ActivityTime& time : pair.times) {
    if (parts.size() == most_activities) {
      break;
    }
    parts.push_back(fmt::format("{} ({})", report::words(time.activity),
                                tables::signed_seconds(std::llround(time.change))));
  }
  return "What changes most, as the mean of a node: " + sim::listed(parts) + ".";
}

// Which activities the change of the frame time comes from.
std::string why(const ComparedPair& pair, std::int64_t change) {
  const double all = static_cast<double>(change);
  double against = 0.0;
  for (const ActivityTime& time : pair.times) {
    against += time.change * all < 0.0 ? std::abs(time.change) : 0.0;
  }
  if (against > most_against * std::abs(all)) {
    return both_ways(pair);
  }
  std::vector<std::string> parts;
  double explained = 0.0;
  for (const ActivityTime& time : pair.times) {
    if (time.change * all <= 0.0) {
      continue;  // goes the other way
    }
    if (parts.size() == most_activities || explained >= enough * std::abs(all)) {
      break;
    }
    explained += std::abs(time.change);
    parts.push_back(fmt::format("{} {}{} ({})", tables::seconds(std::llround(std::abs(time.change))),
                                parts.empty() ? "are " : "", report::words(time.activity),
                                tables::rough_percent(time.change / all)));
  }
  if (parts.empty()) {
    return {};
  }
  return fmt::format("Of the {} {}, {}, as the mean of a node.", tables::seconds(std::abs(change)),
                     change > 0 ? "more" : "less", sim::listed(parts));
}

// Whether the difference is less than another order of packets makes, where that is known of either result.
std::string noise_sentence(const ComparedPair& pair, std::int64_t a, std::int64_t b) {
  const double band = std::max(pair.a.noise.value_or(0.0), pair.b.noise.value_or(0.0));
  const double difference = std::abs(static_cast<double>(b) / static_cast<double>(a) - 1.0);
  if (a == b || difference > band) {
    return {};
  }
  return fmt::format(
      "That is no more than another order of packets does, {}: it does not say which machine is faster.",
      tables::percent(band));
}

std::string misses_sentence(const ComparedPair& pair) {
  const std::optional<double> a = figure(pair.a, "misses");
  const std::optional<double> b = figure(pair.b, "misses");
  const std::optional<double> ratio_a = figure(pair.a, "hit_ratio");
  const std::optional<double> ratio_b = figure(pair.b, "hit_ratio");
  constexpr double least = 0.01;  // a smaller change is not worth a sentence
  if (!a || !b || !ratio_a || !ratio_b || *a <= 0.0 || std::abs(*b - *a) < least * *a) {
    return {};
  }
  return fmt::format(
      "The nodes of B miss {} times as often ({} lines, {} in A); their hit ratio is {}, {} in A.",
      tables::times(*b / *a), tables::figure_text(pair.b.figures.at("misses"), "1", "-"),
      tables::figure_text(pair.a.figures.at("misses"), "1", "-"), tables::percent(*ratio_b),
      tables::percent(*ratio_a));
}

}  // namespace

ComparedPair compared_pair(ComparedResult a, ComparedResult b) {
  ComparedPair pair;
  pair.differences = differences_of(a, b);
  pair.same_frame = same_frame(a, b);
  if (pair.same_frame) {
    pair.times = activity_times(a, b);
  }
  pair.a = std::move(a);
  pair.b = std::move(b);
  return pair;
}

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

std::vector<std::string> verdict_of(const ComparedPair& pair) {
  const std::optional<std::int64_t> a = frame_time_if_any(pair.a);
  const std::optional<std::int64_t> b = frame_time_if_any(pair.b);
  if (!a || !b) {
    return {};
  }
  const std::vector<Difference>& settings = pair.differences.settings;
  std::vector<std::string> sentences;
  const auto say = [&sentences](const std::string& sentence) {
    if (!sentence.empty()) {
      sentences.push_back(sentence);
    }
  };
  if (!pair.same_frame) {
    const std::vector<Difference> of_frame = frame_settings(settings);
    say(fmt::format(
        "A and B render different frames{}: their times, {} and {}, are of different work and say "
        "nothing about the machines.",
        of_frame.empty() ? "" : ", by " + settings_sentence(of_frame), tables::seconds(*a),
        tables::seconds(*b)));
  } else {
    say(speed_text(*a, *b) + ".");
    say(noise_sentence(pair, *a, *b));
    say(*a == *b ? std::string() : why(pair, *b - *a));
    say(misses_sentence(pair));
    say(settings.empty() ? "No setting differs." : "What differs: " + settings_sentence(settings) + ".");
  }
  return sentences;
}

std::vector<std::string> helps_of(const ComparedPair& pair) {
  std::vector<std::string> sentences;
  for (const ComparedResult* result : {&pair.a, &pair.b}) {
    if (!result->helps.empty()) {
      sentences.push_back(fmt::format("What helps {}: {}.", result == &pair.a ? "A" : "B", result->helps));
    }
  }
  return sentences;
}

}  // namespace marti::studies::compare
