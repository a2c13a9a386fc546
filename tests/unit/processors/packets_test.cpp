#include "processors/machine/packets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <vector>

#include "processors/node/host.h"
#include "processors/walk/node_order.h"
#include "sim/error.h"
#include "tests/support/random_machine.h"

namespace marti::processors {

using namespace machine;
using namespace node;
using namespace walk;

namespace {

TEST(Packets, CoverEveryPixelOnceInEveryOrder) {
  test::Random random(1);
  for (int round = 0; round < 200; ++round) {
    const auto width = static_cast<std::uint32_t>(test::pick(random, 1, 40));
    const auto height = static_cast<std::uint32_t>(test::pick(random, 1, 40));
    const PacketConfig config = {static_cast<std::uint32_t>(test::pick(random, 1, 50)),
                                 static_cast<std::uint32_t>(test::pick(random, 1, 50)),
                                 static_cast<PacketOrder>(test::pick(random, 0, 2))};
    const PacketList packets(width, height, config);
    std::vector<int> seen(std::size_t{width} * height);
    for (std::uint64_t i = 0; i < packets.size(); ++i) {
      const Packet packet = packets[i];
      ASSERT_LT(packet.x0, packet.x1);
      ASSERT_LT(packet.y0, packet.y1);
      for (std::uint32_t y = packet.y0; y < packet.y1; ++y) {
        for (std::uint32_t x = packet.x0; x < packet.x1; ++x) {
          ++seen.at(std::size_t{y} * width + x);
        }
      }
    }
    for (const int count : seen) {
      ASSERT_EQ(count, 1);
    }
  }
}

TEST(Packets, HilbertNeighboursTouch) {
  const PacketList packets(64, 64, {4, 4, PacketOrder::hilbert});
  for (std::uint64_t i = 1; i < packets.size(); ++i) {
    const Packet a = packets[i - 1];
    const Packet b = packets[i];
    EXPECT_EQ(std::abs(static_cast<int>(a.x0) - static_cast<int>(b.x0)) +
                  std::abs(static_cast<int>(a.y0) - static_cast<int>(b.y0)),
              4);
  }
}

// The order of an image is that of the curve through the square around it, less what lies outside.
TEST(Packets, AnImageHasTheOrderOfTheSquareAroundIt) {
  for (const PacketOrder order : {PacketOrder::hilbert, PacketOrder::morton}) {
    const PacketList square(32, 32, {1, 1, order});
    for (std::uint32_t width = 1; width <= 32; ++width) {
      for (const std::uint32_t height : {1U, 2U, 7U, 31U, 32U}) {
        if (std::bit_ceil(std::max(width, height)) != 32) {
          continue;
        }
        const PacketList packets(width, height, {1, 1, order});
        std::uint64_t at = 0;
        for (std::uint64_t i = 0; i < square.size(); ++i) {
          const Packet cell = square[i];
          if (cell.x0 < width && cell.y0 < height) {
            ASSERT_LT(at, packets.size());
            ASSERT_EQ(packets[at].x0, cell.x0);
            ASSERT_EQ(packets[at].y0, cell.y0);
            ++at;
          }
        }
        EXPECT_EQ(at, packets.size());
      }
    }
    // One row takes about as long as it has packets, not the square of that.
    EXPECT_EQ(PacketList(1U << 22U, 1, {1, 1, order}).size(), 1U << 22U);
  }
}

TEST(Packets, MortonInterleavesTheBits) {
  const PacketList packets(8, 8, {1, 1, PacketOrder::morton});
  EXPECT_EQ(packets[1].x0, 1U);
  EXPECT_EQ(packets[2].y0, 1U);
  EXPECT_EQ(packets[0b111001].x0, 0b101U);
  EXPECT_EQ(packets[0b111001].y0, 0b110U);
}

TEST(Packets, RefusesNothingAndTooMuch) {
  EXPECT_THROW(PacketList(8, 8, {0, 1, PacketOrder::scanline}), sim::UserError);
  EXPECT_EQ(packets_of_image(8, 8, {0, 1, PacketOrder::scanline}), 0U);
  EXPECT_EQ(packets_of_image(9, 8, {4, 100, PacketOrder::hilbert}), 3U);
  EXPECT_THROW(PacketList(1U << 20U, 1U << 20U, {1, 1, PacketOrder::scanline}), sim::UserError);
  EXPECT_EQ(PacketList(8, 8, {~0U, ~0U, PacketOrder::morton}).size(), 1U);
  EXPECT_EQ(PacketList(0, 0, {1, 1, PacketOrder::hilbert}).size(), 0U);
}

TEST(Host, GivesEveryPacketToExactlyOneNode) {
  for (const Assignment assignment : {Assignment::dynamic, Assignment::interleaved, Assignment::blocks}) {
    for (const std::uint32_t nodes : {1U, 3U, 16U, 100U}) {
      HostConfig config;
      config.assignment = assignment;
      Host host(config, 37, nodes);
      std::vector<int> given(37);
      bool progress = true;
      while (progress) {
        progress = false;
        for (std::uint32_t node = 0; node < nodes; ++node) {
          if (const auto grant = host.next(node, 0)) {
            ++given.at(grant->packet);
            progress = true;
          }
        }
      }
      EXPECT_EQ(given, std::vector<int>(37, 1)) << assignment_names[static_cast<std::size_t>(assignment)];
    }
  }
}

TEST(Host, ABusyHostServesRequestsOneAfterTheOther) {
  HostConfig config;
  config.clock = sim::Clock::from_period(10);
  config.latency_cycles = 7;
  config.occupancy_cycles = 3;
  Host host(config, 5, 2);
  EXPECT_EQ(host.next(0, 100)->start, 170);
  EXPECT_EQ(host.next(1, 110)->start, 130 + 70);
  EXPECT_EQ(host.next(0, 500)->start, 570);
  EXPECT_EQ(host.statistics().busy, 90);
}

// In every order each node with a record has one, siblings lie in a row, and children behind their parents.
TEST(NodeOrder, EveryOrderIsAPermutationThatKeepsChildrenTogether) {
  test::Random random(2);
  for (int k = 0; k < 40; ++k) {
    const accel::Topology topology = test::random_topology(random, 30, 10, 3);
    for (const bool leaf_records : {true, false}) {
      const auto most = static_cast<std::uint32_t>(test::pick(random, 1, 40));
      for (const std::vector<std::uint32_t>& rank : {accel::breadth_first_rank(topology, leaf_records),
                                                     accel::depth_first_rank(topology, leaf_records),
                                                     accel::treelets_of(topology, leaf_records, most).rank}) {
        std::vector<std::uint32_t> records;
        for (std::uint32_t node = 0; node < rank.size(); ++node) {
          ASSERT_EQ(rank[node] == no_record, !leaf_records && topology.nodes[node].leaf);
          if (rank[node] != no_record) {
            records.push_back(rank[node]);
          }
        }
        std::sort(records.begin(), records.end());
        for (std::uint32_t record = 0; record < records.size(); ++record) {
          ASSERT_EQ(records[record], record);
        }
        for (std::uint32_t branch = 0; branch < rank.size(); ++branch) {
          const accel::TopologyNode& node = topology.nodes[branch];
          std::uint32_t next = no_record;
          for (std::uint32_t i = 0; !node.leaf && i < node.count; ++i) {
            if (rank[node.first + i] != no_record) {
              ASSERT_TRUE(next == no_record || rank[node.first + i] == next);
              ASSERT_GT(rank[node.first + i], rank[branch]);
              next = rank[node.first + i] + 1;
            }
          }
        }
      }
    }
  }
}

TEST(NodeOrder, OneLargeTreeletIsBreadthFirstAndOneOfEachBlockDepthFirst) {
  test::Random random(3);
  for (int k = 0; k < 20; ++k) {
    const accel::Topology topology = test::random_topology(random, 30, 10, 3);
    EXPECT_EQ(accel::treelets_of(topology, false, 1U << 20U).rank,
              accel::breadth_first_rank(topology, false));
    EXPECT_EQ(accel::treelets_of(topology, true, 1).rank, accel::depth_first_rank(topology, true));
  }
}

// A full binary tree of 15 nodes, in treelets of three records. The root and its children are the first.
// Where leaves have no records, the two children of each of these are one. Where they have, each pair of
// siblings is.
TEST(NodeOrder, TreeletsHoldWhatFits) {
  accel::Topology topology;
  for (std::uint32_t node = 0; node < 15; ++node) {
    topology.nodes.push_back({node < 7 ? 2 * node + 1 : node - 7, node < 7 ? 2U : 1U,
                              static_cast<std::uint8_t>(std::bit_width(node + 1)), node >= 7});
  }
  using Numbers = std::vector<std::uint32_t>;
  const accel::Treelets branches = accel::treelets_of(topology, false, 3);
  EXPECT_EQ(Numbers(branches.rank.begin(), branches.rank.begin() + 7), (Numbers{0, 1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(branches.begin, (Numbers{0, 3, 5, 7}));
  EXPECT_EQ(branches.of_node, (Numbers{0, 0, 0, 1, 1, 2, 2, 1, 1, 1, 1, 2, 2, 2, 2}));
  const accel::Treelets counted = accel::treelets_of(topology, true, 3);
  EXPECT_EQ(counted.rank, (Numbers{0, 1, 2, 3, 4, 9, 10, 5, 6, 7, 8, 11, 12, 13, 14}));
  EXPECT_EQ(counted.begin, (Numbers{0, 3, 5, 7, 9, 11, 13, 15}));
  EXPECT_EQ(counted.of_node, (Numbers{0, 0, 0, 1, 1, 4, 4, 2, 2, 3, 3, 5, 5, 6, 6}));
}

}  // namespace
}  // namespace marti::processors
