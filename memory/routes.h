// The links of each kind of network, and the route of a message over them.
//
// A `Routes` has: table_size(), the number of link numbers; links(), how many of these are links; hops(from,
// to); and route(from, to, cross), which calls cross(link) for each link of the route in order. Ports are as
// in network.h: the nodes and, last, the host. `from` and `to` differ.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace marti::memory {

/// One link for all messages.
class BusRoutes {
 public:
  explicit BusRoutes(std::uint32_t /*nodes*/) {}
  [[nodiscard]] static std::size_t table_size() { return 1; }
  [[nodiscard]] static std::int64_t links() { return 1; }
  [[nodiscard]] static std::uint32_t hops(std::uint32_t /*from*/, std::uint32_t /*to*/) { return 1; }
  template <class Cross>
  static void route(std::uint32_t /*from*/, std::uint32_t /*to*/, Cross&& cross) {
    cross(std::size_t{0});
  }
};

/// A link into each port, the host's included.
class CrossbarRoutes {
 public:
  explicit CrossbarRoutes(std::uint32_t nodes) : ports_(std::size_t{nodes} + 1) {}
  [[nodiscard]] std::size_t table_size() const { return ports_; }
  [[nodiscard]] std::int64_t links() const { return static_cast<std::int64_t>(ports_); }
  [[nodiscard]] static std::uint32_t hops(std::uint32_t /*from*/, std::uint32_t /*to*/) { return 1; }
  template <class Cross>
  static void route(std::uint32_t /*from*/, std::uint32_t to, Cross&& cross) {
    cross(std::size_t{to});
  }

 private:
  std::size_t ports_;
};

/// Adds the host, which is connected to router 0, to the routes between nodes. `Between` has table_size(),
/// links(), hops(from, to) and route(from, to, cross) for nodes, where `from` and `to` may be equal.
template <class Between>
class WithHost {
 public:
  explicit WithHost(std::uint32_t nodes) : between_(nodes), host_(nodes) {}
  [[nodiscard]] std::size_t table_size() const { return between_.table_size() + 2; }
  [[nodiscard]] std::int64_t links() const { return between_.links() + 2; }
  [[nodiscard]] std::uint32_t hops(std::uint32_t from, std::uint32_t to) const {
    return between_.hops(router(from), router(to)) + (from == host_ || to == host_ ? 1U : 0U);
  }
  template <class Cross>
  void route(std::uint32_t from, std::uint32_t to, Cross&& cross) const {
    if (from == host_) {
      cross(between_.table_size());
    }
    between_.route(router(from), router(to), cross);
    if (to == host_) {
      cross(between_.table_size() + 1);
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
class MeshRoutes {
 public:
  explicit MeshRoutes(std::uint32_t nodes)
      : nodes_(nodes), columns_(static_cast<std::uint32_t>(std::sqrt(static_cast<double>(nodes)))) {
    columns_ += std::uint64_t{columns_} * columns_ < nodes ? 1U : 0U;
    last_row_ = (nodes - 1) / columns_;
    last_length_ = nodes - last_row_ * columns_;
  }
  [[nodiscard]] std::size_t table_size() const { return std::size_t{nodes_} * 4; }
  [[nodiscard]] std::int64_t links() const {
    const std::int64_t pairs =
        std::int64_t{last_row_} * (columns_ - 1) + (last_length_ - 1) + std::int64_t{nodes_} - columns_;
    return 2 * pairs;
  }
  [[nodiscard]] std::uint32_t hops(std::uint32_t from, std::uint32_t to) const {
    const auto distance = [](std::uint32_t a, std::uint32_t b) { return a < b ? b - a : a - b; };
    return distance(from % columns_, to % columns_) + distance(from / columns_, to / columns_);
  }
  template <class Cross>
  void route(std::uint32_t from, std::uint32_t to, Cross&& cross) const {
    const std::uint32_t column = to % columns_;
    const std::uint32_t row = to / columns_;
    std::uint32_t at = from;
    if (at / columns_ == last_row_ && column >= last_length_) {
      at = along_column(at, row, cross);
    }
    for (std::uint32_t x = at % columns_; x != column;) {
      const bool right = x < column;
      cross(std::size_t{at} * 4 + (right ? 0 : 1));
      at = right ? at + 1 : at - 1;
      x = right ? x + 1 : x - 1;
    }
    along_column(at, row, cross);
  }

 private:
  template <class Cross>
  std::uint32_t along_column(std::uint32_t at, std::uint32_t row, Cross&& cross) const {
    for (std::uint32_t y = at / columns_; y != row;) {
      const bool down = y < row;
      cross(std::size_t{at} * 4 + (down ? 2 : 3));
      at = down ? at + columns_ : at - columns_;
      y = down ? y + 1 : y - 1;
    }
    return at;
  }

  std::uint32_t nodes_;
  std::uint32_t columns_;
  std::uint32_t last_row_;
  std::uint32_t last_length_;
};

/// A hypercube of the least dimension that holds all nodes; routers with numbers beyond the last node are
/// missing (Katseff, Incomplete hypercubes, IEEE Trans. Computers 37(5), 1988). At each router a message
/// crosses the lowest dimension in which it still differs from its destination and whose neighbour exists.
/// There always is one: clearing a bit leads to a lower number; when only bits of the destination are left to
/// be set, every order of setting them leads to numbers not above the destination. Without missing routers
/// this is e-cube routing.
class HypercubeRoutes {
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
  template <class Cross>
  void route(std::uint32_t from, std::uint32_t to, Cross&& cross) const {
    for (std::uint32_t at = from; at != to;) {
      std::uint32_t left = at ^ to;
      while ((at ^ (left & -left)) >= nodes_) {
        left &= left - 1;
      }
      cross(std::size_t{at} * dimension_ + static_cast<std::size_t>(std::countr_zero(left)));
      at ^= left & -left;
    }
  }

 private:
  std::uint32_t nodes_;
  std::uint32_t dimension_;
};

}  // namespace marti::memory
