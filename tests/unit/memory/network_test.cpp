// Networks against formulas, against a second implementation that walks coordinates, and against laws of
// every network: messages, time and links add up.
#include "memory/network.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "memory/line_times.h"
#include "memory/link_times.h"
#include "memory/routes.h"
#include "sim/error.h"

namespace marti::memory {
namespace {

NetworkConfig config_of(NetworkKind kind) {
  NetworkConfig config;
  config.kind = kind;
  config.clock = sim::Clock::from_period(10);
  config.width = 4;
  config.cycles_per_beat = 1;
  config.hop_cycles = 3;
  return config;
}

std::uint32_t columns_of(std::uint32_t nodes) {
  std::uint32_t columns = 1;
  while (columns * columns < nodes) {
    ++columns;
  }
  return columns;
}

// The routers a message visits, by rules written down independently of routes.h.
std::vector<std::uint32_t> routers_of(NetworkKind kind, std::uint32_t nodes, std::uint32_t from,
                                      std::uint32_t to) {
  std::vector<std::uint32_t> way = {from};
  if (kind == NetworkKind::hypercube) {
    while (way.back() != to) {
      std::uint32_t next = way.back();
      for (std::uint32_t bit = 1; next == way.back(); bit <<= 1U) {
        if (((way.back() ^ to) & bit) != 0 && (way.back() ^ bit) < nodes) {
          next = way.back() ^ bit;
        }
      }
      way.push_back(next);
    }
    return way;
  }
  const auto columns = static_cast<int>(columns_of(nodes));
  int x = static_cast<int>(from) % columns;
  int y = static_cast<int>(from) / columns;
  const int to_x = static_cast<int>(to) % columns;
  const int to_y = static_cast<int>(to) / columns;
  const bool column_first = y * columns + to_x >= static_cast<int>(nodes);
  const auto along_row = [&] {
    while (x != to_x) {
      x += x < to_x ? 1 : -1;
      way.push_back(static_cast<std::uint32_t>(y * columns + x));
    }
  };
  const auto along_column = [&] {
    while (y != to_y) {
      y += y < to_y ? 1 : -1;
      way.push_back(static_cast<std::uint32_t>(y * columns + x));
    }
  };
  if (column_first) {
    along_column();
    along_row();
  } else {
    along_row();
    along_column();
  }
  return way;
}

// A link is a pair of ports; the host's links are those with port `nodes`.
using NamedLink = std::pair<std::uint32_t, std::uint32_t>;

std::vector<NamedLink> links_of(NetworkKind kind, std::uint32_t nodes, std::uint32_t from, std::uint32_t to) {
  if (kind == NetworkKind::bus) {
    return {{0, 0}};
  }
  if (kind == NetworkKind::crossbar) {
    return {{0, to}};
  }
  std::vector<NamedLink> links;
  if (from == nodes) {
    links.emplace_back(nodes, 0);
  }
  const std::vector<std::uint32_t> way =
      routers_of(kind, nodes, from == nodes ? 0 : from, to == nodes ? 0 : to);
  for (std::size_t i = 1; i < way.size(); ++i) {
    links.emplace_back(way[i - 1], way[i]);
  }
  if (to == nodes) {
    links.emplace_back(0, nodes);
  }
  return links;
}

constexpr std::array routed = {NetworkKind::bus, NetworkKind::crossbar, NetworkKind::mesh,
                               NetworkKind::hypercube};

TEST(Network, EveryPairOfSmallNetworksTakesItsHopsAndBeats) {
  for (std::uint32_t nodes = 1; nodes <= 24; ++nodes) {
    for (const NetworkKind kind : routed) {
      for (std::uint32_t from = 0; from <= nodes; ++from) {
        for (std::uint32_t to = 0; to <= nodes; ++to) {
          const std::unique_ptr<Network> network = make_network(config_of(kind), nodes);
          const Delivery delivery = network->send(1000, from, to, 9);
          if (from == to) {
            EXPECT_EQ(delivery.arrival, 1000);
            EXPECT_EQ(network->statistics().messages, 0);
            continue;
          }
          const std::uint32_t a = from == nodes ? 0 : from;
          const std::uint32_t b = to == nodes ? 0 : to;
          const int host = from == nodes || to == nodes ? 1 : 0;
          const auto columns = static_cast<int>(columns_of(nodes));
          int hops = 1;
          if (kind == NetworkKind::mesh) {
            hops = std::abs(static_cast<int>(a) % columns - static_cast<int>(b) % columns) +
                   std::abs(static_cast<int>(a) / columns - static_cast<int>(b) / columns) + host;
          } else if (kind == NetworkKind::hypercube) {
            hops = std::popcount(a ^ b) + host;
          }
          EXPECT_EQ(delivery.arrival, 1000 + hops * 30 + 3 * 10) << nodes << ": " << from << " to " << to;
          EXPECT_EQ(delivery.wait, 0);
          EXPECT_EQ(delivery.transfer, delivery.arrival - 1000);
          EXPECT_EQ(network->unloaded(from, to, 9), delivery.transfer);
          EXPECT_EQ(network->statistics().hops, hops);
          EXPECT_EQ(network->statistics().bytes, 9);
          EXPECT_EQ(network->statistics().link_bytes, 9 * hops);
          EXPECT_EQ(network->statistics().busy, kind == NetworkKind::bus ? 60 : hops * 30);
        }
      }
    }
  }
}

TEST(Network, NoWayLeadsThroughARouterThatIsNotThere) {
  for (std::uint32_t nodes = 1; nodes <= 70; ++nodes) {
    std::set<std::size_t> numbers_of_mesh;
    std::set<std::size_t> numbers_of_cube;
    const MeshRoutes mesh(nodes);
    const HypercubeRoutes cube(nodes);
    for (std::uint32_t from = 0; from < nodes; ++from) {
      for (std::uint32_t to = 0; to < nodes; ++to) {
        for (const NetworkKind kind : {NetworkKind::mesh, NetworkKind::hypercube}) {
          for (const std::uint32_t router : routers_of(kind, nodes, from, to)) {
            ASSERT_LT(router, nodes) << nodes << ": " << from << " to " << to;
          }
        }
        mesh.route(from, to, [&](std::size_t link) {
          EXPECT_LT(link, mesh.table_size());
          numbers_of_mesh.insert(link);
        });
        cube.route(from, to, [&](std::size_t link) {
          EXPECT_LT(link, cube.table_size());
          numbers_of_cube.insert(link);
        });
      }
    }
    // Every link lies on some way: at least on that between its ends.
    EXPECT_EQ(static_cast<std::int64_t>(numbers_of_mesh.size()), mesh.links()) << nodes;
    EXPECT_EQ(static_cast<std::int64_t>(numbers_of_cube.size()), cube.links()) << nodes;
  }
}

TEST(Network, LinksAreTheSameAsByTheRulesWrittenDownAgain) {
  for (const std::uint32_t nodes : {1U, 2U, 3U, 5U, 7U, 8U, 11U, 12U, 16U, 21U, 30U}) {
    for (const NetworkKind kind : {NetworkKind::mesh, NetworkKind::hypercube}) {
      std::map<NamedLink, std::size_t> numbers;
      std::map<std::size_t, NamedLink> names;
      const auto same = [&](const auto& routes) {
        for (std::uint32_t from = 0; from <= nodes; ++from) {
          for (std::uint32_t to = 0; to <= nodes; ++to) {
            if (from == to) {
              continue;
            }
            const std::vector<NamedLink> expected = links_of(kind, nodes, from, to);
            std::vector<std::size_t> taken;
            routes.route(from, to, [&](std::size_t link) { taken.push_back(link); });
            ASSERT_EQ(taken.size(), expected.size());
            for (std::size_t i = 0; i < taken.size(); ++i) {
              ASSERT_EQ(numbers.try_emplace(expected[i], taken[i]).first->second, taken[i]);
              ASSERT_EQ(names.try_emplace(taken[i], expected[i]).first->second, expected[i]);
            }
          }
        }
      };
      kind == NetworkKind::mesh ? same(WithHost<MeshRoutes>(nodes)) : same(WithHost<HypercubeRoutes>(nodes));
    }
  }
}

// Each link remembers every tenure it granted; a message looks through all of them.
class ListedLinks {
 public:
  explicit ListedLinks(const NetworkConfig& config) : config_(config) {}
  Delivery send(sim::Ticks now, const std::vector<NamedLink>& way, std::uint32_t bytes) {
    const sim::Ticks hop = config_.clock.cycles(config_.hop_cycles);
    const std::int64_t beats = bytes / config_.width + (bytes % config_.width == 0 ? 0 : 1);
    const sim::Ticks data = config_.clock.cycles(config_.cycles_per_beat * beats);
    sim::Ticks head = now;
    Delivery delivery;
    for (const NamedLink& link : way) {
      sim::Ticks start = head;
      for (const auto& [begin, end] : tenures_[link]) {
        start = std::max(start, end);
      }
      const sim::Ticks held = config_.kind == NetworkKind::bus ? hop + data : data;
      tenures_[link].emplace_back(start, start + held);
      busy += held;
      delivery.wait += start - head;
      head = start + hop;
    }
    delivery.arrival = head + data;
    delivery.transfer = static_cast<sim::Ticks>(way.size()) * hop + data;
    return delivery;
  }
  void check_no_overlap() const {
    for (const auto& [link, tenures] : tenures_) {
      for (std::size_t i = 1; i < tenures.size(); ++i) {
        RC_ASSERT(tenures[i - 1].second <= tenures[i].first);
      }
    }
  }
  sim::Ticks busy = 0;

