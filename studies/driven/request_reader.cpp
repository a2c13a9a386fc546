#include "studies/driven/request_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <utility>
#include <vector>

#include "sim/error.h"
#include "sim/input_files.h"
#include "sim/parse_number.h"
#include "sim/shown.h"
#include "sim/units.h"

namespace marti::studies::driven {

namespace {

using processors::walk::Request;

constexpr std::size_t longest_line = 4096;
constexpr std::uint64_t most_bytes = 1U << 20U;            // of a request
constexpr std::uint64_t latest = std::uint64_t{1} << 60U;  // ps

std::vector<std::string_view> parts_of(std::string_view line, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(
        separator == ' ' ? line.find_first_of(" \t", begin) : line.find(separator, begin), line.size());
    if (separator != ' ' || end > begin) {
      parts.push_back(line.substr(begin, end - begin));
    }
    begin = end + 1;
  }
  return parts;
}

std::optional<std::uint64_t> hexadecimal(std::string_view text) {
  std::uint64_t number = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number, 16);
  return error == std::errc{} && stop == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

// "0x40" or "64".
std::optional<std::uint64_t> address_of(std::string_view text) {
  return text.starts_with("0x") || text.starts_with("0X") ? hexadecimal(text.substr(2))
                                                          : sim::parse_number<std::uint64_t>(text);
}

std::optional<bool> is_write(std::string_view word) {
  constexpr std::array reads = {"read", "READ", "LD"};
  constexpr std::array writes = {"write", "WRITE", "ST"};
  if (std::ranges::find(reads, word) != reads.end()) {
    return false;
  }
  return std::ranges::find(writes, word) != writes.end() ? std::optional(true) : std::nullopt;
}

std::optional<memory::RecordKind> kind_named(std::string_view name) {
  const auto found = std::ranges::find(memory::record_kind_names, name);
  return found == memory::record_kind_names.end()
             ? std::nullopt
             : std::optional(static_cast<memory::RecordKind>(found - memory::record_kind_names.begin()));
}

}  // namespace

RequestReader::RequestReader(const std::filesystem::path& file, const TraceDefaults& defaults)
    : file_(file), defaults_(defaults), stream_(file, std::ios::binary) {
  if (!stream_ || std::filesystem::is_directory(file)) {
    throw sim::UserError(file.string() + ": there is no trace that can be read");
  }
  sim::note_input(file);
  if (stream_.peek() == 'g') {  // gem5's magic number; no line of the other forms begins so
    form_ = Form::gem5;
    read_gem5_header();
    return;
  }
  do {
    if (!next_line()) {
      throw sim::UserError(file.string() + ": is empty");
    }
    if (line_ == 1 && text_.starts_with("\xef\xbb\xbf")) {
      text_.erase(0, 3);
    }
  } while (parts_of(text_, ' ').empty());
  const std::string_view first = parts_of(text_, ' ').front();
  if (first == "LD" || first == "ST") {
    form_ = Form::load_store;
  } else if (first.starts_with("0x") || first.starts_with("0X")) {
    form_ = Form::dramsim3;
  } else {
    read_header();
    return;
  }
  pending_ = true;
}

std::string_view RequestReader::form() const {
  constexpr std::array<std::string_view, 4> names = {"CSV", "DRAMsim3's", "Ramulator 2's LoadStoreTrace",
                                                     "gem5's packet trace"};
  return names[static_cast<std::size_t>(form_)];
}

void RequestReader::fail(const std::string& reason) const {
  throw sim::UserError(fmt::format("{}:{}: {}", file_.string(), line_, reason));
}

// Not std::getline(), which has no limit.
bool RequestReader::next_line() {
  if (pending_) {
    pending_ = false;
    return true;
  }
  text_.clear();
  ++line_;
  for (int c = stream_.get(); c != std::char_traits<char>::eof(); c = stream_.get()) {
    if (c == '\n') {
      if (text_.ends_with('\r')) {
        text_.pop_back();
      }
      return true;
    }
    if (text_.size() == longest_line) {
      fail("a line has more than 4,096 bytes");
    }
    text_ += static_cast<char>(c);
  }
  if (stream_.bad()) {
    fail("cannot be read further");
  }
  return !text_.empty();
}

