// PLY files made by the tests: a header, and values as text or as bytes of either order.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <sstream>
#include <string>

namespace marti::scenes::testing {

enum class PlyOrder : std::uint8_t { text, little, big };

inline const char* name_of(PlyOrder order) {
  return order == PlyOrder::text     ? "ascii"
         : order == PlyOrder::little ? "binary_little_endian"
                                     : "binary_big_endian";
}

/// Values behind a header, appended one by one.
class PlyBody {
 public:
  explicit PlyBody(PlyOrder order) : order_(order) {}

  template <class T>
  PlyBody& add(T value) {
    if (order_ == PlyOrder::text) {
      std::ostringstream text;
      text.precision(17);
      text << +value << ' ';
      bytes_ += text.str();
      return *this;
    }
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    if (order_ == PlyOrder::big) {
      std::reverse(bytes.begin(), bytes.end());
    }
    bytes_ += bytes;
    return *this;
  }
  /// Ends an entry.
  PlyBody& end() {
    bytes_ += order_ == PlyOrder::text ? "\n" : "";
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  PlyOrder order_;
  std::string bytes_;
};

/// A whole file with these declarations.
inline std::string ply_file(PlyOrder order, const std::string& declarations, const PlyBody& body) {
  return std::string("ply\nformat ") + name_of(order) + " 1.0\n" + declarations + "end_header\n" +
         body.bytes();
}

}  // namespace marti::scenes::testing
