#include "studies/sweep/log_file.h"

#include <sys/file.h>
#include <sys/stat.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdio>
#include <limits>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "sim/error.h"
#include "sim/units.h"
#include "studies/sweep/log_blocks.h"
#include "studies/sweep/zstd_block.h"

namespace marti::studies {

namespace {

constexpr std::string_view magic = "martilog";
constexpr std::uint32_t byte_order_mark = 0x01020304;
constexpr std::uint32_t format = 2;
constexpr std::uint64_t most_header_bytes = 1U << 24U;
// Zstandard's best: four bytes stand for a block of 128 KiB.
constexpr std::uint64_t most_ratio = 1U << 15U;

struct Head {
  std::uint64_t compressed = 0;
  std::uint64_t raw = 0;
  std::uint64_t items = 0;
};
constexpr std::uint64_t head_bytes = 3 * sizeof(std::uint64_t);

struct Header {
  FrameRow row;
  LogShape shape;
};

std::string with_head(const std::string& raw, std::uint64_t items) {
  const std::string compressed = compress_block(raw);
  ByteWriter out;
  out.reserve(head_bytes + compressed.size());
  out.number(std::uint64_t{compressed.size()});
  out.number(std::uint64_t{raw.size()});
  out.number(items);
  return out.bytes() + compressed;
}

/// Blocks that are worked on at a time.
std::size_t blocks_at_once() {
  return 2 * static_cast<std::size_t>(std::max(1, tbb::this_task_arena::max_concurrency()));
}

std::string read_bytes(LogSource& source, std::uint64_t bytes) {
  if (bytes > source.left()) {
    throw DamagedBytes("it ends too early");
  }
  return source.read(bytes);
}

Head read_head(LogSource& source) {
  const std::string bytes = read_bytes(source, head_bytes);
  ByteReader in(bytes);
  Head head;
  for (std::uint64_t* const number : {&head.compressed, &head.raw, &head.items}) {
    *number = in.number<std::uint64_t>();
  }
  if (head.compressed > source.left()) {
    throw DamagedBytes("it ends too early");
  }
  if (head.raw / most_ratio > head.compressed) {
    throw DamagedBytes("a block is not of the size that it should be");
  }
  return head;
}

Header read_header(LogSource& source, const std::string& key, std::string_view program) {
  const std::string start = read_bytes(source, magic.size() + 2 * sizeof(std::uint32_t));
  if (!start.starts_with(magic)) {
    throw DamagedBytes("it does not begin as one");
  }
  ByteReader numbers(std::string_view(start).substr(magic.size()));
  if (numbers.number<std::uint32_t>() != byte_order_mark) {
    throw DamagedBytes("it was written by a machine of another byte order");
  }
  if (const auto number = numbers.number<std::uint32_t>(); number != format) {
    throw DamagedBytes("it has format " + std::to_string(number) + ", and this program's is " +
                       std::to_string(format));
  }
  const Head head = read_head(source);
  if (head.raw > most_header_bytes) {
    throw DamagedBytes("its header is too long");
  }
  const std::string raw = decompress_block(read_bytes(source, head.compressed), head.raw);
  ByteReader in(raw);
  if (const std::string other = in.text(); other != program) {
    throw DamagedBytes("it was written by " + other + ", and this is " + std::string(program));
  }
  if (in.text() != key) {
    throw DamagedBytes("it is the log of another frame");
  }
  Header header;
  header.row = decode_frame_row(in.text());
  header.shape = read_shape(in);
  in.end();
  return header;
}

/// Finds the blocks in a source; nothing is read that does not follow from the header.
class BlockFinder {
 public:
  BlockFinder(LogSource& source, const LogShape& shape)
      : source_(source), shape_(shape), words_(shape.words) {}

  struct Found {
    LogBlock block;
    std::uint64_t raw = 0;
    std::string compressed;
  };

  /// Whether there is a next one.
  bool find(Found& found) {
    while (part_ < log_parts && at_ == shape_.items[part_]) {
      ++part_;
      at_ = 0;
    }
    if (part_ == log_parts) {
      if (words_ != 0 || source_.left() != 0) {
        throw DamagedBytes("its parts do not fit together");
      }
      return false;
    }
    const Head head = read_head(source_);
    found.block = {static_cast<LogPart>(part_), at_, head.items};
    if (head.items == 0 || head.items > shape_.items[part_] - at_) {
      throw DamagedBytes("its parts do not fit together");
    }
    const std::uint64_t without_words = block_bytes(shape_, found.block);
    const std::uint64_t words =
        head.raw < without_words ? 0 : (head.raw - without_words) / sizeof(std::uint32_t);
    if (head.raw != without_words + words * sizeof(std::uint32_t) || words > words_ ||
        (words != 0 && found.block.part != LogPart::rows)) {
      throw DamagedBytes("its parts do not fit together");
    }
    words_ -= words;
    at_ += head.items;
    found.raw = head.raw;
    found.compressed = read_bytes(source_, head.compressed);
    return true;
  }

