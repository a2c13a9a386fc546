// What every node did when, for Perfetto (https://ui.perfetto.dev) and other readers of Chrome's trace event
// format (Trace Event Format, Google, 2016: JSON, complete events "X", metadata "M").
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "processors/path/path_recorder.h"
#include "processors/walk/observer.h"
#include "studies/run/record/text_stream.h"

namespace marti::studies::run {

struct TimelineOptions {
  sim::Ticks from = 0;                                     ///< earlier slices are left out
  sim::Ticks to = std::numeric_limits<sim::Ticks>::max();  ///< slices from here on are left out
  std::int64_t most_events = 1'000'000;  ///< slices of nodes written at most; of a path as many again
};

/// Writes while it watches. One track a node (tid is the node's number plus 1), one process a cluster (pid is
/// its number plus 1). A slice is a node's time in one state for one pixel without a break; its name is that
/// of the NodeState. Slices of a node follow each other, those of different nodes come in any order. Times
/// are in microseconds with six digits, which is exact. A critical path is one more process, behind the
/// clusters', with one track.
class Timeline final : public processors::walk::Observer {
 public:
  Timeline(const std::filesystem::path& file, const TimelineOptions& options);

  /// Shows the path that `path` records, too; its end() must have been called before this object's, after
  /// which it is not needed any more. Null: no path.
  void mark(const processors::path::PathRecorder* path) { path_ = path; }

  void begin(const processors::walk::ReplayInput& input) override;
  void spent(std::uint32_t node, processors::walk::NodeState state, sim::Ticks from, sim::Ticks to,
             processors::walk::PixelPlace pixel) override;
  void began_packet(std::uint32_t node, std::uint64_t packet, sim::Ticks start) override;
  void resumed_packet(std::uint32_t node, std::uint64_t packet) override;
  /// Completes and closes the file, still under its temporary name.
  void end(sim::Ticks time) override;
  [[nodiscard]] const std::filesystem::path& temporary() const { return stream_.temporary(); }
  void commit() { stream_.commit(); }

  [[nodiscard]] std::int64_t events() const { return events_ + path_events_; }
  /// The begin of the earliest slice of a node left out because there were too many; std::nullopt if there
  /// was room for all.
  [[nodiscard]] std::optional<sim::Ticks> cut_at() const { return cut_at_; }
  /// The begin of the path's earliest slice, if there was no room for those before it.
  [[nodiscard]] std::optional<sim::Ticks> path_cut_at() const { return path_cut_at_; }

 private:
  static constexpr std::uint64_t no_packet = ~std::uint64_t{0};
  // A node's last slice, which may still grow.
  struct Slice {
    sim::Ticks from = 0;
    sim::Ticks to = 0;
    std::uint64_t packet = no_packet;
    processors::walk::PixelPlace pixel;
    processors::walk::NodeState state = processors::walk::NodeState::idle;
  };
  struct Track {
    Slice slice;
    std::uint64_t packet = no_packet;
    bool named = false;
  };

  void put(std::uint32_t node);
  void put_path();
  void put_path_slice(const processors::path::PathPiece& piece);
  // What is missing, for other programs to show; empty if nothing is.
  [[nodiscard]] std::string note() const;
  void name(std::uint32_t node);
  // Names a process or a track.
  void name_part(std::string_view what, std::size_t process, std::size_t track, const std::string& arguments);

  TimelineOptions options_;
  TextStream stream_;
  std::vector<Track> tracks_;
  std::vector<bool> cluster_named_;
  std::uint32_t nodes_a_cluster_ = 1;
  std::int64_t events_ = 0;       // of nodes
  std::int64_t path_events_ = 0;  // of the path
  std::optional<sim::Ticks> cut_at_;
  std::optional<sim::Ticks> path_cut_at_;
  sim::Ticks path_from_ = 0;  // begin of the path's slice written last
  bool first_ = true;
  const processors::path::PathRecorder* path_ = nullptr;
};

}  // namespace marti::studies::run
