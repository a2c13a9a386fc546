// Scalars that count their own operations, so that the cost of the real templates (intersection kernel,
// traversal, shading) is measured by running them.
//
// How operations on Counted are counted:
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

/// A double that counts. Converts from double implicitly (so literals work), to double explicitly.
class Counted {
 public:
  Counted() = default;
  Counted(double value) : value_(value) {}  // implicit on purpose: templates mix in literals

  explicit operator double() const { return value_; }
  [[nodiscard]] double value() const { return value_; }

  friend Counted operator+(Counted a, Counted b) {
    ++operation_counts().add;
    return {a.value_ + b.value_};
  }
  friend Counted operator-(Counted a, Counted b) {
    ++operation_counts().add;
    return {a.value_ - b.value_};
  }
  friend Counted operator*(Counted a, Counted b) {
    ++operation_counts().multiply;
    return {a.value_ * b.value_};
  }
  friend Counted operator/(Counted a, Counted b) {
    ++operation_counts().divide;
    return {a.value_ / b.value_};
  }
  friend Counted operator-(Counted a) { return {-a.value_}; }
  Counted& operator+=(Counted b) { return *this = *this + b; }
  Counted& operator-=(Counted b) { return *this = *this - b; }
  Counted& operator*=(Counted b) { return *this = *this * b; }
  Counted& operator/=(Counted b) { return *this = *this / b; }

  friend bool operator==(Counted a, Counted b) {
    ++operation_counts().compare;
    return a.value_ == b.value_;
  }
  friend bool operator<(Counted a, Counted b) {
    ++operation_counts().compare;
    return a.value_ < b.value_;
  }
  friend bool operator<=(Counted a, Counted b) {
    ++operation_counts().compare;
    return a.value_ <= b.value_;
  }
  friend bool operator>(Counted a, Counted b) { return b < a; }
  friend bool operator>=(Counted a, Counted b) { return b <= a; }

  friend Counted sqrt(Counted a) {
    ++operation_counts().square_root;
    return {std::sqrt(a.value_)};
  }
  friend Counted abs(Counted a) {
    ++operation_counts().compare;
    return {std::abs(a.value_)};
  }
  friend Counted min(Counted a, Counted b) { return b < a ? b : a; }
  friend Counted max(Counted a, Counted b) { return a < b ? b : a; }
  friend Counted fma(Counted a, Counted b, Counted c) {
    ++operation_counts().multiply;
    ++operation_counts().add;
    return {std::fma(a.value_, b.value_, c.value_)};
  }

 private:
  double value_ = 0.0;
};

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
[[nodiscard]] inline std::uint32_t plain(std::uint32_t a) { return a; }
[[nodiscard]] inline std::uint32_t plain(CountedInt a) { return a.value(); }

}  // namespace marti::accel
