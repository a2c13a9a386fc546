// Rows as bytes. All numbers are 64 bits, the lowest byte first; a text is its length and its bytes.
#include <algorithm>

#include "sim/error.h"
#include "studies/sweep/plan/sweep_row.h"

namespace marti::studies {

namespace {

// The first number of a row: which kind it is.
constexpr std::uint64_t sweep_mark = 0x776f725f70657773;
constexpr std::uint64_t frame_mark = 0x776f725f656d6172;

class Writer {
 public:
  void number(std::uint64_t value) {
    for (unsigned shift = 0; shift < 64; shift += 8) {
      bytes_ += static_cast<char>((value >> shift) & 0xffU);
    }
  }
  void number(std::int64_t value) { number(static_cast<std::uint64_t>(value)); }
  void text(std::string_view value) {
    number(std::uint64_t{value.size()});
    bytes_ += value;
  }
  void counters(const std::vector<std::optional<std::int64_t>>& values) {
    number(std::uint64_t{values.size()});
    for (const std::optional<std::int64_t>& value : values) {
      bytes_ += value ? '\1' : '\0';
      if (value) {
        number(*value);
      }
    }
  }
  [[nodiscard]] std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}

  std::uint64_t number() {
    const std::string_view eight = take(8);
    std::uint64_t value = 0;
    for (unsigned i = 0; i < 8; ++i) {
      value |= static_cast<std::uint64_t>(static_cast<unsigned char>(eight[i])) << (8 * i);
    }
    return value;
  }
  std::int64_t integer() { return static_cast<std::int64_t>(number()); }
  // The number of items that follow, each of at least `least` bytes. Throws if they cannot fit in the bytes
  // left.
  std::size_t count(std::size_t least) {
    const std::uint64_t value = number();
    sim::ensure(value <= bytes_.size() / least, "a row's bytes end too early");
    return static_cast<std::size_t>(value);
  }
  std::string text() { return std::string(take(count(1))); }
  std::vector<std::optional<std::int64_t>> counters(std::size_t columns) {
    sim::ensure(count(1) == columns, "a row's bytes have another number of counters");
    std::vector<std::optional<std::int64_t>> values(columns);
    for (std::optional<std::int64_t>& value : values) {
      const char there = take(1)[0];
      sim::ensure(there == '\0' || there == '\1', "a row's bytes are garbled");
      if (there == '\1') {
        value = integer();
      }
    }
    return values;
  }
  void mark(std::uint64_t expected) { sim::ensure(number() == expected, "bytes that are no row"); }
  void end() const { sim::ensure(bytes_.empty(), "a row's bytes go on after its end"); }

 private:
  std::string_view take(std::size_t bytes) {
    sim::ensure(bytes <= bytes_.size(), "a row's bytes end too early");
    const std::string_view taken = bytes_.substr(0, bytes);
    bytes_.remove_prefix(bytes);
    return taken;
  }

  std::string_view bytes_;
};

SweepHistogram read_histogram(Reader& reader) {
  SweepHistogram histogram;
  histogram.what = reader.text();
  const auto names = sweep_histogram_names();
  sim::ensure(std::find(names.begin(), names.end(), histogram.what) != names.end(),
              "a row's bytes name an unknown histogram");
  histogram.buckets.resize(reader.count(24));
  std::int64_t last = -1;
  for (SweepHistogram::Bucket& bucket : histogram.buckets) {
    bucket.lowest = reader.integer();
    bucket.highest = reader.integer();
    bucket.count = reader.integer();
    sim::ensure(bucket.lowest > last && bucket.highest >= bucket.lowest && bucket.count > 0,
                "a row's bytes hold an impossible histogram");
    last = bucket.highest;
  }
  return histogram;
}

}  // namespace

std::string encode(const SweepRow& row) {
  Writer writer;
  writer.number(sweep_mark);
  writer.counters(row.counters);
  writer.number(std::uint64_t{row.histograms.size()});
  for (const SweepHistogram& histogram : row.histograms) {
    writer.text(histogram.what);
    writer.number(std::uint64_t{histogram.buckets.size()});
    for (const SweepHistogram::Bucket& bucket : histogram.buckets) {
      writer.number(bucket.lowest);
      writer.number(bucket.highest);
      writer.number(bucket.count);
    }
  }
  return writer.take();
}

SweepRow decode_sweep_row(std::string_view bytes) {
  Reader reader(bytes);
  reader.mark(sweep_mark);
  SweepRow row;
  row.counters = reader.counters(sweep_columns().size());
  const std::size_t histograms = reader.count(16);
  for (std::size_t i = 0; i < histograms; ++i) {
    row.histograms.push_back(read_histogram(reader));
  }
  reader.end();
  return row;
}

std::string encode(const FrameRow& row) {
  Writer writer;
  writer.number(frame_mark);
  writer.counters(row.counters);
  for (const std::string& text : {row.scene, row.scene_hash, row.image_hash, row.hit_hash}) {
    writer.text(text);
  }
  writer.number(std::uint64_t{row.notes.size()});
  for (const std::string& note : row.notes) {
    writer.text(note);
  }
  return writer.take();
}

FrameRow decode_frame_row(std::string_view bytes) {
  Reader reader(bytes);
  reader.mark(frame_mark);
  FrameRow row;
  row.counters = reader.counters(frame_columns().size());
  for (std::string* text : {&row.scene, &row.scene_hash, &row.image_hash, &row.hit_hash}) {
    *text = reader.text();
  }
  const std::size_t notes = reader.count(8);
  for (std::size_t i = 0; i < notes; ++i) {
    row.notes.push_back(reader.text());
  }
  reader.end();
  return row;
}

}  // namespace marti::studies
