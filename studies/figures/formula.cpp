#include "studies/figures/formula.h"

#include <fmt/format.h>

#include <algorithm>

namespace marti::studies::figures {

struct Formula::Node {
  // 'f': a figure, 'c': a constant, 'm': the smaller of both, 'n': `a` under the name `figure`, else as
  // written
  char operation = 0;
  std::string figure{};
  Whose whose = Whose::own;
  double constant = 0.0;
  std::shared_ptr<const Node> a{};
  std::shared_ptr<const Node> b{};

  // Factors bind more strongly than terms; leaves and functions need no parentheses.
  [[nodiscard]] int strength() const {
    return operation == '+' || operation == '-' ? 0 : operation == '*' || operation == '/' ? 1 : 2;
  }
  [[nodiscard]] std::optional<double> value(const LookUp& look_up) const;
  [[nodiscard]] std::string sql() const;
  [[nodiscard]] std::string text() const;
  void add_names(std::map<std::string, std::string>& names) const {
    if (operation == 'n') {
      names.emplace(figure, a->text());
    }
    for (const Node* part : {a.get(), b.get()}) {
      if (part != nullptr) {
        part->add_names(names);
      }
    }
  }
  [[nodiscard]] bool is_relative() const {
    return operation == 'f' ? whose != Whose::own
                            : (a != nullptr && a->is_relative()) || (b != nullptr && b->is_relative());
  }
};

std::optional<double> Formula::Node::value(const LookUp& look_up) const {
  if (operation == 'f') {
    return look_up(figure, whose);
  }
  if (operation == 'c') {
    return constant;
  }
  if (operation == 'n') {
    return a->value(look_up);
  }
  const std::optional<double> left = a->value(look_up);
  const std::optional<double> right = b->value(look_up);
  if (!left || !right || (operation == '/' && *right == 0.0)) {
    return std::nullopt;
  }
  switch (operation) {
    case '+':
      return *left + *right;
    case '-':
      return *left - *right;
    case '*':
      return *left * *right;
    case '/':
      return *left / *right;
    default:
      return std::min(*left, *right);
  }
}

std::string Formula::Node::sql() const {
  if (operation == 'f') {
    constexpr std::string_view rows[] = {"r", "b", "c"};
    return fmt::format("CAST({}.\"{}\" AS REAL)", rows[static_cast<std::size_t>(whose)], figure);
  }
  if (operation == 'c') {
    return fmt::format("{:.1f}", constant);
  }
  if (operation == 'n') {
    return a->sql();
  }
  if (operation == 'm') {
    return fmt::format("MIN({}, {})", a->sql(), b->sql());
  }
  return fmt::format("({} {} {})", a->sql(), operation, b->sql());
}

std::string Formula::Node::text() const {
  if (operation == 'f') {
    constexpr std::string_view whom[] = {"", " of the base", " of the machine compared with"};
    return figure + std::string(whom[static_cast<std::size_t>(whose)]);
  }
  if (operation == 'c') {
    return fmt::format("{:g}", constant);
  }
  if (operation == 'n') {
    return figure;
  }
  if (operation == 'm') {
    return fmt::format("min({}, {})", a->text(), b->text());
  }
  const auto part = [this](const Node& node, bool right) {
    const bool weaker = node.strength() < strength() ||
                        (right && node.strength() == strength() && (operation == '-' || operation == '/'));
    return weaker ? "(" + node.text() + ")" : node.text();
  };
  return fmt::format("{} {} {}", part(*a, false), operation, part(*b, true));
}

Formula::Formula(std::string_view figure, Whose whose)
    : node_(std::make_shared<Node>(Node{.operation = 'f', .figure = std::string(figure), .whose = whose})) {}

Formula::Formula(double constant)
    : node_(std::make_shared<Node>(Node{.operation = 'c', .constant = constant})) {}

Formula::Formula(char operation, const Formula& a, const Formula& b)
    : node_(std::make_shared<Node>(Node{.operation = operation, .a = a.node_, .b = b.node_})) {}

Formula Formula::named(std::string_view name) const {
  return Formula(std::make_shared<Node>(Node{.operation = 'n', .figure = std::string(name), .a = node_}));
}

std::optional<double> Formula::value(const LookUp& figure) const { return node_->value(figure); }

std::string Formula::sql() const { return node_->sql(); }

std::string Formula::text() const { return node_->text(); }

void Formula::add_names(std::map<std::string, std::string>& names) const { node_->add_names(names); }

bool Formula::is_relative() const { return node_->is_relative(); }

}  // namespace marti::studies::figures
