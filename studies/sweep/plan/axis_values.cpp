#include "studies/sweep/plan/axis_values.h"

#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <type_traits>
#include <unordered_set>
#include <utility>

#include "sim/config_errors.h"
#include "sim/error.h"
#include "sim/key_value.h"
#include "sim/nearest.h"
#include "sim/parse_number.h"
#include "sim/rounded.h"
#include "sim/shown.h"
#include "sim/trim.h"
#include "studies/sweep/plan/sweep_table.h"

namespace marti::studies::sweep {

namespace {

using sim::DocumentValue;

bool is_number(const sim::Key& key) {
  return key.type != sim::ValueType::text && key.type != sim::ValueType::choice &&
         key.type != sim::ValueType::boolean;
}

// Values and ranges in a text, which stands at `place`.
class TextReader {
 public:
  TextReader(const sim::Key& key, sim::Place place) : key_(key), place_(std::move(place)) {}

  std::vector<sim::Value> read(std::string_view rest) {
    for (bool more = true; more;) {
      const bool quoted = sim::trim(rest).starts_with('"');
      const std::string part =
          quoted ? take_quoted(rest) : std::string(sim::trim(rest.substr(0, rest.find(','))));
      if (quoted) {
        add(value_of(part));
      } else {
        add_part(part);
      }
      const std::size_t comma = rest.find(',');
      more = comma != std::string_view::npos;
      rest = more ? rest.substr(comma + 1) : rest;
    }
    return std::move(values_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw sim::UserError(place_, message); }

  // A value in quotation marks, in which two stand for one, as in CSV: it may hold commas. Leaves what
  // follows it.
  std::string take_quoted(std::string_view& rest) const {
    std::string value;
    for (std::size_t at = rest.find('"') + 1; at < rest.size(); ++at) {
      if (rest[at] != '"') {
        value += rest[at];
      } else if (at + 1 < rest.size() && rest[at + 1] == '"') {
        value += rest[++at];
      } else {
        rest = sim::trim(rest.substr(at + 1));
        if (!rest.empty() && rest.front() != ',') {
          fail("after a value in quotation marks comes a comma, not " + sim::shown(rest));
        }
        return value;
      }
    }
    fail("a quotation mark is not closed");
  }

  // A number or truth as such, so that a key of another type refuses it as it would in a file.
  [[nodiscard]] sim::DocumentValue document_of(std::string_view text) const {
    if (key_.type != sim::ValueType::text && key_.type != sim::ValueType::choice) {
      if (const std::optional<std::int64_t> whole = sim::parse_number<std::int64_t>(text)) {
        return {*whole, 0};
      }
      if (const std::optional<double> real = sim::parse_number<double>(text); real && std::isfinite(*real)) {
        return {*real, 0};
      }
      if (text == "true" || text == "false") {
        return {text == "true", 0};
      }
    }
    return {std::string(text), 0};
  }

  [[nodiscard]] sim::Value value_of(std::string_view text) const {
    if (text.empty()) {
      fail("a value is missing; it must be " + sim::expected_of(key_));
    }
    return sim::read_values(key_, document_of(text), place_).front();
  }

  void add_part(std::string_view part) {
    const bool number = key_.type != sim::ValueType::text && key_.type != sim::ValueType::choice &&
                        key_.type != sim::ValueType::boolean;
    const std::size_t dots = number ? part.find("..") : std::string_view::npos;
    if (dots == std::string_view::npos) {
      add(value_of(part));
      return;
    }
    const std::string_view from = sim::trim(part.substr(0, dots));
    std::string_view to = part.substr(dots + 2);
    std::size_t sign = to.find_last_of("*+");
    // The sign of an exponent, as in 1e+6, belongs to the number.
    while (sign != std::string_view::npos && sign > 0 && to[sign] == '+' &&
           (to[sign - 1] == 'e' || to[sign - 1] == 'E')) {
      sign = to.find_last_of("*+", sign - 1);
    }
    const bool stepped = sign != std::string_view::npos;
    const char how = stepped ? to[sign] : ' ';
    const std::string_view step = stepped ? sim::trim(to.substr(sign + 1)) : std::string_view();
    to = sim::trim(to.substr(0, stepped ? sign : to.size()));
    const sim::Value first = value_of(from);
    const sim::Value last = value_of(to);
    if (const auto* whole = std::get_if<std::int64_t>(&first)) {
      add_range(*whole, std::get<std::int64_t>(last), how, step);
    } else {
      add_range(std::get<double>(first), std::get<double>(last), how, step);
    }
  }

  // The step of an arithmetic range, which is a value of the key but need not lie in its range.
  template <class Number>
  [[nodiscard]] Number addend_of(std::string_view text) const {
    sim::Key key = key_;
    key.minimum = std::nullopt;
    key.maximum = std::nullopt;
    const sim::Value value = sim::read_values(key, document_of(text), place_).front();
    return std::get<Number>(value);
  }

  template <class Number>
  void add_range(Number from, Number to, char how, std::string_view step) {
    if (!(from < to)) {
      fail("a range goes up: its second value must be above its first");
    }
    if (how == ' ' && key_.type != sim::ValueType::integer) {
      fail("the range lacks its step, such as *2 or +STEP after it");
    }
    if (how != ' ' && step.empty()) {
      fail("the range lacks the number after its " + std::string(1, how));
    }
    if (how == '*') {
      const std::optional<double> factor = sim::parse_number<double>(step);
      if (!factor || !(*factor > 1.0) || !std::isfinite(*factor) || !(from > Number(0))) {
        fail("a range by factors begins above 0, and its factor is a number above 1");
      }
      add_steps<Number>(from, to, [&](std::int64_t i) {
        return static_cast<long double>(from) *
               std::pow(static_cast<long double>(*factor), static_cast<long double>(i));
      });
    } else {
      const Number addend = how == ' ' ? Number(1) : addend_of<Number>(step);
      if (!(addend > Number(0))) {
        fail("the step of a range must be above 0");
      }
      add_steps<Number>(from, to, [&](std::int64_t i) {
        return static_cast<long double>(from) +
               static_cast<long double>(addend) * static_cast<long double>(i);
      });
    }
  }

  // Adds step(0), which is `from`, step(1), ... as long as they are not above `to`. Of reals, a value that
  // only rounding keeps from being `to` is `to`.
  template <class Number, class Step>
  void add_steps(Number from, Number to, const Step& step) {
    const auto end = static_cast<long double>(to);
    for (std::int64_t i = 0;; ++i) {
      const long double value = step(i);
      if constexpr (std::is_integral_v<Number>) {
        if (std::round(value) > end) {
          return;
        }
        const auto whole = static_cast<Number>(std::round(value));
        if (i > 0 && std::round(step(i - 1)) == std::round(value)) {
          fail("the step of the range is too small: two of its values are equal");
        }
        add(sim::Value(whole));
      } else {
        const bool there = std::abs(value - end) <= 1e-12L * std::abs(end);
        if (value > end && !there) {
          return;
        }
        // 0.1..0.7+0.1 has 0.3, not 0.30000000000000004.
        constexpr int digits = 15;
        const Number decimal = i > 0 ? sim::rounded(static_cast<Number>(value), digits) : from;
        add(sim::Value(there ? to : decimal));
      }
    }
  }

  void add(sim::Value value) {
    if (values_.size() == static_cast<std::size_t>(most_sweep_steps)) {
      fail("an axis has at most " + std::to_string(most_sweep_steps) + " values");
    }
    values_.push_back(std::move(value));
  }

  const sim::Key& key_;
  sim::Place place_;
  std::vector<sim::Value> values_;
};

// Throws for a value that comes twice.
void refuse_repeats(const sim::Key& key, const std::vector<sim::Setting>& settings,
                    const std::function<void(const sim::Setting&, const std::string&)>& fail) {
  std::unordered_set<std::string> seen;
  for (const sim::Setting& setting : settings) {
    const std::string printed = print_values(key, setting.values);
    if (!seen.insert(printed).second) {
      fail(setting, "lists " + sim::shown(printed) + " twice");
    }
  }
}

}  // namespace

AxisArgument read_axis_argument(const sim::Config& config, const std::string& argument) {
  sim::Place place{"--axis " + sim::shown(argument)};
  const auto fail = [&](const std::string& message) { throw sim::UserError(place, message); };
  const std::size_t equals = argument.find('=');
  if (equals == std::string::npos || equals == 0) {
    fail("must have the form KEY=VALUE,VALUE,...");
  }
  const std::string name(sim::trim(std::string_view(argument).substr(0, equals)));
  place.key = name;
  const sim::Schema& schema = config.schema();
  const std::optional<std::size_t> found = schema.find(name);
  if (!found) {
    fail("unknown key" + sim::did_you_mean(name, schema.names()) + "; `marti config` lists all keys");
  }
  const sim::Key& key = schema.keys()[*found];
  if (key.is_list) {
    fail("each value of this key is a list itself; give them in [sweep.axes] of the file");
  }
  AxisArgument axis{*found, {}};
  for (sim::Value& value : TextReader(key, place).read(std::string_view(argument).substr(equals + 1))) {
    axis.steps.push_back({*found, {std::move(value)}, 0, "--axis " + argument});
  }
  refuse_repeats(key, axis.steps,
                 [&](const sim::Setting& /*setting*/, const std::string& message) { fail(message); });
  return axis;
}

std::vector<sim::Setting> axis_values(const sim::Config& config, std::size_t key, const DocumentValue& value,
                                      bool repeats) {
  const sim::Key& declared = config.schema().keys()[key];
  const auto fail = [&](int line, const std::string& message) {
    sim::fail_at(config, line, declared.name, message);
  };
  const bool ranges = is_number(declared) && !declared.is_list;
  // A single value is no axis by itself.
  const auto lists_values = [&](const std::string* text) {
    return ranges && text != nullptr &&
           (text->find("..") != std::string::npos || text->find(',') != std::string::npos);
  };
  std::vector<sim::Setting> settings;
  const auto add_text = [&](const std::string& text, int line) {
    const sim::Place place = sim::place_in_file(config.name(), line, declared.name);
    for (sim::Value& each : TextReader(declared, place).read(text)) {
      settings.push_back({key, {std::move(each)}, line, {}});
    }
  };
  if (const DocumentValue::List* const list = value.list(); list != nullptr) {
    if (list->empty()) {
      fail(value.line, "the list of its values is empty");
    }
    for (const DocumentValue& element : *list) {
      const std::string* const text = element.text();
      if (lists_values(text)) {
        add_text(*text, element.line);
      } else {
        settings.push_back({key, config.parse(key, element), element.line, {}});
      }
    }
  } else if (const std::string* const text = value.text(); lists_values(text)) {
    add_text(*text, value.line);
  } else if (value.table() != nullptr) {
    fail(value.line, "a range is a text, as \"4 KiB..64 KiB*2\" by factors or \"1..9+2\" by steps");
  } else {
    fail(value.line, (ranges ? "an axis is a list of values in brackets or a range such as \"1..16*2\", not "
                             : "an axis is a list of values in brackets, not ") +
                         describe(value));
  }
  if (settings.size() > static_cast<std::size_t>(most_sweep_steps)) {
    fail(value.line, "an axis has at most " + std::to_string(most_sweep_steps) + " values, not " +
                         std::to_string(settings.size()));
  }
  if (!repeats) {
    refuse_repeats(declared, settings, [&](const sim::Setting& setting, const std::string& message) {
      fail(setting.line, message);
    });
  }
  return settings;
}

}  // namespace marti::studies::sweep
