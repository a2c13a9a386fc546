#include "scenes/npy.h"

#include <array>
#include <charconv>
#include <system_error>

#include "sim/error.h"
#include "sim/shown.h"

namespace marti::scenes {

namespace {

constexpr std::string_view magic = "\x93NUMPY";
constexpr std::size_t alignment = 64;  // of the first element, by the format

/// Reads the literal of a dictionary of Python, of the few forms that NumPy writes.
class Dictionary {
 public:
  explicit Dictionary(std::string_view text) : text_(text) {}

  NpyHeader read() {
    NpyHeader header;
    std::array<bool, 3> seen{};
    expect('{');
    while (!accept('}')) {
      const std::string key = string();
      expect(':');
      if (key == "descr" && !seen[0]) {
        seen[0] = true;
        header.type = type();
      } else if (key == "fortran_order" && !seen[1]) {
        seen[1] = true;
        header.fortran = boolean();
      } else if (key == "shape" && !seen[2]) {
        seen[2] = true;
        header.shape = shape();
      } else {
        fail("has the unknown or repeated key '" + sim::shown(key) + "'");
      }
      if (!accept(',')) {
        expect('}');
        break;
      }
    }
    if (text_.find_first_not_of(" \n") != std::string_view::npos) {
      fail("goes on behind its dictionary");
    }
    if (!seen[0] || !seen[1] || !seen[2]) {
      fail("does not have 'descr', 'fortran_order' and 'shape'");
    }
    return header;
  }

 private:
  [[noreturn]] static void fail(const std::string& what) {
    throw sim::UserError("the header of the array " + what);
  }

  void skip_spaces() {
    while (text_.starts_with(' ')) {
      text_.remove_prefix(1);
    }
  }

  bool accept(char sign) {
    skip_spaces();
    const bool there = text_.starts_with(sign);
    text_.remove_prefix(there ? 1 : 0);
    return there;
  }

  void expect(char sign) {
    if (!accept(sign)) {
      fail(std::string("is no dictionary of Python: '") + sign + "' is missing");
    }
  }

  std::string string() {
    skip_spaces();
    const char quote = text_.empty() ? '\0' : text_.front();
    const std::size_t end = quote == '\'' || quote == '"' ? text_.find(quote, 1) : std::string_view::npos;
    if (end == std::string_view::npos) {
      fail("is no dictionary of Python: a text is missing");
    }
    std::string value(text_.substr(1, end - 1));
    text_.remove_prefix(end + 1);
    return value;
  }

  // Of a structure the members are passed over.
  std::string type() {
    if (!accept('[')) {
      return string();
    }
    for (int depth = 1; depth > 0; text_.remove_prefix(1)) {
      if (text_.empty()) {
        fail("is no dictionary of Python: ']' is missing");
      }
      depth += text_.front() == '[' ? 1 : text_.front() == ']' ? -1 : 0;
    }
    return "";
  }

  bool boolean() {
    skip_spaces();
    for (const std::string_view word : {"True", "False"}) {
      if (text_.starts_with(word)) {
        text_.remove_prefix(word.size());
        return word == "True";
      }
    }
    fail("has a 'fortran_order' other than True or False");
  }

  std::vector<std::uint64_t> shape() {
    std::vector<std::uint64_t> sizes;
    expect('(');
    while (!accept(')')) {
      skip_spaces();
      std::uint64_t size = 0;
      const auto [end, error] = std::from_chars(text_.data(), text_.data() + text_.size(), size);
      if (error != std::errc()) {
        fail("has a 'shape' that is no list of sizes");
      }
      text_.remove_prefix(static_cast<std::size_t>(end - text_.data()));
      sizes.push_back(size);
      if (!accept(',')) {
        expect(')');
        break;
      }
    }
    return sizes;
  }

  std::string_view text_;
};

/// So many bytes as a number, the lowest first.
std::uint32_t read_length(std::istream& in, std::size_t bytes) {
  std::array<char, 4> raw{};
  in.read(raw.data(), static_cast<std::streamsize>(bytes));
  std::uint32_t length = 0;
  for (std::size_t i = bytes; i-- > 0;) {
    length = length << 8U | static_cast<unsigned char>(raw.at(i));
  }
  return length;
}

}  // namespace

NpyHeader read_npy_header(std::istream& in) {
  std::array<char, 8> begin{};
  in.read(begin.data(), begin.size());
  if (!in || std::string_view(begin.data(), magic.size()) != magic) {
    throw sim::UserError("it is no array of NumPy (.npy): it does not begin as these do");
  }
  const auto version = static_cast<unsigned char>(begin[6]);
  if (version < 1 || version > 3) {
    throw sim::UserError("the array's file has format " + std::to_string(version) +
                         "; formats 1 to 3 of .npy files can be read");
  }
  const std::size_t length_bytes = version == 1 ? 2 : 4;
  const std::uint32_t length = read_length(in, length_bytes);
  if (in && length > longest_npy_header) {
    throw sim::UserError("the header of the array has " + std::to_string(length) + " bytes; at most " +
                         std::to_string(longest_npy_header) + " are read");
  }
  std::string text(in ? length : 0, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!in) {
    throw sim::UserError("the file ends within the header of the array");
  }
  NpyHeader header = Dictionary(text).read();
  header.bytes = begin.size() + length_bytes + length;
  return header;
}

std::string npy_header(std::string_view type, std::uint64_t rows) {
  std::string text = "{'descr': " + std::string(type) + ", 'fortran_order': False, 'shape': (" +
                     std::to_string(rows) + ",), }";
  const std::size_t before = magic.size() + 4;  // the version and the length
  text.resize((before + text.size() + alignment) / alignment * alignment - before - 1, ' ');
  text += '\n';
  std::string header(magic);
  header += {'\x01', '\0', static_cast<char>(text.size() & 0xffU), static_cast<char>(text.size() >> 8U)};
  return header + text;
}

}  // namespace marti::scenes
