#include "scenes/ply_values.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "sim/error.h"
#include "sim/parse_number.h"

namespace marti::scenes {

namespace {

template <class T>
double loaded(const std::array<char, 8>& bytes) {
  T value;
  std::memcpy(&value, bytes.data(), sizeof value);
  return static_cast<double>(value);
}

/// The value of bytes in the order of this machine, which is little-endian.
double loaded(const std::array<char, 8>& bytes, PlyType type) {
  switch (type) {
    case PlyType::i8:
      return loaded<std::int8_t>(bytes);
    case PlyType::u8:
      return loaded<std::uint8_t>(bytes);
    case PlyType::i16:
      return loaded<std::int16_t>(bytes);
    case PlyType::u16:
      return loaded<std::uint16_t>(bytes);
    case PlyType::i32:
      return loaded<std::int32_t>(bytes);
    case PlyType::u32:
      return loaded<std::uint32_t>(bytes);
    case PlyType::f32:
      return loaded<float>(bytes);
    case PlyType::f64:
      break;
  }
  return loaded<double>(bytes);
}

/// Whether an integer type has the value.
bool holds(PlyType type, std::int64_t value) {
  const bool is_signed = type == PlyType::i8 || type == PlyType::i16 || type == PlyType::i32;
  const std::int64_t values = std::int64_t{1} << (8 * size_of(type));
  return is_signed ? value >= -values / 2 && value < values / 2 : value >= 0 && value < values;
}

}  // namespace

PlyValues::PlyValues(std::string_view text, std::string name, PlyFormat format, TextLines& lines)
    : text_(text),
      name_(std::move(name)),
      format_(format),
      lines_(lines),
      next_(lines.end()),
      last_(lines.end()) {}

void PlyValues::begin(const PlyElement& element, std::uint64_t entry) {
  element_ = &element;
  entry_ = entry;
  word_ = 0;
  if (format_ == PlyFormat::ascii && !lines_.next()) {
    fail("the file ends before " + entry_name());
  }
}

double PlyValues::value(PlyType type) {
  return format_ == PlyFormat::ascii ? value_of_word(type) : value_of_bytes(type);
}

double PlyValues::any_number(PlyType type, LeftOut& left_out) {
  if (format_ == PlyFormat::ascii && is_integer(type) && word_ < lines_.words().size()) {
    const std::string_view word = lines_.words()[word_];
    const auto whole = sim::parse_number<std::int64_t>(word);
    const auto number = sim::parse_number<double>(word);
    if (number && !(whole && holds(type, *whole))) {
      left_out.replace("normals' coordinates that are not of their property's type, by the numbers given",
                       lines_.refusal(in_quotes(word) + " is no whole number of its type"));
      ++word_;
      return *number;
    }
  }
  return value(type);
}

void PlyValues::pass_over(PlyType type) {
  if (format_ == PlyFormat::ascii && word_ < lines_.words().size()) {
    ++word_;
  } else {
    static_cast<void>(value(type));
  }
}

double PlyValues::value_of_word(PlyType type) {
  if (word_ == lines_.words().size()) {
    fail("the line ends within " + entry_name());
  }
  const std::size_t word = word_++;
  if (!is_integer(type)) {
    const double value = lines_.number(word);
    if (type == PlyType::f64) {
      return value;
    }
    if (std::isfinite(value) && std::abs(value) > std::numeric_limits<float>::max()) {
      fail(in_quotes(lines_.words()[word]) + " is beyond the range of a float");
    }
    return static_cast<double>(static_cast<float>(value));
  }
  const std::int64_t value = lines_.integer(lines_.words()[word]);
  if (!holds(type, value)) {
    fail(std::to_string(value) + " is beyond the range of its type");
  }
  return static_cast<double>(value);
}

double PlyValues::value_of_bytes(PlyType type) {
  const std::size_t size = size_of(type);
  last_ = next_;
  if (text_.size() - next_ < size) {
    fail("the file ends within " + entry_name());
  }
  std::array<char, 8> bytes{};
  std::memcpy(bytes.data(), text_.data() + next_, size);
  if (format_ == PlyFormat::binary_big_endian) {
    std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
  }
  next_ += size;
  return loaded(bytes, type);
}

std::uint64_t PlyValues::length(const PlyProperty& list) {
  const double length = value(*list.count);
  const std::size_t left = format_ == PlyFormat::ascii ? lines_.words().size() - word_
                                                       : (text_.size() - next_) / size_of(list.type);
  if (!(length >= 0.0 && length <= static_cast<double>(left))) {
    fail("a list of " + std::to_string(static_cast<std::int64_t>(length)) + " values in " + entry_name() +
         ", for which " + std::to_string(left) + " are left in the " +
         (format_ == PlyFormat::ascii ? "line" : "file"));
  }
  return static_cast<std::uint64_t>(length);
}

void PlyValues::end() {
  if (format_ == PlyFormat::ascii && word_ < lines_.words().size()) {
    fail("the line goes on after " + entry_name() + ", with " + in_quotes(lines_.words()[word_]));
  }
}

void PlyValues::finish() {
  if (format_ == PlyFormat::ascii ? lines_.next() : next_ < text_.size()) {
    last_ = next_;
    fail("the file goes on after its last element");
  }
}

std::string PlyValues::entry_name() const {
  return "entry " + std::to_string(entry_) + " of the element " + in_quotes(element_->name);
}

void PlyValues::fail(const std::string& what) const {
  if (format_ == PlyFormat::ascii) {
    lines_.fail(what);
  }
  throw sim::UserError(name_ + ": byte " + std::to_string(last_) + ": " + what);
}

}  // namespace marti::scenes
