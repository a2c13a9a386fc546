// A work log cut into blocks of about a mebibyte, in a fixed order, so that it can be written and read piece
// by piece.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "processors/program/work_log.h"
#include "studies/sweep/byte_parts.h"

namespace marti::studies {

/// The parts of a log, in the order of their blocks.
enum class LogPart : std::uint8_t { nodes, entries, work, quadrics, textures, rows };
inline constexpr std::size_t log_parts = 6;

/// Everything of a log but the content of its vectors.
struct LogShape {
  processors::WorkLog scalars;                   ///< its vectors are empty
  std::array<std::uint64_t, log_parts> items{};  ///< in each part
  std::uint64_t words = 0;                       ///< of all rows

  /// Bytes that the log's vectors take, without what they have in reserve.
  [[nodiscard]] std::uint64_t bytes() const;
};

[[nodiscard]] LogShape shape_of(const processors::WorkLog& log);
void write_shape(ByteWriter& out, const LogShape& shape);
/// Throws DamagedBytes for a shape that no log has.
[[nodiscard]] LogShape read_shape(ByteReader& in);

/// Some of a part's items, one after the other.
struct LogBlock {
  LogPart part = LogPart::nodes;
  std::uint64_t first = 0;
  std::uint64_t count = 0;
};

/// Parts without items have no block.
[[nodiscard]] std::vector<LogBlock> blocks_of(const processors::WorkLog& log);
[[nodiscard]] std::string write_block(const processors::WorkLog& log, const LogBlock& block);

/// A log of that shape, its vectors of full length but its rows without words.
[[nodiscard]] processors::WorkLog empty_log(const LogShape& shape);
/// Bytes of a block; of rows, without their words.
[[nodiscard]] std::uint64_t block_bytes(const LogShape& shape, const LogBlock& block);
/// Fills in a block's items, which must be within the log. Blocks without a common item may be read at the
/// same time. Throws DamagedBytes.
void read_block(processors::WorkLog& log, const LogBlock& block, std::string_view bytes);

}  // namespace marti::studies
