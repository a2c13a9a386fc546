// Files of rays, as numpy.save writes them.
#pragma once

#include <cstddef>
#include <string>
#include <type_traits>
#include <vector>

namespace marti::test {

/// The numbers as they lie in a file of float32 or float64.
template <class Number>
std::string bytes_of(const std::vector<double>& numbers) {
  std::vector<Number> narrow;
  for (const double number : numbers) {
    narrow.push_back(static_cast<Number>(number));
  }
  return {reinterpret_cast<const char*>(narrow.data()), narrow.size() * sizeof(Number)};
}

/// A file with this header, a dictionary of Python.
inline std::string npy_file(const std::string& dictionary, const std::string& data) {
  constexpr std::size_t length = 118;
  return std::string("\x93NUMPY\x01\x00", 8) + static_cast<char>(length) + '\0' + dictionary +
         std::string(length - dictionary.size() - 1, ' ') + "\n" + data;
}

/// A file of the rays whose numbers these are, 8 or 9 for each.
template <class Number = double>
std::string ray_file(const std::vector<double>& numbers, std::size_t columns = 8) {
  return npy_file("{'descr': '" + std::string(std::is_same_v<Number, float> ? "<f4" : "<f8") +
                      "', 'fortran_order': False, 'shape': (" + std::to_string(numbers.size() / columns) +
                      ", " + std::to_string(columns) + "), }",
                  bytes_of<Number>(numbers));
}

}  // namespace marti::test
