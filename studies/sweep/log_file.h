// Work logs as bytes: for files, and for other processes of the same program.
//
// The magic "martilog", a byte order mark and the number of the format; then blocks, each a head of three
// 64-bit numbers (compressed bytes, raw bytes, items) and a Zstandard frame with its content's checksum. The
// first block is the header: program, key, frame row, the log's shape. The others hold the log, part by part
// (log_blocks.h). Everything in the host's byte order; a file of another order is refused.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "processors/program/work_log.h"
#include "studies/sweep/sweep_row.h"

namespace marti::studies {

/// A functional run as a sweep keeps it: no image.
struct FrameLog {
  std::shared_ptr<const processors::WorkLog> log;
  FrameRow row;
};

/// Bytes of memory that a log takes, with what its vectors have in reserve.
[[nodiscard]] std::uint64_t memory_of(const processors::WorkLog& log);

/// Where a log's bytes come from.
class LogSource {
 public:
  LogSource() = default;
  LogSource(const LogSource&) = delete;
  LogSource& operator=(const LogSource&) = delete;
  virtual ~LogSource() = default;
  /// What messages call it.
  [[nodiscard]] virtual std::string name() const = 0;
  /// Bytes not yet read.
  [[nodiscard]] virtual std::uint64_t left() const = 0;
  /// The next bytes, at most left(). Throws UserError.
  [[nodiscard]] virtual std::string read(std::uint64_t bytes) = 0;
};

/// Throws UserError when the file cannot be opened.
[[nodiscard]] std::unique_ptr<LogSource> log_file_source(const std::filesystem::path& file);
/// The bytes must outlive the source.
[[nodiscard]] std::unique_ptr<LogSource> log_memory_source(std::string_view bytes, std::string name);

/// The log as bytes, handed to `sink` in order and piece by piece; blocks are compressed on all host cores,
/// and few of them are in memory at a time. The same log gives the same bytes. `key` and `program` (its
/// version) are what a reader must ask for.
void write_log(const std::function<void(std::string_view)>& sink, const FrameLog& log, const std::string& key,
               std::string_view program);
/// To a file that must not exist. It is locked (flock) until the call ends; `complete` is called before that,
/// when all is written. Throws UserError when that cannot be done; what there is of the file is left to the
/// caller (sim::PendingFile).
void write_log_file(const std::filesystem::path& file, const FrameLog& log, const std::string& key,
                    std::string_view program, const std::function<void()>& complete = {});

/// Reads a log to its end. Throws UserError when the bytes are not a whole log of that key and version, are
/// damaged, or would take more than `max_bytes` of memory: whatever the bytes, no more memory is taken than
/// the source has bytes for by Zstandard's rules, than `max_bytes`, and some mebibytes for each host core.
[[nodiscard]] FrameLog read_log(LogSource& source, const std::string& key, std::string_view program,
                                std::uint64_t max_bytes);

/// The memory that read_log would take, by the header alone. Throws UserError like it.
[[nodiscard]] std::uint64_t stated_memory(LogSource& source, const std::string& key,
                                          std::string_view program);

}  // namespace marti::studies
