// The host: cuts the image into packets and gives them to the nodes.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <systemc>
#include <vector>

#include "processors/node/host.h"
#include "tests/validation/systemc/instant.h"

namespace marti::oracle {

/// Columns x0 .. x1 - 1 of rows y0 .. y1 - 1.
struct Rectangle {
  std::uint32_t x0 = 0;
  std::uint32_t y0 = 0;
  std::uint32_t x1 = 0;
  std::uint32_t y1 = 0;
};

/// All packets of an image in the order in which they are handed out.
[[nodiscard]] std::vector<Rectangle> cut_into_packets(std::uint32_t width, std::uint32_t height,
                                                      const processors::machine::PacketConfig& config);

class PacketUser {
 public:
  virtual ~PacketUser() = default;
  /// The node begins the packet now; std::nullopt: no packet is left.
  virtual void begin_packet(const std::optional<Rectangle>& packet) = 0;
};

class HostInterface : public virtual sc_core::sc_interface {
 public:
  /// `user` is node number `node` and free now.
  virtual void ask(std::uint32_t node, PacketUser& user) = 0;
};

class Host : public sc_core::sc_module, public HostInterface {
 public:
  Host(const sc_core::sc_module_name& name, Turns& turns, const processors::machine::HostConfig& config,
       std::vector<Rectangle> packets, std::uint32_t nodes);
  void ask(std::uint32_t node, PacketUser& user) override;
  [[nodiscard]] const processors::node::HostStatistics& statistics() const { return statistics_; }
  [[nodiscard]] std::size_t packets() const { return packets_.size(); }

 private:
  struct Request {
    PacketUser* user = nullptr;
    Rectangle packet;
  };
  void serve();

  Later later_;
  processors::machine::Assignment assignment_;
  Time latency_;
  Time occupancy_;
  std::vector<Rectangle> packets_;
  std::vector<std::deque<std::size_t>> share_;  // packets of each node; all in the first when dynamic
  std::deque<Request> waiting_;
  bool busy_ = false;
  processors::node::HostStatistics statistics_;
};

}  // namespace marti::oracle
