// Pieces that all parts of `result.json` are made of.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sim/mapped.h"
#include "sim/statistics.h"
#include "studies/tables/json_table.h"

namespace marti::studies::show {

/// The value, or null.
[[nodiscard]] inline nlohmann::ordered_json optional_json(std::optional<double> value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

/// The name of a counter in results for programs; the name of a time ends in its unit, "_ps".
template <class S>
[[nodiscard]] std::string json_name(const sim::Counter<S>& counter) {
  return std::string(counter.name) + (counter.unit == "ps" ? "_ps" : "");
}

/// Adds every declared counter to an object, under its name behind `prefix`.
template <class S>
void add_counters(nlohmann::ordered_json& object, const S& statistics, const std::string& prefix = {}) {
  sim::for_each_counter(statistics, [&](const sim::Counter<S>& counter, auto value) {
    object[prefix + json_name(counter)] = tables::json_of(tables::Cell(value));
  });
}

/// An object of every declared counter.
template <class S>
[[nodiscard]] nlohmann::ordered_json counters_json(const S& statistics) {
  nlohmann::ordered_json object = nlohmann::ordered_json::object();
  add_counters(object, statistics);
  return object;
}

/// Beyond this many nodes, clusters, banks or caches their own figures are left out: sums remain.
inline constexpr std::size_t most_listed = 4096;

/// What `make` gives for each of them; null where there are too many.
template <class List, class Make>
[[nodiscard]] nlohmann::ordered_json list_json(const List& all, const Make& make) {
  return all.size() > most_listed ? nlohmann::ordered_json() : nlohmann::ordered_json(sim::mapped(all, make));
}

/// The counters of each of them; null where there are too many.
template <class List>
[[nodiscard]] nlohmann::ordered_json counters_list(const List& all) {
  return list_json(all, [](const auto& each) { return counters_json(each); });
}

}  // namespace marti::studies::show