 private:
  LogSource& source_;
  const LogShape& shape_;
  std::uint64_t words_;
  std::size_t part_ = 0;
  std::uint64_t at_ = 0;
};

std::shared_ptr<const processors::WorkLog> read_blocks(LogSource& source, const LogShape& shape) {
  auto log = std::make_shared<processors::WorkLog>(empty_log(shape));
  BlockFinder finder(source, shape);
  // Isolated: a thread that waits for others here must not begin something that waits for this log.
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_pipeline(blocks_at_once(),
                           tbb::make_filter<void, BlockFinder::Found>(tbb::filter_mode::serial_in_order,
                                                                      [&](tbb::flow_control& flow) {
                                                                        BlockFinder::Found found;
                                                                        if (!finder.find(found)) {
                                                                          flow.stop();
                                                                        }
                                                                        return found;
                                                                      }) &
                               tbb::make_filter<BlockFinder::Found, void>(
                                   tbb::filter_mode::parallel, [&](const BlockFinder::Found& found) {
                                     read_block(*log, found.block,
                                                decompress_block(found.compressed, found.raw));
                                   }));
    processors::validate(*log);
  });
  return log;
}

// What is wrong with the bytes becomes a message that names them.
template <class Call>
auto refusing(const LogSource& source, Call&& call) {
  const auto refuse = [&](const char* what) {
    return sim::UserError(source.name() + ": is not a whole work log of this program: " + what);
  };
  try {
    return call();
  } catch (const DamagedBytes& damage) {
    throw refuse(damage.what());
  } catch (const sim::InternalError& broken) {
    throw refuse(broken.what());
  }
}

template <class Number>
std::uint64_t reserved(const std::vector<Number>& of) {
  return of.capacity() * sizeof(Number);
}

[[noreturn]] void fail(const std::filesystem::path& file, const char* what, int error) {
  throw sim::UserError(file.string() + ": " + what + ": " + std::generic_category().message(error));
}

