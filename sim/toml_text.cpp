#include "sim/toml_text.h"

namespace marti::sim {

namespace {

enum class In { plain, comment, string };

// Walks over a text and tracks strings by their quotes, one character or three of them.
class Walk {
 public:
  explicit Walk(std::string_view text) : text_(text) {}

  std::size_t line_beyond_ascii() {
    for (at_ = text_.starts_with("\xEF\xBB\xBF") ? 3 : 0; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      line_ += c == '\n' ? 1 : 0;
      switch (in_) {
        case In::plain:
          if (static_cast<unsigned char>(c) >= 0x80) {
            return line_;
          }
          begin(c);
          break;
        case In::comment:
          in_ = c == '\n' ? In::plain : In::comment;
          break;
        case In::string:
          inside(c);
          break;
      }
    }
    return 0;
  }

 private:
  [[nodiscard]] bool three(char quote) const {
    return text_.substr(at_, 3) == std::string_view(quote == '"' ? "\"\"\"" : "'''");
  }

  void begin(char c) {
    if (c == '#') {
      in_ = In::comment;
    } else if (c == '"' || c == '\'') {
      in_ = In::string;
      quote_ = c;
      long_ = three(c);
      at_ += long_ ? 2 : 0;
    }
  }

  void inside(char c) {
    if (c == '\\' && quote_ == '"') {
      ++at_;  // an escaped character does not end the string
      line_ += at_ < text_.size() && text_[at_] == '\n' ? 1 : 0;
    } else if (long_) {
      if (c == quote_ && three(quote_)) {
        in_ = In::plain;
        at_ += 2;
      }
    } else if (c == quote_ || c == '\n') {
      in_ = In::plain;  // a line break in a string is an error, which toml++ reports
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
  In in_ = In::plain;
  char quote_ = '"';
  bool long_ = false;
};

}  // namespace

std::size_t line_beyond_ascii(std::string_view text) { return Walk(text).line_beyond_ascii(); }

}  // namespace marti::sim
