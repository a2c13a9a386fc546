// Formulas of figures: written once, they are computed here, by SQLite in a sweep's store, and printed in the
// documents.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace marti::studies::figures {

/// Whose figure a formula reads: the machine's own, or one of a machine that it is measured against.
enum class Whose : std::uint8_t {
  own,
  base,      ///< the machine of the speed-up: in a run the same machine with one node
  compared,  ///< of a sweep: the machine of [sweep.compare]
};

class Formula {
 public:
  /// A counted figure.
  explicit Formula(std::string_view figure, Whose whose = Whose::own);
  explicit Formula(double constant);
  friend Formula operator+(const Formula& a, const Formula& b) { return {'+', a, b}; }
  friend Formula operator-(const Formula& a, const Formula& b) { return {'-', a, b}; }
  friend Formula operator*(const Formula& a, const Formula& b) { return {'*', a, b}; }
  /// Has no value where the denominator is 0.
  friend Formula operator/(const Formula& a, const Formula& b) { return {'/', a, b}; }
  /// The smaller of two.
  friend Formula least(const Formula& a, const Formula& b) { return {'m', a, b}; }

  /// The same formula, which text() shows as `name`.
  [[nodiscard]] Formula named(std::string_view name) const;

  using LookUp = std::function<std::optional<double>(std::string_view figure, Whose whose)>;
  /// std::nullopt where a figure has no value or a denominator is 0. All arithmetic is that of doubles, from
  /// the leaves on, as in sql(): both give equal bits.
  [[nodiscard]] std::optional<double> value(const LookUp& figure) const;
  /// For rows r (own), b (base) and c (compared) of table `results`.
  [[nodiscard]] std::string sql() const;
  /// For people: "frame_time of the base / frame_time".
  [[nodiscard]] std::string text() const;
  /// Adds the names that text() shows, each with what it stands for.
  void add_names(std::map<std::string, std::string>& names) const;
  /// Whether it reads figures of another machine.
  [[nodiscard]] bool is_relative() const;

 private:
  struct Node;
  Formula(char operation, const Formula& a, const Formula& b);
  explicit Formula(std::shared_ptr<const Node> node) : node_(std::move(node)) {}
  std::shared_ptr<const Node> node_;
};

}  // namespace marti::studies::figures
