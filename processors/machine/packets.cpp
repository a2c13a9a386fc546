#include "processors/machine/packets.h"

#include <algorithm>
#include <bit>
#include <string>

#include "sim/key_error.h"

namespace marti::processors::machine {

namespace {

std::uint32_t compact_bits(std::uint64_t bits) {
  std::uint32_t result = 0;
  for (unsigned i = 0; i < 32; ++i) {
    result |= static_cast<std::uint32_t>((bits >> (2 * i)) & 1U) << i;
  }
  return result;
}

struct Cell {
  std::uint32_t x = 0;
  std::uint32_t y = 0;
};

Cell morton_cell(std::uint64_t index) { return {compact_bits(index), compact_bits(index >> 1U)}; }

// Position `index` of the Hilbert curve through a square of `side` cells (a power of two), by the usual
// quadrant-wise rotation from the lowest level up.
Cell hilbert_cell(std::uint64_t index, std::uint32_t side) {
  Cell cell;
  for (std::uint32_t s = 1; s < side; s *= 2) {
    const auto rx = static_cast<std::uint32_t>((index / 2) & 1U);
    const auto ry = static_cast<std::uint32_t>((index ^ rx) & 1U);
    if (ry == 0) {
      if (rx == 1) {
        cell = {s - 1 - cell.x, s - 1 - cell.y};
      }
      std::swap(cell.x, cell.y);
    }
    cell.x += s * rx;
    cell.y += s * ry;
    index /= 4;
  }
  return cell;
}

// How many packets lie side by side.
std::uint32_t parts_of(std::uint32_t length, std::uint32_t packet_length) {
  return length / packet_length + (length % packet_length != 0 ? 1 : 0);
}

}  // namespace

std::uint64_t packets_of_image(std::uint32_t width, std::uint32_t height, const PacketConfig& config) {
  return config.width == 0 || config.height == 0
             ? 0
             : std::uint64_t{parts_of(width, config.width)} * parts_of(height, config.height);
}

PacketList::PacketList(std::uint32_t image_width, std::uint32_t image_height, const PacketConfig& config)
    : image_width_(image_width), image_height_(image_height), config_(config), columns_(0), count_(0) {
  if (config.width == 0 || config.height == 0) {
    throw sim::KeyError("packets.width", "a packet must be at least 1 x 1 pixels");
  }
  config_.width = std::min(config.width, std::max(image_width, 1U));
  config_.height = std::min(config.height, std::max(image_height, 1U));
  columns_ = parts_of(image_width, config_.width);
  const std::uint32_t rows = parts_of(image_height, config_.height);
  count_ = std::uint64_t{columns_} * rows;
  if (count_ > most_packets) {
    throw sim::KeyError("packets.width",
                        "the image has " + std::to_string(count_) + " packets; at most 2^30 are possible");
  }
  if (config.order == PacketOrder::scanline || count_ == 0) {
    return;
  }
  const std::uint32_t side = std::bit_ceil(std::max(columns_, rows));
  order_.reserve(count_);
  // Both curves go through a block of 2^k x 2^k cells in 4^k steps that begin at a multiple of 4^k, so blocks
  // beyond the image are passed over whole.
  const auto is_beyond = [&](const Cell& cell, std::uint32_t block) {
    return (cell.x & ~(block - 1)) >= columns_ || (cell.y & ~(block - 1)) >= rows;
  };
  for (std::uint64_t index = 0; index < std::uint64_t{side} * side;) {
    const Cell cell = config.order == PacketOrder::morton ? morton_cell(index) : hilbert_cell(index, side);
    std::uint32_t block = 1;
    if (!is_beyond(cell, block)) {
      order_.push_back(cell.y * columns_ + cell.x);
    } else {
      while (index % (std::uint64_t{block} * block * 4) == 0 && is_beyond(cell, 2 * block)) {
        block *= 2;
      }
    }
    index += std::uint64_t{block} * block;
  }
}

PacketList PacketList::only(std::span<const std::uint64_t> indices) const {
  PacketList part = *this;
  part.count_ = indices.size();
  part.order_.clear();
  for (const std::uint64_t index : indices) {
    part.order_.push_back(order_.empty() ? static_cast<std::uint32_t>(index) : order_[index]);
  }
  return part;
}

Packet PacketList::operator[](std::uint64_t index) const {
  const std::uint64_t number = order_.empty() ? index : order_[index];
  const auto x0 = static_cast<std::uint32_t>(number % columns_) * config_.width;
  const auto y0 = static_cast<std::uint32_t>(number / columns_) * config_.height;
  return {x0, y0, std::min(image_width_, x0 + config_.width), std::min(image_height_, y0 + config_.height)};
}

}  // namespace marti::processors::machine
