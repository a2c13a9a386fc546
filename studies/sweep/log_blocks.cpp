#include "studies/sweep/log_blocks.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace marti::studies {

namespace {

using processors::LogRow;
using processors::WorkLog;

constexpr std::uint64_t block_items = 1U << 16U;  // of the parts that are not rows
constexpr std::uint64_t block_words = 1U << 18U;  // of rows: the block ends with the row that reaches it

// Limits that every log keeps; they also keep the sums below from overflowing.
constexpr std::uint32_t most_pixels = 1U << 20U;  // a side
constexpr std::uint64_t most_items = std::uint64_t{1} << 32U;
constexpr std::uint64_t most_words = std::uint64_t{1} << 52U;
constexpr std::uint64_t most_row_words = std::numeric_limits<std::uint32_t>::max();

std::uint64_t items(const LogShape& shape, LogPart part) {
  return shape.items[static_cast<std::size_t>(part)];
}

// Writes or reads one member of some structures, as an array of its own: like stands beside like.
template <class Number, class Item, class Get>
void write_member(ByteWriter& out, std::span<const Item> of, Get get) {
  std::vector<Number> values(of.size());
  std::transform(of.begin(), of.end(), values.begin(), get);
  out.numbers(std::span<const Number>(values));
}
template <class Number, class Item, class Set>
void read_member(ByteReader& in, std::span<Item> of, Set set) {
  std::vector<Number> values(of.size());
  in.numbers(std::span<Number>(values));
  for (std::size_t i = 0; i < of.size(); ++i) {
    set(of[i], values[i]);
  }
}

template <class Vector>
auto part_of(Vector& whole, const LogBlock& block) {
  return std::span(whole).subspan(block.first, block.count);
}

void write_rows(ByteWriter& out, std::span<const LogRow> rows, std::uint32_t width) {
  std::vector<std::uint32_t> lengths(width);
  for (const LogRow& row : rows) {
    for (std::size_t x = 0; x < width; ++x) {
      lengths[x] = row.begin[x + 1] - row.begin[x];
    }
    out.numbers(std::span<const std::uint32_t>(lengths));
    out.numbers(std::span<const std::uint32_t>(row.words));
  }
}

void read_rows(ByteReader& in, std::span<LogRow> rows, std::uint32_t width) {
  for (LogRow& row : rows) {
    row.begin.resize(std::size_t{width} + 1);
    in.numbers(std::span(row.begin).subspan(1));
    std::uint64_t end = 0;
    for (std::size_t x = 1; x <= width; ++x) {
      end += row.begin[x];
      if (end > std::min<std::uint64_t>(in.left() / sizeof(std::uint32_t), most_row_words)) {
        throw DamagedBytes("a row is longer than its block");
      }
      row.begin[x] = static_cast<std::uint32_t>(end);
    }
    row.words.resize(end);
    in.numbers(std::span(row.words));
  }
}

}  // namespace

std::uint64_t LogShape::bytes() const {
  return items[0] * sizeof(accel::TopologyNode) + items[1] * sizeof(std::uint32_t) +
         items[2] * sizeof(accel::SplitWork) + items[3] * sizeof(accel::PrimitiveKind) +
         items[4] * sizeof(std::uint64_t) +
         items[5] * (sizeof(LogRow) + (std::uint64_t{scalars.width} + 1) * sizeof(std::uint32_t)) +
         words * sizeof(std::uint32_t);
}

LogShape shape_of(const WorkLog& log) {
  LogShape shape;
  shape.scalars.traversal = log.traversal;
  shape.scalars.mailboxes = log.mailboxes;
  shape.scalars.width = log.width;
  shape.scalars.height = log.height;
  shape.scalars.samples = log.samples;
  shape.scalars.primitives = log.primitives;
  shape.scalars.materials = log.materials;
  shape.scalars.voxels = log.voxels;
  shape.scalars.lights = log.lights;
  shape.items = {log.topology.nodes.size(), log.topology.entries.size(), log.topology.work.size(),
                 log.quadrics.size(),       log.texture_begin.size(),    log.rows.size()};
  shape.words = std::accumulate(log.rows.begin(), log.rows.end(), std::uint64_t{0},
                                [](std::uint64_t sum, const LogRow& row) { return sum + row.words.size(); });
  return shape;
}

void write_shape(ByteWriter& out, const LogShape& shape) {
  const WorkLog& log = shape.scalars;
  out.number(static_cast<std::uint8_t>(log.traversal));
  out.number(static_cast<std::uint8_t>(log.mailboxes ? 1 : 0));
  for (const std::uint32_t number :
       {log.width, log.height, log.samples, log.primitives, log.materials, log.voxels, log.lights}) {
    out.number(number);
  }
  out.numbers(std::span<const std::uint64_t>(shape.items));
  out.number(shape.words);
}

LogShape read_shape(ByteReader& in) {
  LogShape shape;
  WorkLog& log = shape.scalars;
  const auto traversal = in.number<std::uint8_t>();
  const auto mailboxes = in.number<std::uint8_t>();
  if (traversal >= accel::traversals || mailboxes > 1) {
    throw DamagedBytes("it names a way through the tree that there is not");
  }
  log.traversal = static_cast<accel::Traversal>(traversal);
  log.mailboxes = mailboxes == 1;
  for (std::uint32_t* const number :
       {&log.width, &log.height, &log.samples, &log.primitives, &log.materials, &log.voxels, &log.lights}) {
    *number = in.number<std::uint32_t>();
  }
  in.numbers(std::span<std::uint64_t>(shape.items));
  shape.words = in.number<std::uint64_t>();
  if (log.width > most_pixels || log.height > most_pixels || shape.words > most_words ||
      std::any_of(shape.items.begin(), shape.items.end(), [](std::uint64_t n) { return n > most_items; }) ||
      items(shape, LogPart::rows) != log.height ||
      (items(shape, LogPart::work) != 0 && items(shape, LogPart::work) != items(shape, LogPart::nodes))) {
    throw DamagedBytes("its parts do not fit together");
  }
  return shape;
}

