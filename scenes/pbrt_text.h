// Internal to scenes/: the statements of pbrt files, with those that they include.
//
// The format: pbrt.org/fileformat-v4. A file is words, texts in quotation marks and brackets, separated by
// white space; "#" begins a comment. A statement is a name and its arguments; most end with parameters, each
// a text "type name" and a value or a list of values in brackets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "scenes/file_access.h"
#include "scenes/scene_notes.h"
#include "scenes/source_file.h"

namespace marti::scenes::pbrt {

struct Parameter {
  std::string type;  ///< "float", "rgb", "point3", ...
  std::string name;
  std::vector<double> numbers;
  std::vector<std::string> texts;  ///< in quotation marks, or true and false
  mutable bool asked = false;      ///< for its value, or whether it is there
};

/// Bytes of host memory that they take.
[[nodiscard]] std::uint64_t bytes_of(const std::vector<Parameter>& parameters);

/// The parameters of one statement.
class Parameters {
 public:
  Parameters() = default;
  Parameters(std::vector<Parameter> all, std::string place)
      : all_(std::move(all)), place_(std::move(place)) {}

  [[nodiscard]] const std::vector<Parameter>& all() const { return all_; }
  /// Adds parameters behind the others, which come first where names are equal.
  void append(const std::vector<Parameter>& more) { all_.insert(all_.end(), more.begin(), more.end()); }
  /// The first parameter with this name; nullptr if no parameter has it.
  [[nodiscard]] const Parameter* find(std::string_view name) const;
  /// Bytes of host memory that they take.
  [[nodiscard]] std::uint64_t bytes() const { return place_.size() + bytes_of(all_); }
  /// The numbers of the parameter `name`; an empty list if it is not given. Throws UserError when their count
  /// is not a multiple of `each`.
  [[nodiscard]] const std::vector<double>& numbers(std::string_view name, std::size_t each) const;
  /// One finite number. Throws UserError when it is something else or beyond `lowest` to `highest`.
  [[nodiscard]] double number(std::string_view name, double otherwise, double lowest, double highest) const;
  /// The text of the parameter `name`; empty if it is not given. Throws UserError when its value is not one
  /// text.
  [[nodiscard]] std::string text(std::string_view name) const;
  /// A point or a vector. Throws UserError when it is not three numbers up to 1e30.
  [[nodiscard]] glm::dvec3 vector(std::string_view name, const glm::dvec3& otherwise) const;

  /// Counts those that nobody has asked for. Call it when the statement has been read.
  void leave_out_rest(LeftOut& left_out) const;

  /// "FILE:LINE" of the statement.
  [[nodiscard]] const std::string& place() const { return place_; }
  /// Throws a UserError that begins with place().
  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::vector<Parameter> all_;
  std::string place_;
};

class Text {
 public:
  explicit Text(const SourceFile& file);

  /// The name of the next statement; nothing at the end of the last file.
  [[nodiscard]] std::optional<std::string> next();
  /// Its next argument in quotation marks.
  [[nodiscard]] std::string text();
  /// Its next argument if that is in quotation marks.
  [[nodiscard]] std::optional<std::string> text_if_given();
  /// Its next argument without quotation marks.
  [[nodiscard]] std::string word();
  /// So many numbers, in brackets or not.
  [[nodiscard]] std::vector<double> numbers(std::size_t count);
  /// The parameters up to the next statement.
  [[nodiscard]] Parameters parameters();

  /// Goes on with this file, of the scene's folder, and then with the present one. Throws UserError when it
  /// cannot be read or is being read.
  void include(const std::string& name);
  /// A file of the scene's folder; nothing, and `reason` set, if it cannot be read.
  [[nodiscard]] std::optional<std::string> read(const std::string& name, std::string& reason);
  /// The path of such a file. Throws UserError when there is no such file.
  [[nodiscard]] std::string file(const std::string& name);

  /// "FILE:LINE" of the statement.
  [[nodiscard]] const std::string& place() const { return place_; }
  [[noreturn]] void fail(const std::string& what) const;

 private:
  struct Token {
    std::string_view text;
    bool quoted = false;
  };
  struct Open {
    std::string path;
    std::string bytes;
    std::size_t at = 0;
    std::uint64_t line = 1;
  };

  [[nodiscard]] std::string here() const;
  [[noreturn]] void fail_here(const std::string& what) const;
  void skip_blanks(Open& open) const;
  /// The next token of the last file; nothing at its end.
  [[nodiscard]] std::optional<Token> peek();
  void take();
  /// The next token, which is not the end of the file.
  [[nodiscard]] Token expect(const char* what);
  void read_values(Parameter& parameter);
  void add_value(const Token& token, Parameter& parameter);

  const SourceFile& file_;
  FileAccess access_;
  std::vector<Open> open_;  // the one that is read last, after those that include it
  std::size_t includes_ = 0;
  std::uint64_t included_bytes_ = 0;
  std::size_t end_ = 0;  // of the token that peek() has found
  std::string place_;
};

}  // namespace marti::scenes::pbrt