// The magic number, and the header's time base.
void RequestReader::read_gem5_header() {
  std::string magic(4, '\0');
  stream_.read(magic.data(), static_cast<std::streamsize>(magic.size()));
  if (magic != "gem5") {
    fail("is no trace of requests");
  }
  std::uint64_t left = most_bytes;
  left = packet_number(left);
  while (left > 0) {
    const std::uint64_t tag = packet_number(left);
    const std::uint64_t value = packet_number(left);
    if (tag % 8 == 2) {  // a text, of which this is the length
      for (std::uint64_t k = 0; k < value; ++k, --left) {
        if (left == 0 || stream_.get() == std::char_traits<char>::eof()) {
          fail("the trace ends within its header");
        }
      }
    } else if (tag / 8 == 3) {
      ticks_a_second_ = value;
    }
  }
  constexpr std::uint64_t most = sim::ticks_per_second;
  if (ticks_a_second_ == 0 || most % ticks_a_second_ != 0) {
    fail("its times are no whole numbers of ps");
  }
}

void RequestReader::read_header() {
  const std::vector<std::string_view> names = parts_of(text_, ',');
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (const auto& [name, column] :
         {std::pair("time_ps", &time_), std::pair("node", &node_), std::pair("access", &access_),
          std::pair("address", &address_), std::pair("bytes", &bytes_), std::pair("kind", &kind_)}) {
      if (names[i] == name) {
        *column = static_cast<int>(i);
      }
    }
  }
  if (time_ < 0 || access_ < 0 || address_ < 0) {
    fail(
        "is no trace of requests: expected is CSV with the columns time_ps, access and address, lines "
        "\"0x40 READ 12\" or \"LD 0x40\", or gem5's packet trace; it begins with \"" +
        sim::shown(text_) + "\"");
  }
}

void RequestReader::read_csv(processors::replay::DrivenRequest& request) const {
  const std::vector<std::string_view> cells = parts_of(text_, ',');
  const auto number = [&](int column, std::uint64_t otherwise, std::string_view what) {
    if (column < 0) {
      return otherwise;
    }
    const std::optional<std::uint64_t> found =
        static_cast<std::size_t>(column) < cells.size()
            ? sim::parse_number<std::uint64_t>(cells[static_cast<std::size_t>(column)])
            : std::nullopt;
    if (!found) {
      fail(fmt::format("{} is no number of 0 or more: \"{}\"", what, sim::shown(text_)));
    }
    return *found;
  };
  const std::uint64_t time = number(time_, 0, "time_ps");
  const std::uint64_t node = number(node_, 0, "node");
  const std::uint64_t bytes = number(bytes_, defaults_.bytes, "bytes");
  const std::optional<bool> write = static_cast<std::size_t>(access_) < cells.size()
                                        ? is_write(cells[static_cast<std::size_t>(access_)])
                                        : std::nullopt;
  if (!write) {
    fail("access is neither read nor write: \"" + sim::shown(text_) + "\"");
  }
  std::optional<memory::RecordKind> kind = memory::RecordKind::node;
  if (kind_ >= 0 && !*write) {
    kind = static_cast<std::size_t>(kind_) < cells.size() ? kind_named(cells[static_cast<std::size_t>(kind_)])
                                                          : std::nullopt;
    if (!kind) {
      fail("kind is no kind of record: \"" + sim::shown(text_) + "\"");
    }
  }
  if (time > latest || bytes > most_bytes) {
    fail("the time is beyond 2^60 ps, or the request has more than 1 MiB");
  }
  request = {
      {static_cast<sim::Ticks>(time), static_cast<std::uint32_t>(std::min<std::uint64_t>(node, 0xffffffffU)),
       number(address_, 0, "address"), static_cast<std::uint32_t>(bytes), *write},
      *kind};
}

