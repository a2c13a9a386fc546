// Scalars that count their own operations, so that the cost of the real templates (intersection kernel,
// traversal, shading) is measured by running them.
//
// How operations on Counted and CountedFloat are counted:
//   add          + and - of two values, += and -=
//   multiply     *
//   divide       /
//   square_root  sqrt
//   compare      < <= > >= == !=, and one each for min, max and abs
//   one multiply and one add for fma
//   nothing      negation, copies, assignment, conversion from and to double (a load or a register move)
// On CountedInt every operator but copy, assignment and conversion is one integer operation: + - * & | ^ ~
// << >> and the comparisons. Multiplying by a power of two is a multiplication: the templates are counted
// as they are written, not as a compiler may improve them.
#pragma once

#include <cmath>
#include <cstdint>
#include <type_traits>

namespace marti::accel {

/// How many operations of each kind were executed.
struct OperationCounts {
  std::uint64_t add = 0;
  std::uint64_t multiply = 0;
  std::uint64_t divide = 0;
  std::uint64_t square_root = 0;
  std::uint64_t compare = 0;
  std::uint64_t integer = 0;

  bool operator==(const OperationCounts&) const = default;

  OperationCounts& operator+=(const OperationCounts& other) {
    add += other.add;
    multiply += other.multiply;
    divide += other.divide;
    square_root += other.square_root;
    compare += other.compare;
    integer += other.integer;
    return *this;
  }
  /// The operations between two readings: later - earlier.
  friend OperationCounts operator-(OperationCounts later, const OperationCounts& earlier) {
    later.add -= earlier.add;
    later.multiply -= earlier.multiply;
    later.divide -= earlier.divide;
    later.square_root -= earlier.square_root;
    later.compare -= earlier.compare;
    later.integer -= earlier.integer;
    return later;
  }
};

/// The calling thread's counters: all operations on Counted and CountedInt on this thread since it began.
/// Read them before and after, or assign {} to start from zero.
[[nodiscard]] inline OperationCounts& operation_counts() {
  thread_local OperationCounts counts;
  return counts;
}

/// A floating-point number that counts. Converts from its value implicitly (so literals work), to it
/// explicitly.
template <class Value>
class CountedValue {
 public:
  CountedValue() = default;
  CountedValue(Value value) : value_(value) {}  // implicit on purpose: templates mix in literals

  explicit operator Value() const { return value_; }
  [[nodiscard]] Value value() const { return value_; }

  friend CountedValue operator+(CountedValue a, CountedValue b) {
    ++operation_counts().add;
    return {a.value_ + b.value_};
  }
  friend CountedValue operator-(CountedValue a, CountedValue b) {
    ++operation_counts().add;
    return {a.value_ - b.value_};
  }
  friend CountedValue operator*(CountedValue a, CountedValue b) {
    ++operation_counts().multiply;
    return {a.value_ * b.value_};
  }
  friend CountedValue operator/(CountedValue a, CountedValue b) {
    ++operation_counts().divide;
    return {a.value_ / b.value_};
  }
  friend CountedValue operator-(CountedValue a) { return {-a.value_}; }
  CountedValue& operator+=(CountedValue b) { return *this = *this + b; }
  CountedValue& operator-=(CountedValue b) { return *this = *this - b; }
  CountedValue& operator*=(CountedValue b) { return *this = *this * b; }
  CountedValue& operator/=(CountedValue b) { return *this = *this / b; }

  friend bool operator==(CountedValue a, CountedValue b) {
    ++operation_counts().compare;
    return a.value_ == b.value_;
  }
  friend bool operator<(CountedValue a, CountedValue b) {
    ++operation_counts().compare;
    return a.value_ < b.value_;
  }
  friend bool operator<=(CountedValue a, CountedValue b) {
    ++operation_counts().compare;
    return a.value_ <= b.value_;
  }
  friend bool operator>(CountedValue a, CountedValue b) { return b < a; }
  friend bool operator>=(CountedValue a, CountedValue b) { return b <= a; }

  friend CountedValue sqrt(CountedValue a) {
    ++operation_counts().square_root;
    return {std::sqrt(a.value_)};
  }
  friend CountedValue abs(CountedValue a) {
    ++operation_counts().compare;
    return {std::abs(a.value_)};
  }
  friend CountedValue min(CountedValue a, CountedValue b) { return b < a ? b : a; }
  friend CountedValue max(CountedValue a, CountedValue b) { return a < b ? b : a; }
  friend CountedValue fma(CountedValue a, CountedValue b, CountedValue c) {
    ++operation_counts().multiply;
    ++operation_counts().add;
    return {std::fma(a.value_, b.value_, c.value_)};
  }

 private:
  Value value_ = 0;
};

using Counted = CountedValue<double>;
using CountedFloat = CountedValue<float>;

/// A 32-bit unsigned integer that counts its operations.
class CountedInt {
 public:
  CountedInt() = default;
  CountedInt(std::uint32_t value) : value_(value) {}  // implicit on purpose: templates mix in literals

  explicit operator std::uint32_t() const { return value_; }
  [[nodiscard]] std::uint32_t value() const { return value_; }

  friend CountedInt operator+(CountedInt a, CountedInt b) { return count(a.value_ + b.value_); }
  friend CountedInt operator-(CountedInt a, CountedInt b) { return count(a.value_ - b.value_); }
  friend CountedInt operator*(CountedInt a, CountedInt b) { return count(a.value_ * b.value_); }
  friend CountedInt operator&(CountedInt a, CountedInt b) { return count(a.value_ & b.value_); }
  friend CountedInt operator|(CountedInt a, CountedInt b) { return count(a.value_ | b.value_); }
  friend CountedInt operator^(CountedInt a, CountedInt b) { return count(a.value_ ^ b.value_); }
  friend CountedInt operator<<(CountedInt a, CountedInt b) { return count(a.value_ << b.value_); }
  friend CountedInt operator>>(CountedInt a, CountedInt b) { return count(a.value_ >> b.value_); }
  friend CountedInt operator~(CountedInt a) { return count(~a.value_); }

  friend bool operator==(CountedInt a, CountedInt b) { return count(a.value_ == b.value_); }
  friend bool operator<(CountedInt a, CountedInt b) { return count(a.value_ < b.value_); }
  friend bool operator<=(CountedInt a, CountedInt b) { return count(a.value_ <= b.value_); }
  friend bool operator>(CountedInt a, CountedInt b) { return count(a.value_ > b.value_); }
  friend bool operator>=(CountedInt a, CountedInt b) { return count(a.value_ >= b.value_); }

 private:
  static CountedInt count(std::uint32_t value) {
    ++operation_counts().integer;
    return {value};
  }
  static bool count(bool value) {
    ++operation_counts().integer;
    return value;
  }

  std::uint32_t value_ = 0;
};

/// The integer type to use with a real: CountedInt with Counted, std::uint32_t with others.
template <class Real>
using IntegerOf = std::conditional_t<std::is_same_v<Real, Counted>, CountedInt, std::uint32_t>;

/// The value of a plain or counting scalar, uncounted.
[[nodiscard]] inline double plain(double a) { return a; }
[[nodiscard]] inline double plain(Counted a) { return a.value(); }
[[nodiscard]] inline float plain(CountedFloat a) { return a.value(); }
[[nodiscard]] inline std::uint32_t plain(std::uint32_t a) { return a; }
[[nodiscard]] inline std::uint32_t plain(CountedInt a) { return a.value(); }

}  // namespace marti::accel
