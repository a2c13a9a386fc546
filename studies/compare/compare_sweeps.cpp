#include "studies/compare/compare_sweeps.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "studies/compare/compare_text.h"
#include "studies/compare/differences.h"
#include "studies/sweep/store/sweep_reader.h"
#include "studies/tables/json_table.h"
#include "studies/tables/text_units.h"

namespace marti::studies {

namespace {

using Json = nlohmann::ordered_json;

// A machine of the plan, with the first point that asks for it.
struct Machine {
  std::int64_t ordinal = 0;
  std::int64_t id = 0;
  bool done = false;
};

struct Sweep {
  explicit Sweep(const std::filesystem::path& file) : reader(file) {
    std::map<std::int64_t, bool> seen;
    for (const StoredPoint& point : reader.points()) {
      if (!seen.emplace(point.machine, true).second) {
        continue;
      }
      std::string settings;
      for (const auto& [key, value] : reader.settings(point.machine)) {
        settings += key;
        settings += '=';
        settings += value;
        settings += '\n';
      }
      machines.emplace(settings, Machine{point.ordinal, point.machine, point.done});
    }
  }

  SweepReader reader;
  std::map<std::string, Machine> machines;  // by settings
};

// What is known of one counter over all machines that both have.
struct CounterDifference {
  Difference largest;        // the largest relative one; its name is the counter's
  std::int64_t point_a = 0;  // where
  std::int64_t point_b = 0;
  std::size_t machines = 0;  // that differ in it
};

struct SweepDifferences {
  std::vector<std::int64_t> only_a;  // points, ascending
  std::vector<std::int64_t> only_b;
  std::size_t both = 0;      // machines
  std::size_t compared = 0;  // of these, timed in both
  std::size_t equal = 0;     // of these, equal in every counter
  std::map<std::string, CounterDifference> counters;
};

void compare_machine(const Sweep& a, const Sweep& b, const Machine& from, const Machine& to,
                     SweepDifferences& found) {
  ++found.compared;
  ComparedResult one;
  ComparedResult other;
  add_counters(*a.reader.read_result(from.id), one.figures);
  add_counters(*b.reader.read_result(to.id), other.figures);
  const Differences differences = differences_of(one, other);
  found.equal += differences.numbers.empty() && differences.one_side.empty() ? 1 : 0;
  const auto enter = [&](const Difference& difference) {
    CounterDifference& counter = found.counters[difference.name];
    ++counter.machines;
    const double size = difference.relative().value_or(2.0);
    // The lowest point on ties, in whatever order machines come.
    const bool larger = counter.machines == 1 || size > counter.largest.relative().value_or(2.0) ||
                        (size == counter.largest.relative().value_or(2.0) && from.ordinal < counter.point_a);
    if (larger) {
      counter.largest = difference;
      counter.point_a = from.ordinal;
      counter.point_b = to.ordinal;
    }
  };
  std::for_each(differences.numbers.begin(), differences.numbers.end(), enter);
  std::for_each(differences.one_side.begin(), differences.one_side.end(), enter);
}

SweepDifferences differences_of(const Sweep& a, const Sweep& b) {
  SweepDifferences found;
  for (const auto& [settings, machine] : a.machines) {
    const auto other = b.machines.find(settings);
    if (other == b.machines.end()) {
      found.only_a.push_back(machine.ordinal);
      continue;
    }
    ++found.both;
    if (machine.done && other->second.done) {
      compare_machine(a, b, machine, other->second, found);
    }
  }
  for (const auto& [settings, machine] : b.machines) {
    if (!a.machines.contains(settings)) {
      found.only_b.push_back(machine.ordinal);
    }
  }
  std::sort(found.only_a.begin(), found.only_a.end());
  std::sort(found.only_b.begin(), found.only_b.end());
  return found;
}

std::vector<CounterDifference> sorted(const SweepDifferences& found) {
  std::vector<CounterDifference> counters;
  for (const auto& [name, counter] : found.counters) {
    counters.push_back(counter);
  }
  std::stable_sort(counters.begin(), counters.end(), [](const auto& x, const auto& y) {
    return x.largest.relative().value_or(2.0) > y.largest.relative().value_or(2.0);
  });
  return counters;
}

void list_points(std::string& text, const char* whose, const std::vector<std::int64_t>& points, bool all) {
  if (points.empty()) {
    return;
  }
  const std::size_t shown = all ? points.size() : std::min(points.size(), most_lines);
  text += fmt::format("  only in {}: point", whose);
  for (std::size_t i = 0; i < shown; ++i) {
    text += (i == 0 ? " " : ", ") + std::to_string(points[i]);
  }
  text += shown < points.size() ? fmt::format(" and {} more\n", points.size() - shown) : "\n";
}

std::string text_of(const std::string& a, const std::string& b, const Sweep& from, const Sweep& to,
                    const SweepDifferences& found, bool all) {
  std::string text = fmt::format("A  {}\nB  {}\n\n", a, b);
  const auto out = std::back_inserter(text);
  if (from.reader.version() != to.reader.version()) {
    fmt::format_to(out, "version        A is of {}, B of {}\n", from.reader.version(), to.reader.version());
  }
  fmt::format_to(out, "machines       {} in both, {} of them timed in both; {} only in A, {} only in B\n",
                 found.both, found.compared, found.only_a.size(), found.only_b.size());
  list_points(text, "A", found.only_a, all);
  list_points(text, "B", found.only_b, all);
  fmt::format_to(out, "results        {} equal in every counter, {} not\n", found.equal,
                 found.compared - found.equal);
  const std::vector<CounterDifference> counters = sorted(found);
  fmt::format_to(out, "counters       {} differ, {} equal\n", counters.size(),
                 counted_figures().size() - counters.size());
  if (counters.empty()) {
    return text;
  }
  fmt::format_to(out, "\n  {:<32}{:>9}  the largest difference, at points of A and B\n", "counter",
                 "machines");
  const std::size_t shown = all ? counters.size() : std::min(counters.size(), most_lines);
  for (std::size_t i = 0; i < shown; ++i) {
    const CounterDifference& counter = counters[i];
    fmt::format_to(out, "  {:<32}{:>9}  {:>11}  {} to {}, at {} and {}\n", counter.largest.name,
                   counter.machines, change_of(counter.largest), short_text(counter.largest.a, "-"),
                   short_text(counter.largest.b, "-"), counter.point_a, counter.point_b);
  }
  if (shown < counters.size()) {
    fmt::format_to(out, "  and {} more: --all lists them\n", counters.size() - shown);
  }
  return text;
}

std::string json_of(const std::string& a, const std::string& b, const Sweep& from, const Sweep& to,
                    const SweepDifferences& found) {
  Json counters = Json::array();
  for (const CounterDifference& counter : sorted(found)) {
    Json& object = counters.emplace_back(studies::json_of(counter.largest));
    object["point_a"] = counter.point_a;
    object["point_b"] = counter.point_b;
    object["machines"] = counter.machines;
  }
  const Json object = {{"a", {{"name", a}, {"version", from.reader.version()}}},
                       {"b", {{"name", b}, {"version", to.reader.version()}}},
                       {"machines_in_both", found.both},
                       {"timed_in_both", found.compared},
                       {"equal_machines", found.equal},
                       {"points_only_in_a", found.only_a},
                       {"points_only_in_b", found.only_b},
                       {"counters", counters}};
  return json_text(object);
}

}  // namespace

std::string compare_sweeps(const std::filesystem::path& a, const std::filesystem::path& b,
                           const CompareOptions& options) {
  const Sweep from(a);
  const Sweep to(b);
  const SweepDifferences found = differences_of(from, to);
  const std::string name_a = a.string();
  const std::string name_b = b.string();
  return options.json ? json_of(name_a, name_b, from, to, found)
                      : text_of(name_a, name_b, from, to, found, options.all);
}

}  // namespace marti::studies
