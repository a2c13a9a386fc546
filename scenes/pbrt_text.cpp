#include "scenes/pbrt_text.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "scenes/text_lines.h"
#include "scenes/vertex_values.h"
#include "sim/error.h"
#include "sim/parse_number.h"
#include "sim/shown.h"

namespace marti::scenes::pbrt {

namespace {

std::optional<double> number_of(std::string_view text) {
  return sim::parse_number<double>(text.starts_with('+') ? text.substr(1) : text);
}

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

// Files that include others do so to put geometry and materials aside. Of each that includes another one
// twice the time to read doubles, so that their number is limited, too.
constexpr std::size_t most_nested_files = 64;
constexpr std::size_t most_includes = 16384;

}  // namespace

const Parameter* Parameters::find(std::string_view name) const {
  const auto found =
      std::find_if(all_.begin(), all_.end(), [&](const Parameter& p) { return p.name == name; });
  if (found == all_.end()) {
    return nullptr;
  }
  found->asked = true;
  return &*found;
}

void Parameters::leave_out_rest(LeftOut& left_out) const {
  for (const Parameter& parameter : all_) {
    if (!parameter.asked) {
      left_out.leave_out("parameters of pbrt that are not read here",
                         in_quotes(parameter.name) + ", " + place_.substr(place_.rfind('/') + 1));
    }
  }
}

std::uint64_t bytes_of(const std::vector<Parameter>& parameters) {
  std::uint64_t bytes = 0;
  for (const Parameter& parameter : parameters) {
    bytes += 2 * sizeof(Parameter) + parameter.type.size() + parameter.name.size() +
             parameter.numbers.capacity() * sizeof(double) + parameter.texts.capacity() * sizeof(std::string);
    for (const std::string& text : parameter.texts) {
      bytes += text.size();
    }
  }
  return bytes;
}

const std::vector<double>& Parameters::numbers(std::string_view name, std::size_t each) const {
  static const std::vector<double> none;
  const Parameter* const found = find(name);
  if (found == nullptr) {
    return none;
  }
  if (!found->texts.empty() || found->numbers.size() % each != 0) {
    fail("the parameter " + in_quotes(name) + " has " + std::to_string(found->numbers.size()) +
         " numbers; it takes a multiple of " + std::to_string(each));
  }
  return found->numbers;
}

double Parameters::number(std::string_view name, double otherwise, double lowest, double highest) const {
  const Parameter* const found = find(name);
  if (found == nullptr) {
    return otherwise;
  }
  if (found->numbers.size() != 1 || !(found->numbers[0] >= lowest && found->numbers[0] <= highest)) {
    std::ostringstream text;
    text << "the parameter " << in_quotes(name) << " must be one number from " << lowest << " to " << highest;
    fail(text.str());
  }
  return found->numbers[0];
}

std::string Parameters::text(std::string_view name) const {
  const Parameter* const found = find(name);
  if (found == nullptr) {
    return {};
  }
  if (found->texts.size() != 1) {
    fail("the parameter " + in_quotes(name) + " must be one text");
  }
  return found->texts[0];
}

glm::dvec3 Parameters::vector(std::string_view name, const glm::dvec3& otherwise) const {
  const std::vector<double>& given = numbers(name, 3);
  if (given.empty()) {
    return otherwise;
  }
  const glm::dvec3 vector(given[0], given[1], given[2]);
  if (given.size() != 3 || !is_usable(vector)) {
    fail("the parameter " + in_quotes(name) + " must be three numbers up to 1e30");
  }
  return vector;
}

void Parameters::fail(const std::string& what) const { throw sim::UserError(place_ + ": " + what); }

Text::Text(const SourceFile& file)
    : file_(file),
      access_(file.path().parent_path(), file.options().max_file_bytes, file.memory(), "file name") {
  open_.push_back({file.path().string(), file.read(1)});
}

std::string Text::here() const {
  return sim::shown(open_.back().path) + ":" + std::to_string(open_.back().line);
}

void Text::fail(const std::string& what) const { throw sim::UserError(place_ + ": " + what); }

void Text::fail_here(const std::string& what) const { throw sim::UserError(here() + ": " + what); }

void Text::skip_blanks(Open& open) const {
  while (open.at < open.bytes.size()) {
    const char c = open.bytes[open.at];
    if (c == '#') {
      open.at = std::min(open.bytes.find('\n', open.at), open.bytes.size());
    } else if (is_blank(c)) {
      open.line += c == '\n' ? 1U : 0U;
      ++open.at;
    } else {
      return;
    }
  }
}

std::optional<Text::Token> Text::peek() {
  Open& open = open_.back();
  skip_blanks(open);
  const std::string_view bytes = open.bytes;
  if (open.at == bytes.size()) {
    return std::nullopt;
  }
  const char first = bytes[open.at];
  if (first == '"') {
    const std::size_t end = bytes.find_first_of("\"\n", open.at + 1);
    if (end == std::string_view::npos || bytes[end] == '\n') {
      fail_here("a quotation mark is not closed in its line");
    }
    end_ = end + 1;
    return Token{bytes.substr(open.at + 1, end - open.at - 1), true};
  }
  end_ = open.at + 1;
  if (first != '[' && first != ']') {
    while (end_ < bytes.size() && !is_blank(bytes[end_]) && bytes[end_] != '"' && bytes[end_] != '[' &&
           bytes[end_] != ']' && bytes[end_] != '#') {
      ++end_;
    }
  }
  return Token{bytes.substr(open.at, end_ - open.at)};
}

void Text::take() { open_.back().at = end_; }

Text::Token Text::expect(const char* what) {
  const std::optional<Token> token = peek();
  if (!token) {
    fail(std::string("the file ends where ") + what + " is expected");
  }
  return *token;
}

std::optional<std::string> Text::next() {
  for (;;) {
    const std::optional<Token> token = peek();
    if (token) {
      place_ = here();
      if (token->quoted || !std::isalpha(static_cast<unsigned char>(token->text.front()))) {
        fail(in_quotes(token->text) + " stands where a statement is expected");
      }
      std::string name(token->text);
      take();
      return name;
    }
    if (open_.size() == 1) {
      return std::nullopt;
    }
    open_.pop_back();
  }
}

std::string Text::text() {
  const Token token = expect("a text in quotation marks");
  if (!token.quoted) {
    fail_here(in_quotes(token.text) + " stands where a text in quotation marks is expected");
  }
  std::string text(token.text);
  take();
  return text;
}

std::optional<std::string> Text::text_if_given() {
  const std::optional<Token> token = peek();
  if (!token || !token->quoted) {
    return std::nullopt;
  }
  return text();
}

std::string Text::word() {
  const Token token = expect("a word");
  std::string word(token.text);
  take();
  return word;
}

std::vector<double> Text::numbers(std::size_t count) {
  const Token first = expect("a number");
  const bool in_brackets = !first.quoted && first.text == "[";
  if (in_brackets) {
    take();
  }
  std::vector<double> numbers;
  for (std::size_t i = 0; i < count; ++i) {
    const Token token = expect("a number");
    const std::optional<double> number = number_of(token.text);
    if (token.quoted || !number || !(std::abs(*number) <= largest_coordinate)) {
      fail_here(in_quotes(token.text) + " is no number up to 1e30; the statement takes " +
                std::to_string(count));
    }
    numbers.push_back(*number);
    take();
  }
  if (in_brackets) {
    if (expect("a closing bracket").text != "]") {
      fail_here("more than " + std::to_string(count) + " numbers");
    }
    take();
  }
  return numbers;
}

Parameters Text::parameters() {
  std::vector<Parameter> all;
  for (std::optional<Token> token = peek(); token && token->quoted; token = peek()) {
    std::istringstream declaration{std::string(token->text)};
    Parameter parameter;
    std::string more;
    if (!(declaration >> parameter.type >> parameter.name) || declaration >> more) {
      fail_here(in_quotes(token->text) +
                " is no parameter; one is a type and a name, such as \"float radius\"");
    }
    take();
    read_values(parameter);
    all.push_back(std::move(parameter));
  }
  return {std::move(all), place_};
}

void Text::read_values(Parameter& parameter) {
  if (expect("a value").text != "[" || expect("a value").quoted) {
    add_value(*peek(), parameter);
    take();
    return;
  }
  take();
  constexpr std::size_t checked = 1U << 13U;
  for (Token token = expect("a closing bracket"); token.quoted || token.text != "]";
       token = expect("a closing bracket")) {
    add_value(token, parameter);
    take();
    // The list may grow to twice as many, and is copied once.
    const std::size_t size = parameter.numbers.size() + parameter.texts.size();
    if (size >= checked && (size & (size - 1)) == 0) {
      file_.require_memory(
          4 * (parameter.numbers.size() * sizeof(double) + parameter.texts.size() * sizeof(std::string)),
          "a list of values takes");
    }
  }
  take();
}

void Text::add_value(const Token& token, Parameter& parameter) {
  if (token.quoted || token.text == "true" || token.text == "false") {
    parameter.texts.emplace_back(token.text);
    return;
  }
  const std::optional<double> number = number_of(token.text);
  if (!number) {
    fail_here(in_quotes(token.text) + " is no value of the parameter " + in_quotes(parameter.name));
  }
  parameter.numbers.push_back(*number);
}

std::string Text::file(const std::string& name) {
  if (name.empty()) {
    fail("the name of a file is missing or empty");
  }
  std::string path = access_.directory() + name;
  if (!access_.may_read(path)) {
    fail(!access_.refusal().empty() ? access_.refusal() : "there is no file " + in_quotes(name));
  }
  if (path.ends_with(".gz")) {
    fail("the file " + in_quotes(name) +
         " is compressed: decompress it (gunzip), and write its name without .gz");
  }
  return path;
}

std::optional<std::string> Text::read(const std::string& name, std::string& reason) {
  const std::string path = access_.directory() + name;
  std::string bytes;
  if (access_.may_read(path) && access_.read(path, bytes, reason)) {
    return bytes;
  }
  if (!access_.refusal().empty()) {
    fail(access_.refusal());
  }
  reason =
      place_ + ": the file " + in_quotes(name) + " cannot be read" + (reason.empty() ? "" : ": " + reason);
  return std::nullopt;
}

void Text::include(const std::string& name) {
  const std::string path = file(name);
  if (std::any_of(open_.begin(), open_.end(), [&](const Open& open) {
        return std::filesystem::path(open.path).lexically_normal() ==
               std::filesystem::path(path).lexically_normal();
      })) {
    fail("the file " + in_quotes(name) + " includes itself, by itself or by another one");
  }
  if (open_.size() == most_nested_files || ++includes_ > most_includes) {
    fail("more than " + std::to_string(most_nested_files) + " files include each other, or more than " +
         std::to_string(most_includes) + " are included");
  }
  std::string reason;
  std::optional<std::string> bytes = read(name, reason);
  if (!bytes) {
    throw sim::UserError(reason);
  }
  included_bytes_ += bytes->size();
  if (included_bytes_ > file_.options().max_file_bytes) {
    fail("the files that are included have more than " + std::to_string(file_.options().max_file_bytes) +
         " bytes");
  }
  open_.push_back({path, std::move(*bytes)});
}

}  // namespace marti::scenes::pbrt
