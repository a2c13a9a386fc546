// Fields of a packed file, written and read by one description: a function that passes every field of a value
// to Fields, in an order that is that of the file. Of a value that is written the fields are constant.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>

#include "studies/log_file/packed_file.h"

namespace marti::studies::log_file {

/// A T that is written, or one that is read.
template <class Given, class T>
concept Described = std::same_as<std::remove_const_t<Given>, T>;

/// Stream: PackedWriter or PackedReader.
template <class Stream>
class Fields {
 public:
  explicit Fields(Stream& stream) : stream_(stream) {}

  /// Numbers, booleans, texts, and vectors and arrays of numbers.
  template <class... T>
  void operator()(T&... values) {
    (one(values), ...);
  }

  /// An enumeration with this many values. What is read is one of them.
  template <class Enum>
  void choice(Enum& value, std::size_t choices) {
    auto number = static_cast<std::uint8_t>(value);
    stream_.bytes(&number, 1);
    if constexpr (Stream::reads) {
      refuse_if(number >= choices, "is a choice that this program does not know");
      value = static_cast<Enum>(number);
    }
  }

  /// A vector, of which `describe` passes the fields of each element. These take at least one byte.
  template <class Vector, class Describe>
  void each(Vector& vector, const Describe& describe) {
    set_size(vector, 1);
    for (auto& element : vector) {
      describe(element);
    }
  }

 private:
  template <class T>
  void one(T& value) {
    using Value = std::remove_const_t<T>;
    if constexpr (std::is_same_v<Value, bool>) {
      choice(value, 2);
    } else if constexpr (std::is_arithmetic_v<Value>) {
      stream_.bytes(&value, sizeof value);
    } else {
      static_assert(std::is_arithmetic_v<typename Value::value_type>);
      if constexpr (requires(Value & vector) { vector.resize(0); }) {
        set_size(value, sizeof(typename Value::value_type));
      }
      stream_.bytes(value.data(), value.size() * sizeof(typename Value::value_type));
    }
  }

  template <class Vector>
  void set_size(Vector& vector, std::size_t packed_bytes) {
    std::uint64_t size = vector.size();
    stream_.bytes(&size, sizeof size);
    if constexpr (Stream::reads) {
      stream_.make_room(size, packed_bytes, sizeof(typename Vector::value_type));
      vector.resize(static_cast<std::size_t>(size));
    }
  }

  void refuse_if(bool wrong, const char* what) const {
    if (wrong) {
      stream_.fail(std::string("is no work log that this program can read: a field ") + what);
    }
  }

  Stream& stream_;
};

}  // namespace marti::studies::log_file