struct CloseFile {
  void operator()(std::FILE* file) const { static_cast<void>(std::fclose(file)); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

// The lock tells whoever finds the file half written that its writer lives. Somebody may find it before it is
// locked, and remove it.
File new_locked_file(const std::filesystem::path& path) {
  while (true) {
    File file(std::fopen(path.c_str(), "wbxe"));
    if (!file) {
      fail(path, "cannot be written", errno);
    }
    while (::flock(::fileno(file.get()), LOCK_EX) != 0 && errno == EINTR) {
    }
    struct stat status {};
    if (::fstat(::fileno(file.get()), &status) != 0 || status.st_nlink != 0) {
      return file;
    }
  }
}

class FileSource : public LogSource {
 public:
  explicit FileSource(std::filesystem::path path) : path_(std::move(path)) {
    std::error_code error;
    // Asked first: opening a pipe that nobody writes to would wait for ever.
    if (std::filesystem::exists(path_, error) && !std::filesystem::is_regular_file(path_, error)) {
      throw sim::UserError(path_.string() + ": cannot be read: not a regular file");
    }
    file_.reset(std::fopen(path_.c_str(), "rbe"));
    if (!file_) {
      fail(path_, "cannot be read", errno);
    }
    left_ = std::filesystem::file_size(path_, error);
    if (error) {
      fail(path_, "cannot be read", error.value());
    }
  }
  [[nodiscard]] std::string name() const override { return path_.string(); }
  [[nodiscard]] std::uint64_t left() const override { return left_; }
  [[nodiscard]] std::string read(std::uint64_t bytes) override {
    std::string content(bytes, '\0');
    if (std::fread(content.data(), 1, bytes, file_.get()) != bytes) {
      fail(path_, "cannot be read", std::ferror(file_.get()) != 0 ? errno : EIO);
    }
    left_ -= bytes;
    return content;
  }

 private:
  std::filesystem::path path_;
  File file_;
  std::uint64_t left_ = 0;
};

class MemorySource : public LogSource {
 public:
  MemorySource(std::string_view bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}
  [[nodiscard]] std::string name() const override { return name_; }
  [[nodiscard]] std::uint64_t left() const override { return bytes_.size(); }
  [[nodiscard]] std::string read(std::uint64_t bytes) override {
    std::string content(bytes_.substr(0, bytes));
    bytes_.remove_prefix(bytes);
    return content;
  }

 private:
  std::string_view bytes_;
  std::string name_;
};

}  // namespace

std::uint64_t memory_of(const processors::WorkLog& log) {
  std::uint64_t bytes = reserved(log.topology.nodes) + reserved(log.topology.entries) +
                        reserved(log.topology.work) + reserved(log.quadrics) + reserved(log.texture_begin) +
                        reserved(log.rows);
  for (const processors::LogRow& row : log.rows) {
    bytes += reserved(row.words) + reserved(row.begin);
  }
  return bytes;
}

std::unique_ptr<LogSource> log_file_source(const std::filesystem::path& file) {
  return std::make_unique<FileSource>(file);
}

std::unique_ptr<LogSource> log_memory_source(std::string_view bytes, std::string name) {
  return std::make_unique<MemorySource>(bytes, std::move(name));
}

void write_log(const std::function<void(std::string_view)>& sink, const FrameLog& log, const std::string& key,
               std::string_view program) {
  ByteWriter start;
  for (const char letter : magic) {
    start.number(letter);
  }
  start.number(byte_order_mark);
  start.number(format);
  sink(start.bytes());
  ByteWriter header;
  header.text(program);
  header.text(key);
  header.text(encode(log.row));
  write_shape(header, shape_of(*log.log));
  sim::ensure(header.bytes().size() <= most_header_bytes, "log file: a frame with too long notes");
  sink(with_head(header.bytes(), 1));

  const std::vector<LogBlock> blocks = blocks_of(*log.log);
  auto next = blocks.begin();
  tbb::this_task_arena::isolate([&] {  // as in read_blocks
    tbb::parallel_pipeline(
        blocks_at_once(),
        tbb::make_filter<void, LogBlock>(tbb::filter_mode::serial_in_order,
                                         [&](tbb::flow_control& flow) {
                                           if (next == blocks.end()) {
                                             flow.stop();
                                             return LogBlock{};
                                           }
                                           return *next++;
                                         }) &
            tbb::make_filter<LogBlock, std::string>(
                tbb::filter_mode::parallel,
                [&](const LogBlock& block) { return with_head(write_block(*log.log, block), block.count); }) &
            tbb::make_filter<std::string, void>(tbb::filter_mode::serial_in_order,
                                                [&](const std::string& bytes) { sink(bytes); }));
  });
}

void write_log_file(const std::filesystem::path& file, const FrameLog& log, const std::string& key,
                    std::string_view program, const std::function<void()>& complete) {
  const File out = new_locked_file(file);
  write_log(
      [&](std::string_view bytes) {
        if (std::fwrite(bytes.data(), 1, bytes.size(), out.get()) != bytes.size()) {
          fail(file, "cannot be written", errno);
        }
      },
      log, key, program);
  // Closing may be what fails (over a network); closing a second descriptor leaves the lock.
  if (std::fflush(out.get()) != 0 || ::close(::dup(::fileno(out.get()))) != 0) {
    fail(file, "cannot be written", errno);
  }
  if (complete) {
    complete();
  }
}

FrameLog read_log(LogSource& source, const std::string& key, std::string_view program,
                  std::uint64_t max_bytes) {
  return refusing(source, [&] {
    Header header = read_header(source, key, program);
    if (const std::uint64_t bytes = header.shape.bytes(); bytes > max_bytes) {
      throw DamagedBytes("it would take " + sim::print_size(static_cast<std::int64_t>(bytes)) +
                         ", more than " +
                         sim::print_size(static_cast<std::int64_t>(
                             std::min<std::uint64_t>(max_bytes, std::numeric_limits<std::int64_t>::max()))));
    }
    // Memory is taken before the blocks are read, so no more than they could fill.
    if (header.shape.bytes() / most_ratio > source.left()) {
      throw DamagedBytes("it ends too early");
    }
    return FrameLog{read_blocks(source, header.shape), std::move(header.row)};
  });
}

std::uint64_t stated_memory(LogSource& source, const std::string& key, std::string_view program) {
  return refusing(source, [&] { return read_header(source, key, program).shape.bytes(); });
}

}  // namespace marti::studies
