#include "tests/validation/systemc/host.h"

#include <algorithm>
#include <utility>

namespace marti::oracle {

namespace {

struct Vector {
  int x = 0;
  int y = 0;
};

Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y}; }
Vector operator-(Vector a) { return {-a.x, -a.y}; }
Vector operator*(int s, Vector a) { return {s * a.x, s * a.y}; }

// Hilbert's curve through the square of `side` cells at `corner`: it leaves at the end of the edge that goes
// from there along `out`; `in` is the other edge's direction.
void add_hilbert(std::vector<Vector>& cells, Vector corner, Vector out, Vector in, int side) {
  if (side == 1) {
    cells.push_back(corner);
    return;
  }
  const int half = side / 2;
  add_hilbert(cells, corner, in, out, half);
  add_hilbert(cells, corner + half * in, out, in, half);
  add_hilbert(cells, corner + half * in + half * out, out, in, half);
  add_hilbert(cells, corner + (half - 1) * in + (side - 1) * out, -in, -out, half);
}

// The square in four quarters, each before the next: left above right, upper before lower.
void add_morton(std::vector<Vector>& cells, Vector corner, int side) {
  if (side == 1) {
    cells.push_back(corner);
    return;
  }
  const int half = side / 2;
  for (const int row : {0, half}) {
    for (const int column : {0, half}) {
      add_morton(cells, corner + Vector{column, row}, half);
    }
  }
}

}  // namespace

std::vector<Rectangle> cut_into_packets(std::uint32_t width, std::uint32_t height,
                                        const processors::machine::PacketConfig& config) {
  const auto columns = static_cast<int>((width + config.width - 1) / config.width);
  const auto rows = static_cast<int>((height + config.height - 1) / config.height);
  int side = 1;
  while (side < columns || side < rows) {
    side *= 2;
  }
  std::vector<Vector> cells;
  switch (config.order) {
    case processors::machine::PacketOrder::scanline:
      for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
          cells.push_back({column, row});
        }
      }
      break;
    case processors::machine::PacketOrder::morton:
      add_morton(cells, {}, side);
      break;
    case processors::machine::PacketOrder::hilbert:
      add_hilbert(cells, {}, {1, 0}, {0, 1}, side);
      break;
  }
  std::vector<Rectangle> packets;
  for (const Vector cell : cells) {
    if (cell.x < columns && cell.y < rows) {
      const std::uint32_t x = static_cast<std::uint32_t>(cell.x) * config.width;
      const std::uint32_t y = static_cast<std::uint32_t>(cell.y) * config.height;
      packets.push_back({x, y, std::min(width, x + config.width), std::min(height, y + config.height)});
    }
  }
  return packets;
}

Host::Host(const sc_core::sc_module_name& name, Turns& turns, const processors::machine::HostConfig& config,
           std::vector<Rectangle> packets, std::uint32_t nodes)
    : sc_module(name),
      later_("later", turns),
      assignment_(config.assignment),
      latency_(config.clock.period() * config.latency_cycles),
      occupancy_(config.clock.period() * config.occupancy_cycles),
      packets_(std::move(packets)),
      share_(nodes) {
  const std::uint64_t all = packets_.size();
  for (std::size_t packet = 0; packet < all; ++packet) {
    switch (assignment_) {
      case processors::machine::Assignment::dynamic:
        share_[0].push_back(packet);
        break;
      case processors::machine::Assignment::interleaved:
        share_[packet % nodes].push_back(packet);
        break;
      case processors::machine::Assignment::blocks: {
        std::uint64_t node = 0;
        while (packet >= all * (node + 1) / nodes) {
          ++node;
        }
        share_[node].push_back(packet);
        break;
      }
    }
  }
}

void Host::ask(std::uint32_t node, PacketUser& user) {
  const bool dynamic = assignment_ == processors::machine::Assignment::dynamic;
  std::deque<std::size_t>& share = share_[dynamic ? 0 : node];
  statistics_.requests += dynamic ? 1 : 0;
  if (share.empty()) {
    user.begin_packet({});
    return;
  }
  const Rectangle packet = packets_[share.front()];
  share.pop_front();
  if (!dynamic) {
    user.begin_packet(packet);
    return;
  }
  waiting_.push_back({&user, packet});
  serve();
}

void Host::serve() {
  if (busy_ || waiting_.empty()) {
    return;
  }
  const Request request = waiting_.front();
  waiting_.pop_front();
  busy_ = true;
  later_.after(latency_, [request] { request.user->begin_packet(request.packet); });
  later_.after(occupancy_, [this] {
    statistics_.busy += occupancy_;
    busy_ = false;
    serve();
  });
}

}  // namespace marti::oracle