std::vector<LogBlock> blocks_of(const WorkLog& log) {
  std::vector<LogBlock> blocks;
  const LogShape shape = shape_of(log);
  for (std::size_t part = 0; part + 1 < log_parts; ++part) {
    for (std::uint64_t first = 0; first < shape.items[part]; first += block_items) {
      blocks.push_back({static_cast<LogPart>(part), first, std::min(block_items, shape.items[part] - first)});
    }
  }
  for (std::uint64_t first = 0; first < log.rows.size();) {
    LogBlock block{LogPart::rows, first, 0};
    for (std::uint64_t words = 0; words < block_words && first < log.rows.size(); ++first, ++block.count) {
      words += log.rows[first].words.size() + log.width;
    }
    blocks.push_back(block);
  }
  return blocks;
}

std::string write_block(const WorkLog& log, const LogBlock& block) {
  ByteWriter out;
  switch (block.part) {
    case LogPart::nodes: {
      const auto nodes = part_of(log.topology.nodes, block);
      write_member<std::uint32_t>(out, nodes, [](const accel::TopologyNode& node) { return node.first; });
      write_member<std::uint32_t>(out, nodes, [](const accel::TopologyNode& node) { return node.count; });
      write_member<std::uint8_t>(out, nodes, [](const accel::TopologyNode& node) { return node.level; });
      write_member<std::uint8_t>(out, nodes, [](const accel::TopologyNode& node) { return node.leaf; });
      break;
    }
    case LogPart::entries:
      out.numbers(part_of(log.topology.entries, block));
      break;
    case LogPart::work: {
      const auto work = part_of(log.topology.work, block);
      write_member<std::uint32_t>(out, work, [](const accel::SplitWork& split) { return split.listed; });
      write_member<std::uint32_t>(out, work, [](const accel::SplitWork& split) { return split.overlaps; });
      break;
    }
    case LogPart::quadrics:
      write_member<std::uint8_t>(out, part_of(log.quadrics, block),
                                 [](accel::PrimitiveKind kind) { return static_cast<std::uint8_t>(kind); });
      break;
    case LogPart::textures:
      out.numbers(part_of(log.texture_begin, block));
      break;
    case LogPart::rows:
      write_rows(out, part_of(log.rows, block), log.width);
      break;
  }
  return out.bytes();
}

WorkLog empty_log(const LogShape& shape) {
  WorkLog log = shape.scalars;
  log.topology.nodes.resize(items(shape, LogPart::nodes));
  log.topology.entries.resize(items(shape, LogPart::entries));
  log.topology.work.resize(items(shape, LogPart::work));
  log.quadrics.resize(items(shape, LogPart::quadrics));
  log.texture_begin.resize(items(shape, LogPart::textures));
  log.rows.resize(items(shape, LogPart::rows));
  return log;
}

std::uint64_t block_bytes(const LogShape& shape, const LogBlock& block) {
  switch (block.part) {
    case LogPart::nodes:
      return block.count * (2 * sizeof(std::uint32_t) + 2);
    case LogPart::entries:
      return block.count * sizeof(std::uint32_t);
    case LogPart::work:
    case LogPart::textures:
      return block.count * sizeof(std::uint64_t);
    case LogPart::quadrics:
      return block.count;
    case LogPart::rows:
      break;
  }
  return block.count * shape.scalars.width * sizeof(std::uint32_t);
}

void read_block(WorkLog& log, const LogBlock& block, std::string_view bytes) {
  ByteReader in(bytes);
  switch (block.part) {
    case LogPart::nodes: {
      const auto nodes = part_of(log.topology.nodes, block);
      using Node = accel::TopologyNode;
      read_member<std::uint32_t>(in, nodes, [](Node& node, std::uint32_t first) { node.first = first; });
      read_member<std::uint32_t>(in, nodes, [](Node& node, std::uint32_t count) { node.count = count; });
      read_member<std::uint8_t>(in, nodes, [](Node& node, std::uint8_t level) { node.level = level; });
      read_member<std::uint8_t>(in, nodes, [](Node& node, std::uint8_t leaf) { node.leaf = leaf != 0; });
      break;
    }
    case LogPart::entries:
      in.numbers(part_of(log.topology.entries, block));
      break;
    case LogPart::work: {
      const auto work = part_of(log.topology.work, block);
      using Work = accel::SplitWork;
      read_member<std::uint32_t>(in, work, [](Work& split, std::uint32_t listed) { split.listed = listed; });
      read_member<std::uint32_t>(in, work, [](Work& split, std::uint32_t run) { split.overlaps = run; });
      break;
    }
    case LogPart::quadrics:
      read_member<std::uint8_t>(in, part_of(log.quadrics, block),
                                [](accel::PrimitiveKind& kind, std::uint8_t number) {
                                  kind = static_cast<accel::PrimitiveKind>(number);
                                });
      break;
    case LogPart::textures:
      in.numbers(part_of(log.texture_begin, block));
      break;
    case LogPart::rows:
      read_rows(in, part_of(log.rows, block), log.width);
      break;
  }
  in.end();
}

}  // namespace marti::studies
