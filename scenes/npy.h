// The header of a file with an array of NumPy (.npy): format 1.0 to 3.0 of numpy.lib.format, NumPy
// Enhancement Proposal 1 ("A Simple File Format for NumPy Arrays").
#pragma once

#include <cstdint>
#include <istream>
#include <string>
#include <string_view>
#include <vector>

namespace marti::scenes {

struct NpyHeader {
  std::string type;      ///< of an element, as NumPy writes it: "<f8"; of a structure, empty
  bool fortran = false;  ///< the first index changes fastest
  std::vector<std::uint64_t> shape;
  std::uint64_t bytes = 0;  ///< of the header: where the elements begin
};

/// The longest header, which NumPy does not exceed either when it reads (max_header_size).
inline constexpr std::uint32_t longest_npy_header = 10000;

/// Reads the header at the beginning of a stream and leaves it at the first element. Throws UserError,
/// without the name of the file, for anything else than the header of an array.
[[nodiscard]] NpyHeader read_npy_header(std::istream& in);

/// The header of a list of `rows` elements: of a type such as "'<f8'", or, of structures, "[('x', '<f8')]".
[[nodiscard]] std::string npy_header(std::string_view type, std::uint64_t rows);

}  // namespace marti::scenes
