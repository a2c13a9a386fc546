// Traces of requests, read as they are needed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "processors/replay/driven_memory.h"

namespace marti::studies::driven {

/// What the forms leave out.
struct TraceDefaults {
  std::uint32_t bytes = 64;                           ///< of a request
  sim::Ticks cycle = 1000;                            ///< of DRAMsim3's times
  std::uint32_t nodes = 1;                            ///< a request of a node beyond is refused
  std::uint64_t addresses = std::uint64_t{1} << 48U;  ///< of the memory; one beyond is refused
};

/// CSV as `marti trace --format csv` writes it (columns time_ps, access, address; node, bytes and kind may be
/// missing, others are ignored), DRAMsim3's lines "0x40 READ 12", Ramulator 2's "LD 0x40" and "ST 64", or
/// gem5's packet traces, uncompressed. The first bytes tell which. Words may be
/// parted by any blanks; a byte order mark and empty lines are skipped.
/// Requests of forms without nodes are of node 0.
class RequestReader {
 public:
  /// Throws UserError when the file cannot be read or has another form.
  RequestReader(const std::filesystem::path& file, const TraceDefaults& defaults);

  /// Whether requests have times.
  [[nodiscard]] bool timed() const { return form_ != Form::load_store; }
  /// For people.
  [[nodiscard]] std::string_view form() const;
  /// Whether requests say what kind of record they are of.
  [[nodiscard]] bool has_kinds() const { return kind_ >= 0; }
  /// Reads the next request; false at the end of the trace. Throws the UserError "file:line: reason" for a
  /// line or packet that is no request, for times that decrease, and for values out of range.
  [[nodiscard]] bool next(processors::replay::DrivenRequest& request);

 private:
  enum class Form : std::uint8_t { csv, dramsim3, load_store, gem5 };

  [[noreturn]] void fail(const std::string& reason) const;
  [[nodiscard]] bool next_line();
  void read_header();
  void read_gem5_header();
  [[nodiscard]] bool next_packet(processors::walk::Request& request);
  void read_csv(processors::replay::DrivenRequest& request) const;
  void read_words(processors::walk::Request& request) const;
  [[nodiscard]] std::uint64_t packet_number(std::uint64_t& left);
  void check(processors::walk::Request& request);

  std::filesystem::path file_;
  TraceDefaults defaults_;
  std::ifstream stream_;
  Form form_ = Form::csv;
  std::uint64_t line_ = 0;  // of gem5's traces, packets
  std::string text_;
  bool pending_ = false;              // text_ is a line that was not taken yet
  std::uint64_t ticks_a_second_ = 0;  // of gem5's times
  // Of CSV, the columns of these; -1: none.
  int time_ = -1;
  int node_ = -1;
  int access_ = -1;
  int address_ = -1;
  int bytes_ = -1;
  int kind_ = -1;
  sim::Ticks last_ = 0;
};

}  // namespace marti::studies::driven
