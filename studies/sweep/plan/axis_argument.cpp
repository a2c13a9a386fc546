#include "studies/sweep/plan/axis_argument.h"

#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>
#include <type_traits>
#include <unordered_set>
#include <utility>

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

class ArgumentReader {
 public:
  ArgumentReader(const sim::Config& config, const std::string& argument)
      : config_(config), argument_(argument), place_("--axis " + sim::shown(argument)) {}

  AxisArgument read() {
    const std::size_t equals = argument_.find('=');
    if (equals == std::string::npos || equals == 0) {
      fail("must have the form KEY=VALUE,VALUE,...");
    }
    const std::string name(sim::trim(std::string_view(argument_).substr(0, equals)));
    const sim::Schema& schema = config_.schema();
    const std::optional<std::size_t> key = schema.find(name);
    if (!key) {
      fail("unknown key" + sim::did_you_mean(name, schema.names()) + "; `marti config` lists all keys");
    }
    axis_.key = *key;
    if (declared().is_list) {
      fail("each value of this key is a list itself; give them in [sweep.axes] of the file");
    }
    std::string_view rest = std::string_view(argument_).substr(equals + 1);
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
    return std::move(axis_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw sim::UserError(place_ + ": " + message); }
  [[nodiscard]] const sim::Key& declared() const { return config_.schema().keys()[axis_.key]; }

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
    if (declared().type != sim::ValueType::text && declared().type != sim::ValueType::choice) {
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
      fail("a value is missing; it must be " + sim::expected_of(declared()));
    }
    return sim::read_values(declared(), document_of(text), place_).front();
  }

  void add_part(std::string_view part) {
    const bool number = declared().type != sim::ValueType::text &&
                        declared().type != sim::ValueType::choice &&
                        declared().type != sim::ValueType::boolean;
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
    sim::Key key = declared();
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
    if (how == ' ' && declared().type != sim::ValueType::integer) {
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
    sim::Setting setting{axis_.key, {std::move(value)}, 0, "--axis " + argument_};
    const std::string printed = print_values(declared(), setting.values);
    if (!seen_.insert(printed).second) {
      fail("lists " + sim::shown(printed) + " twice");
    }
    if (axis_.steps.size() == static_cast<std::size_t>(most_sweep_steps)) {
      fail("an axis has at most " + std::to_string(most_sweep_steps) + " values");
    }
    axis_.steps.push_back(std::move(setting));
  }

  const sim::Config& config_;
  const std::string& argument_;
  std::string place_;
  AxisArgument axis_;
  std::unordered_set<std::string> seen_;
};

}  // namespace

AxisArgument read_axis_argument(const sim::Config& config, const std::string& argument) {
  return ArgumentReader(config, argument).read();
}

}  // namespace marti::studies::sweep
