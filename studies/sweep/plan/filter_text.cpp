#include "studies/sweep/plan/filter_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <utility>

#include "sim/error.h"
#include "sim/nearest.h"
#include "sim/shown.h"
#include "sim/units.h"

namespace marti::studies::sweep {

namespace {

constexpr std::size_t longest_filter = 10'000;

constexpr std::array<std::string_view, 19> words = {
    "and",  "or",   "not",  "in",  "between", "is",    "null",   "like",    "glob",  "case",
    "when", "then", "else", "end", "true",    "false", "isnull", "notnull", "escape"};

// SQLite's functions without effects, whose results stay small; of its mathematical ones, those that Debian's
// has. https://sqlite.org/lang_corefunc.html, https://sqlite.org/lang_mathfunc.html
constexpr std::array<std::string_view, 24> functions = {
    "abs",   "ceil",   "coalesce", "exp", "floor", "glob",  "ifnull", "iif",
    "instr", "length", "like",     "ln",  "log10", "log2",  "lower",  "max",
    "min",   "mod",    "nullif",   "pow", "power", "round", "sqrt",   "substr"};

template <std::size_t N>
bool holds(const std::array<std::string_view, N>& list, std::string_view name) {
  return std::ranges::find(list, name) != list.end();
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

std::string lower(std::string_view text) {
  std::string small(text);
  for (char& c : small) {
    c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return small;
}

// What a unit measures, if it is one.
std::optional<sim::ValueType> dimension_of(std::string_view unit) {
  constexpr std::array<std::string_view, 5> sizes = {"B", "KiB", "MiB", "GiB", "TiB"};
  constexpr std::array<std::string_view, 5> frequencies = {"Hz", "kHz", "MHz", "GHz", "THz"};
  constexpr std::array<std::string_view, 5> durations = {"ps", "ns", "us", "ms", "s"};
  return holds(sizes, unit)         ? std::optional(sim::ValueType::size)
         : holds(frequencies, unit) ? std::optional(sim::ValueType::frequency)
         : holds(durations, unit)   ? std::optional(sim::ValueType::duration)
                                    : std::nullopt;
}

// A quantity as an SQL number.
std::string quantity(const std::string& text, sim::ValueType dimension) {
  return dimension == sim::ValueType::size        ? std::to_string(sim::parse_size(text))
         : dimension == sim::ValueType::frequency ? sim::print_real(sim::parse_frequency(text))
                                                  : std::to_string(std::int64_t{sim::parse_duration(text)});
}

// Words after which a value still is compared with the key before them.
constexpr std::array<std::string_view, 4> comparing = {"not", "in", "between", "is"};

class Translator {
 public:
  Translator(const sim::Schema& schema, std::string_view text, bool points, const sim::Place& place)
      : schema_(schema), text_(text), points_(points), place_(place) {}

  FilterText translate() {
    if (text_.size() > longest_filter) {
      fail("has more than " + std::to_string(longest_filter) + " characters");
    }
    while (at_ < text_.size()) {
      step();
    }
    if (depth_ != 0) {
      fail("a parenthesis is not closed");
    }
    if (result_.columns.empty()) {
      fail("names no key, so that it cannot tell points apart");
    }
    return std::move(result_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw sim::UserError(place_, sim::shown(message, sim::all_shown));
  }

  void step() {
    const char c = text_[at_];
    if (c == ' ' || c == '\t' || c == '\n' || c == '\r') {
      result_.sql += ' ';
      ++at_;
    } else if (is_digit(c) || (c == '.' && at_ + 1 < text_.size() && is_digit(text_[at_ + 1]))) {
      number();
    } else if (is_letter(c)) {
      name();
    } else if (c == '\'') {
      literal();
    } else {
      symbol(c);
    }
  }

  void symbol(char c) {
    if (c == '"' || c == '`' || c == '[') {
      fail("write texts in single quotation marks, as 'lru', and names of keys without any");
    }
    const char next = at_ + 1 < text_.size() ? text_[at_ + 1] : ' ';
    if ((c == '-' && next == '-') || (c == '/' && next == '*')) {
      fail("a filter has no comments");
    }
    constexpr std::string_view allowed = "()<>=!+-*/%,|&~";
    if (allowed.find(c) == std::string_view::npos) {
      fail("the character " + shown(c) + " means nothing here");
    }
    depth_ += c == '(' ? 1 : c == ')' ? -1 : 0;
    if (function_depth_ != 0 && depth_ < function_depth_) {
      function_depth_ = 0;
    }
    // What follows an arithmetic operator is part of a computation.
    if (std::string_view("+-*/%|&~").find(c) != std::string_view::npos) {
      compared_.reset();
    }
    if (depth_ < 0) {
      fail("a parenthesis is closed that was not opened");
    }
    result_.sql += c;
    ++at_;
  }

  static std::string shown(char c) {
    return c > ' ' && c <= '~' ? "'" + std::string(1, c) + "'"
                               : "of code " + std::to_string(static_cast<unsigned char>(c));
  }

  std::string_view take_name(bool dots) {
    const std::size_t begin = at_;
    while (at_ < text_.size() &&
           (is_letter(text_[at_]) || is_digit(text_[at_]) || (dots && text_[at_] == '.'))) {
      ++at_;
    }
    return text_.substr(begin, at_ - begin);
  }

  void skip_blanks() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) {
      ++at_;
    }
  }

  void number() {
    double value = 0.0;
    const char* const begin = text_.data() + at_;
    // Takes the "e6" of "1e6", but not the "e" of "1 else".
    const char* const end = std::from_chars(begin, text_.data() + text_.size(), value).ptr;
    const std::string digits(begin, end);
    at_ += digits.size();
    const std::size_t after = at_;
    skip_blanks();
    const std::string unit(take_name(false));
    if (unit.empty() || holds(words, lower(unit))) {
      at_ = after;
      refuse_number(digits, std::nullopt);
      result_.sql += digits + " ";
      return;
    }
    const std::optional<sim::ValueType> dimension = dimension_of(unit);
    if (!dimension) {
      fail("\"" + sim::shown(digits) + " " + sim::shown(unit) +
           "\": unknown unit; there are B, KiB, MiB, GiB, TiB, Hz, kHz, MHz, GHz, THz, ps, ns, us, ms and s");
    }
    const std::string text = digits + " " + unit;
    try {
      result_.sql += quantity(text, *dimension) + " ";
    } catch (const sim::UserError& error) {
      fail(error.what());
    }
    refuse_number(text, dimension);
  }

  void name() {
    const std::string_view found = take_name(true);
    if (found == "point") {
      if (!points_) {
        fail("there are no named points, so `point` has no value");
      }
      column("point", FilterText::point);
    } else if (const std::optional<std::size_t> key = schema_.find(found)) {
      if (schema_.keys()[*key].is_list) {
        fail(std::string(found) + " has several values and cannot be compared");
      }
      column(found, *key);
    } else if (holds(words, lower(found))) {
      // The "and" of "between 1 and 2" belongs to it; any other "and" begins a new condition.
      const bool second = lower(found) == "and" && std::exchange(between_, false);
      between_ = between_ || lower(found) == "between";
      if (!second && !holds(comparing, lower(found))) {
        compared_.reset();
      }
      result_.sql += std::string(found) + " ";
    } else if (is_filter_function(lower(found))) {
      skip_blanks();
      if (at_ >= text_.size() || text_[at_] != '(') {
        fail("\"" + sim::shown(found) + "\" is a function: its arguments follow in parentheses");
      }
      compared_.reset();
      function_depth_ = function_depth_ == 0 ? depth_ + 1 : function_depth_;
      result_.sql += found;
    } else {
      unknown(std::string(found));
    }
  }

  [[noreturn]] void unknown(const std::string& found) const {
    if (schema_.is_section(found)) {
      fail("\"" + sim::shown(found) + "\" is a section, not a key");
    }
    const std::string near = sim::did_you_mean(found, schema_.names());
    fail("unknown name \"" + sim::shown(found) + "\"" + near +
         (near.empty() && found.find('.') == std::string::npos
              ? "; texts are written in single quotation marks, as 'lru'"
              : "; `marti config` lists all keys"));
  }

  void column(std::string_view name, std::size_t index) {
    result_.sql += "\"" + std::string(name) + "\"";
    compared_ = function_depth_ == 0 ? std::optional(index) : std::nullopt;
    if (std::ranges::find(result_.columns, index) == result_.columns.end()) {
      result_.columns.push_back(index);
    }
  }

  void literal() {
    const std::size_t begin = at_++;
    std::string content;
    for (;; ++at_) {
      if (at_ >= text_.size()) {
        fail("a text in single quotation marks has no end");
      }
      if (text_[at_] == '\0') {
        fail("a text holds a character of code 0");
      }
      if (text_[at_] != '\'') {
        content += text_[at_];
      } else if (at_ + 1 < text_.size() && text_[at_ + 1] == '\'') {
        content += text_[at_++];
      } else {
        break;
      }
    }
    ++at_;
    refuse_quantity(content);
    refuse_text(content);
    result_.sql += text_.substr(begin, at_ - begin);
  }

  // SQLite compares anything with anything: a number is less than every text. What follows a key directly,
  // with nothing but comparisons and lists between, must be of its type, or a slip would silently choose
  // other points.
  [[nodiscard]] const sim::Key* compared() const {
    return compared_ && *compared_ != FilterText::point ? &schema_.keys()[*compared_] : nullptr;
  }
  static bool is_text(const sim::Key& key) {
    return key.type == sim::ValueType::text || key.type == sim::ValueType::choice;
  }
  void refuse_text(const std::string& content) const {
    const sim::Key* key = compared();
    if (key == nullptr) {
      return;
    }
    if (!is_text(*key)) {
      fail(key->name + " is no text and cannot be compared with '" + sim::shown(content) + "'");
    }
    if (key->type == sim::ValueType::choice &&
        std::ranges::find(key->choices, content) == key->choices.end()) {
      fail(key->name + " is never '" + sim::shown(content) + "'" + sim::did_you_mean(content, key->choices) +
           "; it is " + sim::print_range(*key));
    }
  }
  void refuse_number(const std::string& number, std::optional<sim::ValueType> dimension) const {
    const sim::Key* key = compared();
    if (key != nullptr && is_text(*key)) {
      fail(key->name + " is a text and cannot be compared with " + number);
    }
    const auto has_unit = [](sim::ValueType type) {
      return type == sim::ValueType::size || type == sim::ValueType::frequency ||
             type == sim::ValueType::duration;
    };
    if (key != nullptr && dimension && has_unit(key->type) && key->type != *dimension) {
      fail(key->name + " is a " + std::string(sim::name_of(key->type)) + " and cannot be compared with " +
           number);
    }
  }

  // '64 KiB' is never equal to a size: it would pass no point, or all.
  void refuse_quantity(const std::string& content) const {
    const std::size_t unit = content.find_last_of("0123456789. ") + 1;  // 0 when there is none of these
    if (unit == 0 || unit == content.size()) {
      return;
    }
    const std::string number = content.substr(0, content.find_first_not_of("0123456789."));
    if (number.empty()) {
      return;
    }
    const std::optional<sim::ValueType> dimension = dimension_of(std::string_view(content).substr(unit));
    if (!dimension) {
      return;
    }
    try {
      (void)quantity(number + " " + content.substr(unit), *dimension);
    } catch (const sim::UserError&) {
      return;
    }
    fail("'" + content +
         "' is a text, which no size, frequency or duration equals; write it without quotation marks");
  }

  const sim::Schema& schema_;
  std::string_view text_;
  bool points_;
  sim::Place place_;
  std::size_t at_ = 0;
  int depth_ = 0;
  int function_depth_ = 0;               // of the outermost function's parenthesis; 0 outside of any
  bool between_ = false;                 // its "and" is still to come
  std::optional<std::size_t> compared_;  // the key that what comes next is compared with
  FilterText result_;
};

}  // namespace

bool is_filter_function(std::string_view name) { return holds(functions, name); }

FilterText translate_filter(const sim::Schema& schema, std::string_view text, bool points,
                            const sim::Place& place) {
  return Translator(schema, text, points, place).translate();
}

}  // namespace marti::studies::sweep
