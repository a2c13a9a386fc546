#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>

#include "sim/mapped.h"
#include "studies/keys/setting_value.h"
#include "studies/show/json_parts.h"
#include "studies/show/result_parts.h"
#include "studies/tables/text_units.h"

namespace marti::studies::show {

namespace {

using Json = nlohmann::ordered_json;

const char* name_of(helps::Outcome outcome) {
  switch (outcome) {
    case helps::Outcome::measured:
      return "measured";
    case helps::Outcome::needless:
      return "needless";
    case helps::Outcome::work:
      return "too much work";
    case helps::Outcome::memory:
      return "too much memory";
    case helps::Outcome::uncounted:
      break;
  }
  return "too long to count";
}

std::string other_steps(std::size_t count) { return tables::counted(count, "other step"); }

Json change_json(const helps::WhatHelps& what, const std::optional<helps::MeasuredChange>& change) {
  if (!change) {
    return nullptr;
  }
  Json keys = Json::object();
  Json set = Json::array();
  for (const helps::KeyChange& key : change->keys) {
    keys[key.key] = {{"from", keys::setting_value(key.key, key.from)},
                     {"to", keys::setting_value(key.key, key.to)}};
    set.push_back(key.key + "=" + keys::plain_setting(key.to));
  }
  return {{"text", helps::describe(change->keys)},
          {"keys", keys},
          {"set", set},
          {"outcome", name_of(change->outcome)},
          {"frame_time_ps", change->end ? Json(*change->end) : Json(nullptr)},
          {"saved", optional_json(change->saved)},
          {"gain", optional_json(helps::gain_of(what, *change))},
          {"most_saved", change->most_saved},
          {"within_noise", what.noise ? Json(helps::within_noise(what, *change)) : Json(nullptr)},
          {"price", optional_json(change->price)}};
}

}  // namespace

nlohmann::ordered_json helps_json(const run::RunResult& r) {
  if (!r.helps) {
    return nullptr;
  }
  const helps::WhatHelps& what = *r.helps;
  const Json resources = sim::mapped(what.helps, [&](const helps::Help& help) {
    return Json{{"resource", help.name},
                {"step", change_json(what, help.step)},
                {"best", change_json(what, help.best)}};
  });
  Json pair = nullptr;
  if (what.pair) {
    pair = {{"first", what.pair->first},
            {"second", what.pair->second},
            {"step", change_json(what, what.pair->step)}};
  }
  Json noise = nullptr;
  if (what.noise) {
    noise = {{"replays", what.noise->replays},
             {"shortest_ps", what.noise->shortest},
             {"longest_ps", what.noise->longest},
             {"band", helps::band_of(*what.noise, what.end)}};
  }
  return {{"measured", what.measured},
          {"sentence", what.sentence},
          {"noise", noise},
          {"pair", pair},
          {"resources", resources}};
}

std::string helps_lines(const run::RunResult& r) {
  if (!r.helps) {
    return {};
  }
  const helps::WhatHelps& what = *r.helps;
  std::string text = fmt::format("\nwhat helps    {}\n", what.sentence);
  const auto out = std::back_inserter(text);
  if (!what.measured) {
    return text;
  }
  const std::vector<const helps::Help*> helps = helps::best_helps(what);
  const char* label = "then";
  for (const helps::Help* const help : helps) {
    if (!helps::ties_with(*helps[0], *help)) {
      fmt::format_to(out, "  {:<12}{}{}\n", label, helps::gain_text(*help),
                     helps::doubt_text(what, *help->step));
      label = "";
    }
  }
  if (what.noise || r.timed.packets > 1) {
    fmt::format_to(out, "  {:<12}{}\n", "noise",
                   what.noise ? helps::noise_text(*what.noise, what.end)
                              : "of other orders of packets not measured, within a tenth of the run's work; "
                                "--what-helps measures it");
  }
  label = "not tried";
  const helps::Unreplayed left = helps::unreplayed(what);
  if (left.needless > 0) {
    fmt::format_to(out, "  {:<12}{} that can save {} at most\n", label, other_steps(left.needless),
                   tables::rough_percent(left.most_saved));
    label = "";
  }
  if (left.work > 0) {
    fmt::format_to(out, "  {:<12}{}, which would take longer than the run; --what-helps tries all\n", label,
                   other_steps(left.work));
    label = "";
  }
  if (left.memory > 0) {
    fmt::format_to(out, "  {:<12}{}, which would take too much memory\n", label, other_steps(left.memory));
  }
  return text;
}

}  // namespace marti::studies::show