void RequestReader::read_words(Request& request) const {
  const std::vector<std::string_view> words = parts_of(text_, ' ');
  const bool has_time = form_ == Form::dramsim3;
  const std::size_t verb = has_time ? 1 : 0;
  const std::optional<bool> write =
      words.size() == (has_time ? 3U : 2U) ? is_write(words[verb]) : std::nullopt;
  const std::optional<std::uint64_t> address = write ? address_of(words[1 - verb]) : std::nullopt;
  const std::optional<std::uint64_t> cycle =
      has_time && address ? sim::parse_number<std::uint64_t>(words[2]) : std::optional<std::uint64_t>(0);
  if (!write || !address || !cycle) {
    fail(fmt::format("is not like \"{}\": \"{}\"", has_time ? "0x40 READ 12" : "LD 0x40", sim::shown(text_)));
  }
  if (*cycle > latest / static_cast<std::uint64_t>(defaults_.cycle)) {
    fail("the time is beyond 2^60 ps");
  }
  request = {static_cast<sim::Ticks>(*cycle) * defaults_.cycle, 0, *address, defaults_.bytes, *write};
}

// A number of Protocol Buffers, seven bits a byte; takes its bytes from `left`.
std::uint64_t RequestReader::packet_number(std::uint64_t& left) {
  std::uint64_t number = 0;
  for (unsigned shift = 0; shift < 64; shift += 7) {
    const int c = stream_.get();
    if (c == std::char_traits<char>::eof() || left == 0) {
      fail("the trace ends within a packet");
    }
    --left;
    number |= static_cast<std::uint64_t>(c & 0x7f) << shift;
    if ((c & 0x80) == 0) {
      return number;
    }
  }
  fail("a number has more than 64 bits");
}

bool RequestReader::next_packet(Request& request) {
  if (stream_.peek() == std::char_traits<char>::eof()) {
    return false;
  }
  ++line_;
  std::uint64_t left = most_bytes;
  left = packet_number(left);
  std::array<std::uint64_t, 8> fields{};
  while (left > 0) {
    const std::uint64_t tag = packet_number(left);
    if (tag % 8 != 0) {
      fail("a packet has a field that is no number; compressed traces must be unpacked first");
    }
    const std::uint64_t value = packet_number(left);
    if (tag / 8 < fields.size()) {
      fields[tag / 8] = value;
    }
  }
  constexpr std::uint64_t read_request = 1;
  constexpr std::uint64_t write_request = 4;
  if (fields[2] != read_request && fields[2] != write_request) {
    fail(fmt::format("command {} is neither gem5's ReadReq nor its WriteReq", fields[2]));
  }
  const std::uint64_t tick = sim::ticks_per_second / ticks_a_second_;
  if (fields[1] > latest / tick || fields[4] > most_bytes) {
    fail("the time is beyond 2^60 ps, or the request has more than 1 MiB");
  }
  request = {static_cast<sim::Ticks>(fields[1] * tick), 0, fields[3], static_cast<std::uint32_t>(fields[4]),
             fields[2] == write_request};
  return true;
}

void RequestReader::check(Request& request) {
  if (request.bytes == 0) {
    fail("a request has 0 bytes");
  }
  if (request.address >= defaults_.addresses || request.bytes > defaults_.addresses - request.address) {
    fail(fmt::format("address {} is beyond the {} of the memory", request.address,
                     sim::print_size(static_cast<std::int64_t>(defaults_.addresses))));
  }
  if (request.node >= defaults_.nodes) {
    fail(fmt::format("node {} is beyond machine.nodes = {}", request.node, defaults_.nodes));
  }
  if (request.time < last_) {
    fail("the time is less than that of the request before");
  }
  last_ = request.time;
}

bool RequestReader::next(processors::replay::DrivenRequest& request) {
  if (form_ == Form::gem5) {
    if (!next_packet(request)) {
      return false;
    }
  } else {
    do {
      if (!next_line()) {
        return false;
      }
    } while (parts_of(text_, ' ').empty());
    form_ == Form::csv ? read_csv(request) : read_words(request);
  }
  check(request);
  return true;
}

}  // namespace marti::studies::driven
