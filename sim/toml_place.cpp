#include "sim/toml_place.h"

#include <algorithm>
#include <vector>

#include "sim/trim.h"

namespace marti::sim {

namespace {

constexpr std::string_view blanks = " \t\r";

/// Follows tables, names and values, and nothing else of TOML.
class PlaceReader {
 public:
  explicit PlaceReader(std::string_view text) : text_(text) {}

  std::string read() {
    while (at_ < text_.size()) {
      step();
    }
    if (part_ == Part::head) {
      return std::string(trim(name_, blanks));
    }
    // A name without what must follow it ends where the next word begins.
    const std::string_view begun = trim(name_, blanks);
    const std::string_view name = part_ == Part::value ? begun : begun.substr(0, begun.find_first_of(" \t"));
    return name.empty() ? std::string() : tables() + std::string(name);
  }

 private:
  enum class Part { head, name, value };
  struct Open {
    char bracket;
    std::string name;  // of an inline table
  };

  void step() {
    const char c = text_[at_];
    if (c == '"' || c == '\'') {
      pass_text(c);
      return;
    }
    ++at_;
    if (c == '#') {
      at_ = std::min(text_.find('\n', at_), text_.size());
    } else if (part_ == Part::head) {
      read_head(c);
    } else if (part_ == Part::name) {
      read_name(c);
    } else {
      read_value(c);
    }
  }

  void read_head(char c) {
    if (c == ']' || c == '\n') {
      table_ = std::string(trim(name_, blanks));
      begin_name();
    } else if (c != '[') {
      name_ += c;
    }
  }

  void read_name(char c) {
    const bool empty = trim(name_, blanks).empty();
    if (c == '=') {
      part_ = Part::value;
    } else if (c == '[' && empty && open_.empty()) {
      name_.clear();
      part_ = Part::head;
    } else if (c == '}' && !open_.empty()) {
      close('{');
    } else if (c == '\n' || c == ',' || (c == ']' && empty)) {
      name_.clear();
    } else {
      name_ += c;
    }
  }

  void read_value(char c) {
    if (c == '{') {
      open_.push_back({c, std::string(trim(name_, blanks))});
      begin_name();
    } else if (c == '[') {
      open_.push_back({c, {}});
    } else if (c == ']') {
      close('[');
    } else if (c == '}') {
      close('{');
    } else if ((c == '\n' && open_.empty()) || (c == ',' && !open_.empty() && open_.back().bracket == '{')) {
      begin_name();
    }
  }

  void begin_name() {
    name_.clear();
    part_ = Part::name;
  }

  // Goes back to the value in which the bracket was opened.
  void close(char bracket) {
    if (!open_.empty() && open_.back().bracket == bracket) {
      name_ = bracket == '{' ? open_.back().name : name_;
      open_.pop_back();
      part_ = Part::value;
    }
  }

  // A text in quotation marks, or in three of them; it counts in a name.
  void pass_text(char quote) {
    const std::size_t begin = at_;
    const std::string three(3, quote);
    const bool long_one = part_ == Part::value && text_.substr(at_).starts_with(three);
    at_ += long_one ? 3 : 1;
    for (bool ended = false; !ended && at_ < text_.size();) {
      const bool escape = text_[at_] == '\\' && quote == '"';
      ended = long_one ? text_.substr(at_).starts_with(three) : text_[at_] == quote;
      if (!long_one && text_[at_] == '\n') {
        break;
      }
      at_ = std::min(text_.size(), at_ + (escape ? 2 : ended && long_one ? 3 : 1));
    }
    if (part_ != Part::value) {
      name_ += text_.substr(begin, at_ - begin);
    }
  }

  [[nodiscard]] std::string tables() const {
    std::string names = table_.empty() ? std::string() : table_ + ".";
    for (const Open& open : open_) {
      names += open.name.empty() ? std::string() : open.name + ".";
    }
    return names;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  Part part_ = Part::name;
  std::string table_;
  std::string name_;
  std::vector<Open> open_;
};

}  // namespace

std::size_t byte_of(std::string_view text, std::size_t line, std::size_t column) {
  std::size_t at = 0;
  for (std::size_t i = 1; i < line && at < text.size(); ++i) {
    at = std::min(text.find('\n', at), text.size() - 1) + 1;
  }
  const auto continues = [&text](std::size_t byte) {
    return byte < text.size() && (static_cast<unsigned char>(text[byte]) & 0xc0U) == 0x80U;
  };
  for (std::size_t i = 1; i < column && at < text.size(); ++i) {
    ++at;
    while (continues(at)) {
      ++at;
    }
  }
  return std::min(at, text.size());
}

std::string name_at(std::string_view text, std::size_t end) {
  return PlaceReader(text.substr(0, end)).read();
}

}  // namespace marti::sim
