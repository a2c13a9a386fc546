// Numbers and texts as bytes, in the host's byte order, and back without reading past the end.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

namespace marti::studies {

/// Bytes that are not what they should be; the message says what is wrong with them.
class DamagedBytes : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class ByteWriter {
 public:
  template <class Number>
  void number(Number value) {
    numbers(std::span<const Number>(&value, 1));
  }
  template <class Number>
  void numbers(std::span<const Number> values) {
    static_assert(std::is_integral_v<Number>);
    if (!values.empty()) {
      const std::size_t at = bytes_.size();
      bytes_.resize(at + values.size_bytes());
      std::memcpy(bytes_.data() + at, values.data(), values.size_bytes());
    }
  }
  void text(std::string_view text) {
    number(std::uint64_t{text.size()});
    bytes_ += text;
  }
  void reserve(std::size_t bytes) { bytes_.reserve(bytes); }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// All functions throw DamagedBytes when there are fewer bytes left than asked for.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : left_(bytes) {}

  template <class Number>
  [[nodiscard]] Number number() {
    Number value{};
    numbers(std::span<Number>(&value, 1));
    return value;
  }
  template <class Number>
  void numbers(std::span<Number> values) {
    static_assert(std::is_integral_v<Number>);
    if (!values.empty()) {
      const std::string_view bytes = take(values.size_bytes());
      std::memcpy(values.data(), bytes.data(), bytes.size());
    }
  }
  /// The number of items that follow, each of at least `item_bytes`. Throws if they cannot fit in the bytes
  /// left.
  [[nodiscard]] std::size_t count(std::size_t item_bytes) {
    const auto items = number<std::uint64_t>();
    if (items > left_.size() / item_bytes) {
      throw DamagedBytes("it ends too early");
    }
    return items;
  }
  [[nodiscard]] std::size_t left() const { return left_.size(); }
  [[nodiscard]] std::string text() { return std::string(take(count(1))); }
  void end() const {
    if (!left_.empty()) {
      throw DamagedBytes("something follows its end");
    }
  }

 private:
  std::string_view take(std::size_t bytes) {
    if (bytes > left_.size()) {
      throw DamagedBytes("it ends too early");
    }
    const std::string_view taken = left_.substr(0, bytes);
    left_.remove_prefix(bytes);
    return taken;
  }

  std::string_view left_;
};

}  // namespace marti::studies
