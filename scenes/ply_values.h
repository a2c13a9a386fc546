// Internal to scenes/: the values behind the header of a PLY file, one after the other, in each of its
// formats.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "scenes/ply_header.h"
#include "scenes/scene_notes.h"
#include "scenes/text_lines.h"

namespace marti::scenes {

class PlyValues {
 public:
  /// `text` is the whole file, `lines` stands behind the header; both must outlive this object. `name` is the
  /// file's in messages.
  PlyValues(std::string_view text, std::string name, PlyFormat format, TextLines& lines);

  /// Begins an entry of an element, which in a text is a line.
  void begin(const PlyElement& element, std::uint64_t entry);
  /// The next value as it is in the file: of a float in a text, the nearest float.
  [[nodiscard]] double value(PlyType type);
  /// As value(), but a number in a text that is not of its integer type is taken as it is, and counted.
  [[nodiscard]] double any_number(PlyType type, LeftOut& left_out);
  /// Passes over the next value. In a text it may be any word.
  void pass_over(PlyType type);
  /// The next value as the length of a list of such values.
  [[nodiscard]] std::uint64_t length(const PlyProperty& list);
  /// Ends an entry. Throws UserError when its line has more values.
  void end();
  /// Throws UserError when something comes after the last entry.
  void finish();

  /// Throws a UserError that begins with the file, and the line or the place of the value read last.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  [[nodiscard]] double value_of_word(PlyType type);
  [[nodiscard]] double value_of_bytes(PlyType type);
  [[nodiscard]] std::string entry_name() const;

  std::string_view text_;
  std::string name_;
  PlyFormat format_;
  TextLines& lines_;
  const PlyElement* element_ = nullptr;
  std::uint64_t entry_ = 0;
  std::size_t word_ = 0;  // of a text: the next word of the line
  std::size_t next_ = 0;  // of bytes: the place of the next value
  std::size_t last_ = 0;  // of bytes: that of the last one
};

}  // namespace marti::scenes
