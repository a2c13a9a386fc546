// Internal to scenes/: text files of one statement a line, taken apart into words, and messages with file and
// line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace marti::scenes {

/// Lines end in LF or CR LF; blank ones are passed over. Words are separated by blanks and tabs.
class TextLines {
 public:
  enum class Style : std::uint8_t {
    plain,
    wavefront  ///< lines that begin with "#" are comments; a backslash at the end continues a line
  };
  /// The text must outlive this object. `name` is the file's in messages.
  TextLines(std::string_view text, std::string name, Style style);

  /// The most bytes of a line, which bounds the memory for its words.
  static constexpr std::size_t longest_line = std::size_t{1} << 20U;

  /// Goes to the next line that has words. False at the end of the text.
  [[nodiscard]] bool next();

  /// The line's words; at least one if next() returned true.
  [[nodiscard]] const std::vector<std::string_view>& words() const { return words_; }
  /// The line from a word on to its end, without the blanks there; empty if there is no such word.
  [[nodiscard]] std::string_view from(std::size_t word) const;
  /// Drops the words from the first one that begins with "#" on.
  void drop_comment();

  /// A word as a number. Like printf's output it may be "nan" or "inf".
  [[nodiscard]] double number(std::size_t word) const;
  [[nodiscard]] std::int64_t integer(std::string_view text) const;

  /// The place behind the line, in bytes from the beginning of the text.
  [[nodiscard]] std::size_t end() const { return next_; }
  [[nodiscard]] std::uint64_t line() const { return line_; }
  /// "FILE:LINE".
  [[nodiscard]] std::string place() const;
  /// The text of fail(): place() and the reason.
  [[nodiscard]] std::string refusal(const std::string& what) const { return place() + ": " + what; }
  /// Throws a UserError that begins with place().
  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::string_view take_line();
  void split(std::string_view line);

  std::string_view text_;
  std::string name_;
  Style style_;
  std::size_t next_ = 0;
  std::uint64_t line_ = 0;        // of the statement, from 1
  std::uint64_t lines_read_ = 0;  // a continued statement takes several
  std::string joined_;            // of a continued statement
  std::string_view content_;
  std::vector<std::string_view> words_;
};

/// The text in UTF-8: one that begins with the byte order mark of UTF-16 is converted, with U+FFFD for what
/// is no character; any other is returned as it is.
[[nodiscard]] std::string in_utf8(std::string text);

/// Foreign text in single quotation marks.
[[nodiscard]] std::string in_quotes(std::string_view text);

}  // namespace marti::scenes
