// Bytes in a file of compressed parts, written one after the other and read in the same order.
//
// The file begins with sixteen characters and a version. Each part has a header: bytes unpacked, bytes
// packed, its number (with the highest bit set in the last part), a checksum of the packed bytes and one of
// the header; 32-bit words, the lowest byte first. The packed bytes, which follow, are a zlib stream of the
// part's bytes, those of equal position in 32-bit words together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sim/descriptor.h"
#include "sim/memory_budget.h"
#include "sim/pending_file.h"

namespace marti::studies::log_file {

/// Version of what is in the file. Change it with every change of a description of fields.
inline constexpr std::uint32_t format_version = 2;

/// Unpacked bytes of a part, at most.
inline constexpr std::size_t part_bytes = std::size_t{1} << 20U;

/// The file appears under its name when it is complete (sim/pending_file.h). All functions throw UserError,
/// naming the file, when it cannot be written, for example because the disk is full.
class PackedWriter {
 public:
  static constexpr bool reads = false;

  explicit PackedWriter(std::filesystem::path file);

  void bytes(const void* from, std::size_t count);
  void commit();

 private:
  void write(std::string_view bytes);
  void end_part(bool last);

  std::filesystem::path file_;
  sim::PendingFile pending_;
  sim::Descriptor output_;
  std::vector<unsigned char> part_;
  std::uint32_t number_ = 0;  // of the part
};

/// The constructor checks the whole file but for its packed bytes, each of which is checked when it is read.
/// All functions throw UserError that names the file and says what is wrong with it.
class PackedReader {
 public:
  static constexpr bool reads = true;

  explicit PackedReader(std::filesystem::path file);

  /// Differs for files of different content.
  [[nodiscard]] std::uint64_t id() const { return id_; }
  void bytes(void* to, std::size_t count);
  /// Throws unless that many elements can follow, of which each takes at least `packed_bytes`; and a KeyError
  /// if they, each of `host_bytes`, together with all before, take more memory than the budget has.
  void make_room(std::uint64_t elements, std::size_t packed_bytes, std::size_t host_bytes);
  /// Of what make_room() takes from; without it there is no limit.
  void limit(const sim::MemoryBudget& memory) { memory_ = memory; }
  /// Throws if something follows.
  void end();
  [[noreturn]] void fail(const std::string& what) const;

 private:
  struct Part {
    std::uint64_t at = 0;
    std::uint32_t unpacked = 0;
    std::uint32_t packed = 0;
    std::uint32_t checksum = 0;
  };
  void read_at(std::uint64_t at, void* to, std::size_t count) const;
  void list_parts(std::uint64_t size);
  void next_part();

  std::filesystem::path file_;
  sim::Descriptor input_;
  std::vector<Part> parts_;
  std::size_t next_ = 0;    // of parts_
  std::uint64_t left_ = 0;  // unpacked bytes that follow
  std::uint64_t id_ = 0;
  std::vector<unsigned char> part_;
  std::size_t used_ = 0;  // of part_
  sim::MemoryBudget memory_;
};

}  // namespace marti::studies::log_file
