// Values as bytes and back: what ranks send each other, and what checksums are made of. A number has its own
// size, the lowest byte first; a text or a list is its length in 64 bits and its items; a value that may be
// missing is 0, or 1 and the value. A struct lists its members in a static function parts().
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "sim/error.h"

namespace marti::studies::sweep {

class ByteWriter {
 public:
  template <class... Values>
  ByteWriter& write(const Values&... values) {
    (put(values), ...);
    return *this;
  }
  [[nodiscard]] std::string take() { return std::exchange(bytes_, {}); }

 private:
  template <std::integral Number>
  void put(Number number) {
    for (std::size_t i = 0; i < sizeof number; ++i) {
      bytes_ += static_cast<char>(static_cast<std::uint64_t>(number) >> (8 * i) & 0xffU);
    }
  }
  void put(const std::string& text) {
    put(std::uint64_t{text.size()});
    bytes_ += text;
  }
  template <class Item>
  void put(const std::vector<Item>& items) {
    put(std::uint64_t{items.size()});
    for (const Item& item : items) {
      put(item);
    }
  }
  template <class Value>
  void put(const std::optional<Value>& value) {
    put(value.has_value());
    if (value) {
      put(*value);
    }
  }
  template <class Struct>
  auto put(const Struct& value) -> decltype(Struct::parts(value), void()) {
    std::apply([this](const auto&... parts) { write(parts...); }, Struct::parts(value));
  }

  std::string bytes_;
};

/// Throws InternalError for bytes that a ByteWriter has not written.
class ByteReader {
 public:
  /// `what`: the bytes, for the message.
  ByteReader(std::string_view bytes, std::string_view what) : left_(bytes), what_(what) {}

  template <class... Values>
  ByteReader& read(Values&... values) {
    (get(values), ...);
    return *this;
  }
  void end() const { require(left_.empty(), "goes on after its end"); }

 private:
  template <std::integral Number>
  void get(Number& number) {
    std::uint64_t value = 0;
    const std::string_view bytes = take(sizeof number);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      value |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[i])) << (8 * i);
    }
    require(!std::same_as<Number, bool> || value <= 1, "is garbled");
    number = static_cast<Number>(value);
  }
  void get(std::string& text) {
    std::uint64_t size = 0;
    get(size);
    text = take(size);
  }
  template <class Item>
  void get(std::vector<Item>& items) {
    std::uint64_t size = 0;
    get(size);
    items.clear();
    // The list grows as it is read: a garbled size must not take memory.
    for (; size > 0; --size) {
      get(items.emplace_back());
    }
  }
  template <class Value>
  void get(std::optional<Value>& value) {
    bool there = false;
    get(there);
    value.reset();
    if (there) {
      get(value.emplace());
    }
  }
  template <class Struct>
  auto get(Struct& value) -> decltype(Struct::parts(value), void()) {
    std::apply([this](auto&... parts) { read(parts...); }, Struct::parts(value));
  }

  std::string_view take(std::uint64_t bytes) {
    require(bytes <= left_.size(), "ends too early");
    const std::string_view taken = left_.substr(0, bytes);
    left_.remove_prefix(bytes);
    return taken;
  }

  void require(bool holds, std::string_view fault) const {
    if (!holds) {
      throw sim::InternalError(std::string(what_) + " " + std::string(fault));
    }
  }

  std::string_view left_;
  std::string_view what_;
};

}  // namespace marti::studies::sweep