 private:
  NetworkConfig config_;
  std::map<NamedLink, std::vector<std::pair<sim::Ticks, sim::Ticks>>> tenures_;
};

RC_GTEST_PROP(Network, RandomTrafficIsFirstComeFirstServedOnEveryLink, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const auto pick = [&](std::uint32_t lo, std::uint32_t hi) {
    return lo + static_cast<std::uint32_t>(random() % (hi - lo + 1));
  };
  for (const NetworkKind kind : routed) {
    NetworkConfig config = config_of(kind);
    config.width = pick(1, 9);
    config.cycles_per_beat = pick(0, 2);
    config.hop_cycles = pick(0, 3);
    // In the larger ones messages take many links of a row together.
    const std::uint32_t nodes = pick(0, 2) == 0 ? pick(400, 2000) : pick(1, 40);
    const std::unique_ptr<Network> network = make_network(config, nodes);
    ListedLinks oracle(config);
    sim::Ticks now = 0;
    sim::Ticks waits = 0;
    std::int64_t messages = 0;
    std::int64_t bytes = 0;
    std::int64_t hops = 0;
    std::map<NamedLink, sim::Ticks> last;
    for (int i = 0; i < 150; ++i) {
      now += pick(0, 2) == 0 ? pick(0, 200) : 0;
      const std::uint32_t from = pick(0, nodes);
      const std::uint32_t to = pick(0, 3) == 0 ? 0 : pick(0, nodes);
      const std::uint32_t length = pick(1, 100);
      const Delivery got = network->send(now, from, to, length);
      RC_ASSERT(got.arrival == now + got.wait + got.transfer);
      if (from == to) {
        RC_ASSERT(got.arrival == now);
        continue;
      }
      const std::vector<NamedLink> way = links_of(kind, nodes, from, to);
      const Delivery expected = oracle.send(now, way, length);
      RC_ASSERT(got.arrival == expected.arrival);
      RC_ASSERT(got.wait == expected.wait);
      RC_ASSERT(got.transfer == expected.transfer);
      sim::Ticks& before = last[{from, to}];
      RC_ASSERT(got.arrival >= before);
      before = got.arrival;
      ++messages;
      bytes += length;
      hops += static_cast<std::int64_t>(way.size());
      waits += got.wait;
    }
    oracle.check_no_overlap();
    const NetworkStatistics& counted = network->statistics();
    RC_ASSERT(counted.messages == messages);
    RC_ASSERT(counted.bytes == bytes);
    RC_ASSERT(counted.hops == hops);
    RC_ASSERT(counted.busy == oracle.busy);
    RC_ASSERT(counted.waits.count == messages);
    RC_ASSERT(counted.waits.sum == waits);
  }
}

// Lines of links in pieces beside a time for each link: messages of several lengths, among them such that
// wait at many links, over lines that begin and end within words of bits and at their ends.
RC_GTEST_PROP(Network, LongLinesKeepTheTimeOfEveryLink, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const auto pick = [&](std::uint64_t lo, std::uint64_t hi) { return lo + random() % (hi - lo + 1); };
  const std::size_t line = pick(1, 200);
  const std::size_t lines = pick(1, 4);
  const std::uint64_t hop = pick(0, 3) == 0 ? pick(0, 3) : pick(10, 100);
  LineTimes pieces(line * lines, hop);
  LinkTimes links(line * lines);
  std::uint64_t now = 0;
  const std::uint64_t step = pick(1, 2000);
  for (int message = 0; message < 2000; ++message) {
    now += pick(0, step);
    const std::size_t from = pick(0, line - 1);
    const std::size_t first = line * pick(0, lines - 1) + from;
    const auto count = static_cast<std::uint32_t>(pick(0, 5) == 0 ? line - from : pick(0, line - from));
    const std::uint64_t held = pick(0, 20) * 30;
    Crossing one = {now, hop, held};
    Crossing other = {now, hop, held};
    pieces.take(first, count, one);
    links.take(first, count, other);
    RC_ASSERT(one.head == other.head);
  }
  for (std::size_t link = 0; link < line * lines; ++link) {
    Crossing one = {0, hop, 1};
    Crossing other = {0, hop, 1};
    pieces.take(link, 1, one);
    links.take(link, 1, other);
    RC_ASSERT(one.head == other.head);
  }
}

TEST(Network, AnIdealOneTakesItsLatencyWhateverElseGoesOn) {
  const std::unique_ptr<Network> network = make_network(config_of(NetworkKind::ideal), 5);
  for (std::uint32_t to = 1; to <= 5; ++to) {
    const Delivery delivery = network->send(7, 0, to, 1000 * to);
    EXPECT_EQ(delivery.arrival, 37);
    EXPECT_EQ(delivery.transfer, 30);
    EXPECT_EQ(network->unloaded(0, to, 1), 30);
  }
  EXPECT_EQ(network->statistics().messages, 5);
  EXPECT_EQ(network->statistics().links, 0);
  EXPECT_EQ(network->statistics().busy, 0);
}

TEST(Network, SixtyFourNodesAndAHostKeepADimensionOfSix) {
  const std::unique_ptr<Network> network = make_network(config_of(NetworkKind::hypercube), 64);
  EXPECT_EQ(network->statistics().links, 64 * 6 + 2);
  EXPECT_EQ(network->unloaded(64, 63, 1) - network->unloaded(0, 1, 1), 6 * 30)
      << "seven links instead of one";
}

TEST(Network, SixtyFiveThousandNodesFitAndTheirLinksAreCompact) {
  constexpr std::uint32_t nodes = 65536;
  EXPECT_LE(network_bytes(config_of(NetworkKind::mesh), nodes), 3U << 20U);
  EXPECT_LE(network_bytes(config_of(NetworkKind::hypercube), nodes), 9U << 20U);
  for (const NetworkKind kind : {NetworkKind::mesh, NetworkKind::hypercube, NetworkKind::crossbar}) {
    const std::unique_ptr<Network> network = make_network(config_of(kind), nodes);
    EXPECT_EQ(network->send(0, 0, nodes - 1, 4).arrival,
              (kind == NetworkKind::mesh ? 510 : (kind == NetworkKind::hypercube ? 16 : 1)) * 30 + 10);
  }
}

TEST(Network, RefusesLinksOfNoWidth) {
  NetworkConfig config = config_of(NetworkKind::mesh);
  config.width = 0;
  EXPECT_THROW((void)make_network(config, 4), sim::UserError);
}

}  // namespace
}  // namespace marti::memory
