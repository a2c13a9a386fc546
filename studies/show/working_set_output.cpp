#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/mapped.h"
#include "sim/statistics.h"
#include "studies/show/result_parts.h"
#include "studies/show/text_columns.h"
#include "studies/tables/text_units.h"

namespace marti::studies::show {

namespace {

using Json = nlohmann::ordered_json;
using processors::passes::CacheWorkingSet;
using processors::passes::WorkingSet;

struct Point {
  std::uint64_t size = 0;  // lines or ways
  std::int64_t misses = 0;
};

std::string_view name_of(const WorkingSet& set, std::size_t cache) {
  return set.caches.size() == 1 ? std::string_view("unified") : processors::machine::split_cache_names[cache];
}

double share_of(std::int64_t part, std::int64_t whole) { return sim::ratio(part, whole).value_or(0.0); }

// The sizes that `keep` wants, from one line to the power of two at which all that is left is compulsory.
template <class Keep>
std::vector<Point> sizes_of(const memory::StackHistogram& distances, const Keep& keep) {
  std::vector<Point> points;
  std::int64_t misses = distances.references;
  const std::uint64_t last = std::bit_ceil(std::max<std::uint64_t>(1, distances.enough()));
  for (std::uint64_t lines = 1; lines <= last; ++lines) {
    const std::int64_t hits = lines <= distances.hits.size() ? distances.hits[lines - 1] : 0;
    misses -= hits;
    if (std::has_single_bit(lines) || keep(lines, hits)) {
      points.push_back({lines, misses});
    }
  }
  return points;
}

std::vector<Point> powers_of_two(const memory::StackHistogram& distances) {
  return sizes_of(distances, [](std::uint64_t, std::int64_t) { return false; });
}

std::vector<Point> thinned(const memory::StackHistogram& distances) {
  std::uint64_t kept = 0;
  return sizes_of(distances, [&](std::uint64_t lines, std::int64_t hits) {
    const bool keep = lines == distances.enough() || (hits != 0 && lines - kept > kept / 256);
    kept = keep ? lines : kept;
    return keep;
  });
}

// Misses of caches with the machine's number of sets and 1, 2, ... ways. With one set these are all the
// sizes.
std::vector<Point> all_ways(const CacheWorkingSet& cache) {
  std::vector<Point> points;
  std::int64_t misses = cache.ways.references;
  for (std::size_t way = 0; way < cache.ways.hits.size(); ++way) {
    misses -= cache.ways.hits[way];
    points.push_back({way + 1, misses});
  }
  return points;
}

// The smallest fully associative cache that misses at most `tenths` tenths of the compulsory misses.
std::uint64_t lines_within(const memory::StackHistogram& distances, std::int64_t tenths) {
  const std::int64_t compulsory = distances.compulsory;
  return distances.lines_for(compulsory + compulsory * (tenths - 10) / 10);
}

std::string size_text(const WorkingSet& set, std::uint64_t lines) {
  return tables::bytes(static_cast<double>(lines) * set.line);
}

void cache_lines(std::string& text, const WorkingSet& set, std::size_t number) {
  const auto out = std::back_inserter(text);
  const CacheWorkingSet& cache = set.caches[number];
  const memory::StackHistogram& distances = cache.distances;
  const TextColumns table = {14, {12, 12, 15, 12, 16}};
  text += table.row("  " + std::string(name_of(set, number)),
                    {"lines", "bytes", "misses", "miss ratio", "of compulsory"});
  for (const Point& point : powers_of_two(distances)) {
    text +=
        table.row("", {std::to_string(point.size), size_text(set, point.size), std::to_string(point.misses),
                       fmt::format("{:.3f} %", 100.0 * share_of(point.misses, distances.references)),
                       fmt::format("{:.2f} x", share_of(point.misses, distances.compulsory))});
  }
  fmt::format_to(out, "  {:<12}2 x compulsory with {} ({} lines), 1.1 x with {} ({}), 1 x with {} ({})\n", "",
                 size_text(set, lines_within(distances, 20)), lines_within(distances, 20),
                 size_text(set, lines_within(distances, 11)), lines_within(distances, 11),
                 size_text(set, distances.enough()), distances.enough());
  if (cache.shape.sets > 1) {
    fmt::format_to(out, "  {:<12}{} sets, by ways:", "", cache.shape.sets);
    const char* separator = "";
    for (const Point& point : all_ways(cache)) {
      if (std::has_single_bit(point.size) || point.size == cache.shape.ways) {
        fmt::format_to(out, "{} {}{}: {:.3f} %", separator, point.size,
                       point.size == cache.shape.ways ? " (the machine's)" : "",
                       100.0 * share_of(point.misses, cache.ways.references));
        separator = ",";
      }
    }
    text += '\n';
  }
}

}  // namespace

nlohmann::ordered_json working_set_json(const run::RunResult& r) {
  if (!r.working_set) {
    return nullptr;
  }
  const WorkingSet& set = *r.working_set;
  const auto pair_json = [](const Point& point) { return Json{point.size, point.misses}; };
  Json caches = Json::array();
  for (std::size_t i = 0; i < set.caches.size(); ++i) {
    const CacheWorkingSet& cache = set.caches[i];
    caches.push_back({{"cache", name_of(set, i)},
                      {"references", cache.distances.references},
                      {"compulsory", cache.distances.compulsory},
                      {"lines_for_2_x_compulsory", lines_within(cache.distances, 20)},
                      {"lines_for_1_1_x_compulsory", lines_within(cache.distances, 11)},
                      {"lines_for_compulsory", cache.distances.enough()},
                      {"fully_associative", sim::mapped(powers_of_two(cache.distances), pair_json)},
                      {"sets", cache.shape.sets},
                      {"machine_ways", cache.shape.ways},
                      {"ways", sim::mapped(all_ways(cache), pair_json)}});
  }
  return {{"line", set.line}, {"any_cache", set.any_cache}, {"caches", caches}};
}

std::string working_set_lines(const run::RunResult& r) {
  if (!r.working_set) {
    return {};
  }
  const WorkingSet& set = *r.working_set;
  std::string text = fmt::format(
      "\nworking set   first-level LRU caches of every size, lines of {} bytes; exact {}\n", set.line,
      set.any_cache ? "for machines with any of them"
                    : "for the packets as handed out here:\n"
                      "              dynamic assignment would hand them out otherwise with another cache");
  for (std::size_t i = 0; i < set.caches.size(); ++i) {
    cache_lines(text, set, i);
  }
  return text;
}

tables::Table working_set_table(const WorkingSet& set) {
  tables::Table table("working_set", "Misses of first-level LRU caches by size and by ways",
                      {tables::text_column("cache", "the unified cache, or which of the split ones"),
                       tables::count_column("sets", "sets; 1: fully associative"),
                       tables::count_column("ways", "lines of a set"),
                       tables::integer_column("bytes", "byte", "size of the cache"),
                       tables::count_column("misses", "misses of all nodes' caches"),
                       tables::real_column("miss_ratio", "fraction", "misses of all references")});
  for (std::size_t i = 0; i < set.caches.size(); ++i) {
    const CacheWorkingSet& cache = set.caches[i];
    const auto add = [&](std::uint32_t sets, const Point& point) {
      table.add_row({name_of(set, i), sets, point.size, point.size * sets * set.line, point.misses,
                     share_of(point.misses, cache.distances.references)});
    };
    for (const Point& point : thinned(cache.distances)) {
      add(1, point);
    }
    for (const Point& point : all_ways(cache)) {
      add(cache.shape.sets, point);
    }
  }
  return table;
}

}  // namespace marti::studies::show
