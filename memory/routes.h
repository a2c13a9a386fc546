// The links of each kind of network, and the route of a message over them.
//
// A `Routes` has: table_size(), the number of link numbers; links(), how many of these are links; hops(from,
// to); route(from, to, cross), which calls cross(link) for each link of the route in order; and runs(from,
// to, visit), which calls visit(first, links) for so many links at a time, which have consecutive numbers.
// Ports are as in network.h: the nodes and, last, the host. `from` and `to` differ.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "sim/divider.h"

namespace marti::memory {

/// A route as a walk over all of its runs.
template <class Kind>
class RunByRun {
 public:
  template <class Cross>
  void route(std::uint32_t from, std::uint32_t to, Cross&& cross) const {
    static_cast<const Kind&>(*this).runs(from, to, [&](std::size_t link, std::uint32_t links) {
      for (; links != 0; --links, ++link) {
        cross(link);
      }
    });
  }
};

/// One link for all messages.
class BusRoutes : public RunByRun<BusRoutes> {
 public:
  explicit BusRoutes(std::uint32_t /*nodes*/) {}
  [[nodiscard]] static std::size_t table_size() { return 1; }
  [[nodiscard]] static std::int64_t links() { return 1; }
  [[nodiscard]] static std::uint32_t hops(std::uint32_t /*from*/, std::uint32_t /*to*/) { return 1; }
  template <class Visit>
  static void runs(std::uint32_t /*from*/, std::uint32_t /*to*/, Visit&& visit) {
    visit(std::size_t{0}, 1U);
  }
};

/// A link into each port, the host's included.
class CrossbarRoutes : public RunByRun<CrossbarRoutes> {
 public:
  explicit CrossbarRoutes(std::uint32_t nodes) : ports_(std::size_t{nodes} + 1) {}
  [[nodiscard]] std::size_t table_size() const { return ports_; }
  [[nodiscard]] std::int64_t links() const { return static_cast<std::int64_t>(ports_); }
  [[nodiscard]] static std::uint32_t hops(std::uint32_t /*from*/, std::uint32_t /*to*/) { return 1; }
  template <class Visit>
  static void runs(std::uint32_t /*from*/, std::uint32_t to, Visit&& visit) {
    visit(std::size_t{to}, 1U);
  }

 private:
  std::size_t ports_;
};

/// Adds the host, which is connected to router 0, to the routes between nodes. `Between` has table_size(),
/// links(), hops(from, to) and runs(from, to, visit) for nodes, where `from` and `to` may be equal.
template <class Between>
class WithHost : public RunByRun<WithHost<Between>> {
 public:
  explicit WithHost(std::uint32_t nodes) : between_(nodes), host_(nodes) {}
  [[nodiscard]] std::size_t table_size() const { return between_.table_size() + 2; }
  [[nodiscard]] std::int64_t links() const { return between_.links() + 2; }
  [[nodiscard]] std::uint32_t hops(std::uint32_t from, std::uint32_t to) const {
    return between_.hops(router(from), router(to)) + (from == host_ || to == host_ ? 1U : 0U);
  }
  template <class Visit>
  void runs(std::uint32_t from, std::uint32_t to, Visit&& visit) const {
    if (from == host_) {
      visit(between_.table_size(), 1U);
    }
    between_.runs(router(from), router(to), visit);
    if (to == host_) {
      visit(between_.table_size() + 1, 1U);
    }
  }

 private:
  [[nodiscard]] std::uint32_t router(std::uint32_t port) const { return port == host_ ? 0 : port; }

  Between between_;
  std::uint32_t host_;
};

/// A rectangle of routers: ceil(sqrt(nodes)) columns, node n in column n mod columns of row n / columns. The
/// last row may be short. A message goes along its row first, then along its column. Only a message from the
/// short row to a column beyond its end would so meet a missing router. It goes along its column first: the
/// columns of the short row are complete, and its destination lies in a full row. All turns from a column
/// into a row are thus upwards and to the right, which creates no cycle of waiting messages.
///
/// Links of a row, and of a column, have consecutive numbers in the order in which messages cross them: in a
/// large mesh a message crosses hundreds, whose entries in a table are used several at a time.
class MeshRoutes : public RunByRun<MeshRoutes> {
 public:
  explicit MeshRoutes(std::uint32_t nodes) : nodes_(nodes), columns_(columns_of(nodes)), row_of_(columns_) {
    last_row_ = (nodes - 1) / columns_;
    last_length_ = nodes - last_row_ * columns_;
  }
  [[nodiscard]] std::size_t table_size() const { return 4 * places(); }
  [[nodiscard]] std::int64_t links() const {
    const std::int64_t pairs =
        std::int64_t{last_row_} * (columns_ - 1) + (last_length_ - 1) + std::int64_t{nodes_} - columns_;
    return 2 * pairs;
  }
  [[nodiscard]] std::uint32_t hops(std::uint32_t from, std::uint32_t to) const {
    const auto distance = [](std::uint32_t a, std::uint32_t b) { return a < b ? b - a : a - b; };
    const Place a = place_of(from);
    const Place b = place_of(to);
    return distance(a.column, b.column) + distance(a.row, b.row);
  }
  template <class Visit>
  void runs(std::uint32_t from, std::uint32_t to, Visit&& visit) const {
    const Place begin = place_of(from);
    const Place end = place_of(to);
    if (begin.row == last_row_ && end.column >= last_length_) [[unlikely]] {
      along_column(begin, end.row, visit);
      along_row({begin.column, end.row}, end.column, visit);
      return;
    }
    along_row(begin, end.column, visit);
    along_column({end.column, begin.row}, end.row, visit);
  }

