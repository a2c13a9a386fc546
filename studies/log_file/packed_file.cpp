#include "studies/log_file/packed_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/input_files.h"
#include "sim/mix.h"
#include "sim/shown.h"

namespace marti::studies::log_file {

namespace {

// Numbers are written as they are in memory.
static_assert(std::endian::native == std::endian::little);

constexpr std::string_view magic("marti work log\n\x1a", 16);
// Tables of words, once their bytes are sorted, become hardly smaller with more effort.
constexpr int effort = 1;
constexpr std::uint32_t last_mark = 0x80000000U;
// zlib packs no more than this into a byte.
constexpr std::uint64_t most_unpacked = 1032;

struct Header {
  std::uint32_t unpacked = 0;
  std::uint32_t packed = 0;
  std::uint32_t number = 0;
  std::uint32_t checksum = 0;
  std::uint32_t own_checksum = 0;
};
constexpr std::size_t header_bytes = sizeof(Header);
static_assert(header_bytes == 20);
constexpr std::size_t beginning_bytes = magic.size() + sizeof format_version;

std::uint32_t checksum_of(const void* bytes, std::size_t count) {
  return static_cast<std::uint32_t>(::crc32_z(0, static_cast<const unsigned char*>(bytes), count));
}
std::uint32_t own_checksum_of(const Header& header) {
  return checksum_of(&header, header_bytes - sizeof header.own_checksum);
}

// Puts the bytes of equal position in 32-bit words together; `back`: the reverse.
std::vector<unsigned char> sorted_bytes(const std::vector<unsigned char>& bytes, bool back) {
  std::vector<unsigned char> sorted(bytes.size());
  std::size_t to = 0;
  for (std::size_t position = 0; position < sizeof(std::uint32_t); ++position) {
    for (std::size_t from = position; from < bytes.size(); from += sizeof(std::uint32_t)) {
      sorted[back ? from : to] = bytes[back ? to : from];
      ++to;
    }
  }
  return sorted;
}

// A scene or a result whose name was given by mistake is not lost.
std::filesystem::path without_another(std::filesystem::path file) {
  std::array<char, magic.size()> beginning{};
  std::error_code error;
  if (std::filesystem::is_regular_file(file, error) && std::filesystem::file_size(file, error) > 0) {
    std::ifstream(file, std::ios::binary).read(beginning.data(), beginning.size());
    if (std::string_view(beginning.data(), beginning.size()) != magic) {
      throw sim::UserError(sim::shown(file.string()) +
                           ": exists and is no work log, so it is not replaced by one; choose another name, "
                           "or remove it");
    }
  }
  return file;
}

}  // namespace

PackedWriter::PackedWriter(std::filesystem::path file)
    : file_(without_another(std::move(file))), pending_(file_), output_(pending_.open()) {
  part_.reserve(part_bytes);
  write(magic);
  std::array<char, sizeof format_version> version{};
  std::memcpy(version.data(), &format_version, version.size());
  write({version.data(), version.size()});
}

void PackedWriter::write(std::string_view bytes) {
  if (const int error = sim::write_all(output_.get(), bytes); error != 0) {
    throw sim::UserError(file_.string() + ": cannot be written: " + std::generic_category().message(error));
  }
}

void PackedWriter::bytes(const void* from, std::size_t count) {
  const auto* next = static_cast<const unsigned char*>(from);
  while (count > 0) {
    if (part_.size() == part_bytes) {
      end_part(false);
    }
    const std::size_t some = std::min(count, part_bytes - part_.size());
    part_.insert(part_.end(), next, next + some);
    next += some;
    count -= some;
  }
}

void PackedWriter::end_part(bool last) {
  const std::vector<unsigned char> sorted = sorted_bytes(part_, false);
  std::vector<unsigned char> packed(::compressBound(static_cast<uLong>(sorted.size())));
  auto size = static_cast<uLongf>(packed.size());
  sim::ensure(
      ::compress2(packed.data(), &size, sorted.data(), static_cast<uLong>(sorted.size()), effort) == Z_OK,
      "zlib does not pack a part of a log");
  Header header{static_cast<std::uint32_t>(part_.size()), static_cast<std::uint32_t>(size),
                number_ | (last ? last_mark : 0U), checksum_of(packed.data(), size), 0};
  header.own_checksum = own_checksum_of(header);
  std::array<char, header_bytes> bytes{};
  std::memcpy(bytes.data(), &header, header_bytes);
  write({bytes.data(), bytes.size()});
  write({reinterpret_cast<const char*>(packed.data()), size});
  part_.clear();
  if (++number_ == last_mark) {
    throw sim::UserError(file_.string() + ": cannot be written: the log has 2 PiB or more");
  }
}

void PackedWriter::commit() {
  sim::refuse_input(file_);
  end_part(true);
  if (output_.close() != 0) {
    throw sim::UserError(file_.string() + ": cannot be written: " + std::generic_category().message(errno));
  }
  pending_.commit();
}

PackedReader::PackedReader(std::filesystem::path file)
    : file_(std::move(file)),
      // O_NONBLOCK: opening a pipe without a writer must not wait for ever; it is refused below.
      input_(::open(file_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
  struct stat status {};
  if (input_.get() < 0 || ::fstat(input_.get(), &status) != 0) {
    fail("cannot be read: " + std::generic_category().message(errno));
  }
  if (!S_ISREG(status.st_mode)) {
    fail("cannot be read: not a regular file");
  }
  const auto size = static_cast<std::uint64_t>(status.st_size);
  std::array<char, beginning_bytes> beginning{};
  read_at(0, beginning.data(), static_cast<std::size_t>(std::min<std::uint64_t>(size, beginning_bytes)));
  if (std::string_view(beginning.data(), magic.size()) != magic) {
    fail("is no work log as `marti run --save-log` writes it");
  }
  std::uint32_t version = 0;
  std::memcpy(&version, beginning.data() + magic.size(), sizeof version);
  if (size >= beginning_bytes && version != format_version) {
    fail(
        fmt::format("is a work log of format {}, and this program reads format {}; write it again with this "
                    "program's `marti run --save-log`, or time it with the program that wrote it",
                    version, format_version));
  }
  list_parts(size);
}

void PackedReader::fail(const std::string& what) const {
  throw sim::UserError(sim::shown(file_.string()) + ": " + what);
}

void PackedReader::read_at(std::uint64_t at, void* to, std::size_t count) const {
  auto* next = static_cast<unsigned char*>(to);
  while (count > 0) {
    const ssize_t some = ::pread(input_.get(), next, count, static_cast<off_t>(at));
    if (some < 0 && errno == EINTR) {
      continue;
    }
    if (some < 0) {
      fail("cannot be read: " + std::generic_category().message(errno));
    }
    if (some == 0) {
      fail("has become shorter while it was read");
    }
    next += some;
    at += static_cast<std::uint64_t>(some);
    count -= static_cast<std::size_t>(some);
  }
}

void PackedReader::list_parts(std::uint64_t size) {
  const auto cut_off = [&] { fail("has been cut off; copy it again, or write it again"); };
  std::uint64_t at = beginning_bytes;
  for (bool last = false; !last;) {
    if (size < at || size - at < header_bytes) {
      cut_off();
    }
    Header header;
    read_at(at, &header, header_bytes);
    last = (header.number & last_mark) != 0;
    if (header.own_checksum != own_checksum_of(header) || header.unpacked > part_bytes ||
        header.unpacked > most_unpacked * header.packed || (header.number & ~last_mark) != parts_.size()) {
      fail(fmt::format("is damaged: the header of its part {}; copy it again, or write it again",
                       parts_.size() + 1));
    }
    at += header_bytes;
    if (size - at < header.packed) {
      cut_off();
    }
    parts_.push_back({at, header.unpacked, header.packed, header.checksum});
    left_ += header.unpacked;
    for (const std::uint32_t word : {header.unpacked, header.packed, header.number, header.checksum}) {
      id_ = sim::mix(id_ ^ word);
    }
    at += header.packed;
  }
  if (at != size) {
    fail("has something behind its end; copy it again, or write it again");
  }
}

void PackedReader::next_part() {
  if (next_ == parts_.size()) {
    fail("ends too early");
  }
  const Part& part = parts_[next_++];
  std::vector<unsigned char> packed(part.packed);
  read_at(part.at, packed.data(), packed.size());
  std::vector<unsigned char> sorted(part.unpacked);
  auto size = static_cast<uLongf>(sorted.size());
  // zlib wants a place to write to even for nothing.
  unsigned char nothing = 0;
  if (checksum_of(packed.data(), packed.size()) != part.checksum ||
      ::uncompress(sorted.empty() ? &nothing : sorted.data(), &size, packed.data(),
                   static_cast<uLong>(packed.size())) != Z_OK ||
      size != part.unpacked) {
    fail(
        fmt::format("is damaged: its part {} of {}; copy it again, or write it again", next_, parts_.size()));
  }
  part_ = sorted_bytes(sorted, true);
  used_ = 0;
}

void PackedReader::bytes(void* to, std::size_t count) {
  auto* next = static_cast<unsigned char*>(to);
  while (count > 0) {
    if (used_ == part_.size()) {
      next_part();
    }
    const std::size_t some = std::min(count, part_.size() - used_);
    std::copy_n(part_.begin() + static_cast<std::ptrdiff_t>(used_), some, next);
    used_ += some;
    left_ -= some;
    next += some;
    count -= some;
  }
}

void PackedReader::make_room(std::uint64_t elements, std::size_t packed_bytes, std::size_t host_bytes) {
  if (elements > left_ / packed_bytes) {
    fail("ends too early for what it says it has");
  }
  memory_.take(elements * host_bytes, "the work log in " + sim::shown(file_.string()) + " takes",
               "raise it, or write the log of a smaller image");
}

void PackedReader::end() {
  if (left_ != 0) {
    fail("has more than a work log in it");
  }
}

}  // namespace marti::studies::log_file
