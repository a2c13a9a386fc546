#include "scenes/text_lines.h"

#include <algorithm>
#include <charconv>
#include <system_error>
#include <utility>

#include "sim/error.h"
#include "sim/shown.h"

namespace marti::scenes {

namespace {

constexpr std::string_view blanks = " \t\r\v\f";
constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";

std::string_view without_end(std::string_view line) {
  const std::size_t last = line.find_last_not_of(blanks);
  return last == std::string_view::npos ? std::string_view() : line.substr(0, last + 1);
}

}  // namespace

std::string in_utf8(std::string text) {
  const bool little = text.starts_with("\xff\xfe");
  if (!little && !text.starts_with("\xfe\xff")) {
    return text;
  }
  const auto unit = [&](std::size_t at) {
    const auto first = static_cast<unsigned char>(text[at]);
    const auto second = static_cast<unsigned char>(text[at + 1]);
    return static_cast<std::uint32_t>(little ? first | second << 8U : first << 8U | second);
  };
  std::string result;
  for (std::size_t at = 2; at + 1 < text.size(); at += 2) {
    std::uint32_t code = unit(at);
    if (code >= 0xd800 && code < 0xe000) {
      const std::uint32_t low = code < 0xdc00 && at + 3 < text.size() ? unit(at + 2) : 0;
      const bool pair = low >= 0xdc00 && low < 0xe000;
      code = pair ? 0x10000 + ((code - 0xd800) << 10U) + (low - 0xdc00) : 0xfffd;
      at += pair ? 2U : 0U;
    }
    const auto add = [&result](std::uint32_t byte) { result += static_cast<char>(byte); };
    const auto add_rest = [&](std::uint32_t shift) { add(0x80U | (code >> shift & 0x3fU)); };
    if (code < 0x80) {
      add(code);
    } else if (code < 0x800) {
      add(0xc0U | code >> 6U);
      add_rest(0);
    } else if (code < 0x10000) {
      add(0xe0U | code >> 12U);
      add_rest(6);
      add_rest(0);
    } else {
      add(0xf0U | code >> 18U);
      add_rest(12);
      add_rest(6);
      add_rest(0);
    }
  }
  return result;
}

std::string in_quotes(std::string_view text) { return "'" + sim::shown(text) + "'"; }

TextLines::TextLines(std::string_view text, std::string name, Style style)
    : text_(text), name_(std::move(name)), style_(style) {
  if (style_ == Style::wavefront && text_.starts_with(byte_order_mark)) {
    next_ = byte_order_mark.size();
  }
}

std::string_view TextLines::take_line() {
  const std::size_t end = std::min(text_.find('\n', next_), text_.size());
  const std::string_view line = text_.substr(next_, end - next_);
  next_ = std::min(end + 1, text_.size());
  ++lines_read_;
  return without_end(line);
}

void TextLines::split(std::string_view line) {
  if (line.size() > longest_line) {
    fail("the line is longer than 1 MiB");
  }
  content_ = line;
  for (std::size_t at = line.find_first_not_of(blanks); at < line.size();) {
    const std::size_t end = std::min(line.find_first_of(blanks, at), line.size());
    words_.push_back(line.substr(at, end - at));
    at = std::min(line.find_first_not_of(blanks, end), line.size());
  }
}

bool TextLines::next() {
  words_.clear();
  while (words_.empty() && next_ < text_.size()) {
    std::string_view line = take_line();
    line_ = lines_read_;
    const std::size_t first = line.find_first_not_of(blanks);
    const bool comment = first != std::string_view::npos && line[first] == '#';
    if (style_ == Style::wavefront && line.ends_with('\\') && !comment) {
      joined_.clear();
      bool more = true;
      while (more) {
        more = line.ends_with('\\') && next_ < text_.size();
        joined_ += line.ends_with('\\') ? line.substr(0, line.size() - 1) : line;
        joined_ += ' ';
        if (joined_.size() > longest_line) {
          fail("the line is longer than 1 MiB");
        }
        line = more ? take_line() : line;
      }
      line = without_end(joined_);
    }
    split(line);
    if (style_ == Style::wavefront && !words_.empty() && words_.front().starts_with('#')) {
      words_.clear();
    }
  }
  return !words_.empty();
}

std::string_view TextLines::from(std::size_t word) const {
  return word < words_.size()
             ? content_.substr(static_cast<std::size_t>(words_[word].data() - content_.data()))
             : std::string_view();
}

void TextLines::drop_comment() {
  for (std::size_t i = 1; i < words_.size(); ++i) {
    if (words_[i].starts_with('#')) {
      words_.resize(i);
    }
  }
}

double TextLines::number(std::size_t word) const {
  const std::string_view text = words_[word];
  const std::string_view digits = text.starts_with('+') && !text.starts_with("+-") ? text.substr(1) : text;
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range) {
    fail(in_quotes(text) + " is beyond the range of numbers");
  }
  if (error != std::errc{} || end != digits.data() + digits.size()) {
    fail(in_quotes(text) + " is no number");
  }
  return value;
}

std::int64_t TextLines::integer(std::string_view text) const {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) {
    fail(in_quotes(text) + " is no whole number" +
         (error == std::errc::result_out_of_range ? " of 64 bits" : ""));
  }
  return value;
}

std::string TextLines::place() const {
  return name_ + ":" + std::to_string(std::max<std::uint64_t>(line_, 1));
}

void TextLines::fail(const std::string& what) const { throw sim::UserError(refusal(what)); }

}  // namespace marti::scenes