 private:
  struct Place {
    std::uint32_t column;
    std::uint32_t row;
  };

  static std::uint32_t columns_of(std::uint32_t nodes) {
    const auto root = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(nodes)));
    return std::uint64_t{root} * root < nodes ? root + 1 : root;
  }
  [[nodiscard]] Place place_of(std::uint32_t router) const {
    const auto row = static_cast<std::uint32_t>(row_of_(router));
    return {router - row * columns_, row};
  }
  // Routers, missing ones of the last row included.
  [[nodiscard]] std::size_t places() const { return std::size_t{columns_} * (last_row_ + 1); }
  // Links to the right, to the left, down and up follow one another in tables of so many.
  template <class Visit>
  void along_row(Place at, std::uint32_t column, Visit&& visit) const {
    straight(std::size_t{at.row} * columns_, columns_, at.column, column, visit);
  }
  template <class Visit>
  void along_column(Place at, std::uint32_t row, Visit&& visit) const {
    const std::uint32_t rows = last_row_ + 1;
    straight(2 * places() + std::size_t{at.column} * rows, rows, at.row, row, visit);
  }
  // The links between two of the `routers` routers of a row or column. `first`: that onwards from number 0.
  // Written so that compilers need no branch, which would not be predictable.
  template <class Visit>
  void straight(std::size_t first, std::uint32_t routers, std::uint32_t from, std::uint32_t to,
                Visit&& visit) const {
    const bool onwards = from < to;
    const std::uint32_t links = onwards ? to - from : from - to;
    visit(first + (onwards ? from : places() + (routers - 1 - from)), links);
  }

  std::uint32_t nodes_;
  std::uint32_t columns_;
  sim::Divider row_of_;
  std::uint32_t last_row_;
  std::uint32_t last_length_;
};

/// A hypercube of the least dimension that holds all nodes; routers with numbers beyond the last node are
/// missing (Katseff, Incomplete hypercubes, IEEE Trans. Computers 37(5), 1988). At each router a message
/// crosses the lowest dimension in which it still differs from its destination and whose neighbour exists.
/// There always is one: clearing a bit leads to a lower number; when only bits of the destination are left to
/// be set, every order of setting them leads to numbers not above the destination. Without missing routers
/// this is e-cube routing.
class HypercubeRoutes : public RunByRun<HypercubeRoutes> {
 public:
  explicit HypercubeRoutes(std::uint32_t nodes)
      : nodes_(nodes), dimension_(static_cast<std::uint32_t>(std::bit_width(nodes - 1))) {}
  [[nodiscard]] std::size_t table_size() const { return std::size_t{nodes_} * dimension_; }
  [[nodiscard]] std::int64_t links() const {
    std::int64_t pairs = 0;  // each pair counts once, at its higher number
    for (std::uint32_t node = 0; node < nodes_; ++node) {
      pairs += std::popcount(node);
    }
    return 2 * pairs;
  }
  [[nodiscard]] static std::uint32_t hops(std::uint32_t from, std::uint32_t to) {
    return static_cast<std::uint32_t>(std::popcount(from ^ to));
  }
  template <class Visit>
  void runs(std::uint32_t from, std::uint32_t to, Visit&& visit) const {
    for (std::uint32_t at = from; at != to;) {
      std::uint32_t left = at ^ to;
      while ((at ^ (left & -left)) >= nodes_) {
        left &= left - 1;
      }
      visit(std::size_t{at} * dimension_ + static_cast<std::size_t>(std::countr_zero(left)), 1U);
      at ^= left & -left;
    }
  }

 private:
  std::uint32_t nodes_;
  std::uint32_t dimension_;
};

}  // namespace marti::memory
