// Packets: the rectangles of neighbouring pixels that the host hands out.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace marti::processors::machine {

/// The order in which packets are handed out. `hilbert` keeps successive packets adjacent (Hilbert 1891);
/// `morton` interleaves the bits of column and row (Morton 1966).
enum class PacketOrder : std::uint8_t { scanline, morton, hilbert };
inline constexpr std::array<std::string_view, 3> packet_order_names = {"scanline", "morton", "hilbert"};

/// The largest number of packets in a frame.
inline constexpr std::uint64_t most_packets = std::uint64_t{1} << 30U;

struct PacketConfig {
  std::uint32_t width = 8;   ///< pixels
  std::uint32_t height = 8;  ///< pixels
  PacketOrder order = PacketOrder::scanline;
};

/// A packet's pixels: x from x0 to x1 - 1, y from y0 to y1 - 1. Packets at the right and lower edges are
/// smaller where the packet size does not divide the image.
struct Packet {
  std::uint32_t x0 = 0;
  std::uint32_t y0 = 0;
  std::uint32_t x1 = 0;
  std::uint32_t y1 = 0;
};

/// How many packets of this size an image has, whatever their order. 0 if a packet has no pixel.
[[nodiscard]] std::uint64_t packets_of_image(std::uint32_t width, std::uint32_t height,
                                             const PacketConfig& config);

/// All packets of a frame in handing-out order. Throws UserError for a packet size of zero or more than
/// most_packets packets.
class PacketList {
 public:
  PacketList(std::uint32_t image_width, std::uint32_t image_height, const PacketConfig& config);

  [[nodiscard]] std::uint64_t size() const { return count_; }
  [[nodiscard]] Packet operator[](std::uint64_t index) const;
  /// Only these of the packets, in this order.
  [[nodiscard]] PacketList only(std::span<const std::uint64_t> indices) const;

 private:
  std::uint32_t image_width_;
  std::uint32_t image_height_;
  PacketConfig config_;
  std::uint32_t columns_;
  std::uint64_t count_;
  std::vector<std::uint32_t> order_;  // packet number in scanline order; empty for scanline itself
};

}  // namespace marti::processors::machine
