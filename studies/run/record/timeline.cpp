#include "studies/run/record/timeline.h"

#include <fmt/format.h>

#include <algorithm>

namespace marti::studies::run {

using processors::walk::NodeState;
using processors::walk::PixelPlace;

namespace {

constexpr sim::Ticks ticks_per_microsecond = sim::ticks_per_second / 1'000'000;

std::string microseconds(sim::Ticks ticks) {
  return fmt::format("{}.{:06}", ticks / ticks_per_microsecond, ticks % ticks_per_microsecond);
}

}  // namespace

Timeline::Timeline(const std::filesystem::path& file, const TimelineOptions& options)
    : options_(options), stream_(file) {
  stream_.write("{\"displayTimeUnit\":\"ns\",\"traceEvents\":[");
}

void Timeline::begin(const processors::walk::ReplayInput& input) {
  tracks_.resize(input.config.all_nodes());
  cluster_named_.resize(input.config.clusters);
  nodes_a_cluster_ = input.config.nodes;
}

void Timeline::spent(std::uint32_t node, NodeState state, sim::Ticks from, sim::Ticks to, PixelPlace pixel) {
  from = std::max(from, options_.from);
  to = std::min(to, options_.to);
  if (from >= to) {
    return;
  }
  Slice& slice = tracks_[node].slice;
  if (slice.state == state && slice.to == from && slice.pixel == pixel) {
    slice.to = to;
    return;
  }
  put(node);
  slice = {from, to, pixel.none() ? no_packet : tracks_[node].packet, pixel, state};
}

void Timeline::began_packet(std::uint32_t node, std::uint64_t packet, sim::Ticks /*start*/) {
  tracks_[node].packet = packet;
}

void Timeline::resumed_packet(std::uint32_t node, std::uint64_t packet) { tracks_[node].packet = packet; }

void Timeline::end(sim::Ticks /*time*/) {
  for (std::uint32_t node = 0; node < tracks_.size(); ++node) {
    put(node);
  }
  if (path_ != nullptr) {
    put_path();
    path_ = nullptr;
  }
  const std::string missing = note();
  stream_.write(missing.empty() ? "\n]}\n"
                                : fmt::format("\n],\"otherData\":{{\"note\":\"{}\"}}}}\n", missing));
  stream_.close();
}

std::string Timeline::note() const {
  std::string text;
  if (cut_at_) {
    text = fmt::format("cut after {} slices: slices of nodes that end later are missing", events_);
  }
  if (path_cut_at_) {
    text += fmt::format("{}of the critical path, what is before {} us is missing", text.empty() ? "" : "; ",
                        microseconds(*path_cut_at_));
  }
  return text;
}

// Writes the node's last slice.
void Timeline::put(std::uint32_t node) {
  const Slice& slice = tracks_[node].slice;
  if (slice.from == slice.to) {
    return;
  }
  if (events_ == options_.most_events) {
    cut_at_ = std::min(cut_at_.value_or(slice.from), slice.from);
    return;
  }
  ++events_;
  name(node);
  std::string arguments;
  if (!slice.pixel.none()) {
    arguments = fmt::format(",\"args\":{{\"x\":{},\"y\":{}", slice.pixel.x, slice.pixel.y);
    arguments += slice.packet == no_packet ? "}" : fmt::format(",\"packet\":{}}}", slice.packet);
  }
  stream_.write(fmt::format(
      ",\n{{\"ph\":\"X\",\"pid\":{},\"tid\":{},\"ts\":{},\"dur\":{},\"name\":\"{}\"{}}}",
      node / nodes_a_cluster_ + 1, node + 1, microseconds(slice.from), microseconds(slice.to - slice.from),
      processors::walk::node_state_names[static_cast<std::size_t>(slice.state)], arguments));
}

// Names the node's track, and its cluster's process, before their first slice.
void Timeline::name(std::uint32_t node) {
  if (tracks_[node].named) {
    return;
  }
  tracks_[node].named = true;
  const std::uint32_t cluster = node / nodes_a_cluster_;
  const std::size_t process = std::size_t{cluster} + 1;
  const std::size_t track = std::size_t{node} + 1;
  if (!cluster_named_[cluster]) {
    cluster_named_[cluster] = true;
    name_part("process_name", process, track, fmt::format("\"name\":\"cluster {}\"", cluster));
    name_part("process_sort_index", process, track, fmt::format("\"sort_index\":{}", cluster));
  }
  name_part("thread_name", process, track, fmt::format("\"name\":\"node {}\"", node));
  name_part("thread_sort_index", process, track, fmt::format("\"sort_index\":{}", node));
}

void Timeline::name_part(std::string_view what, std::size_t process, std::size_t track,
                         const std::string& arguments) {
  stream_.write(fmt::format("{}\n{{\"ph\":\"M\",\"pid\":{},\"tid\":{},\"name\":\"{}\",\"args\":{{{}}}}}",
                            first_ ? "" : ",", process, track, what, arguments));
  first_ = false;
}

// The critical path as slices of one track, the last one first; pieces that a node works on by itself one
// after the other are one slice.
void Timeline::put_path() {
  name_part("process_name", cluster_named_.size() + 1, tracks_.size() + 1, "\"name\":\"critical path\"");
  name_part("process_sort_index", cluster_named_.size() + 1, tracks_.size() + 1,
            fmt::format("\"sort_index\":{}", cluster_named_.size()));
  name_part("thread_name", cluster_named_.size() + 1, tracks_.size() + 1, "\"name\":\"critical path\"");
  std::optional<processors::path::PathPiece> slice;
  path_->each_from_the_end([&](const processors::path::PathPiece& piece) {
    if (slice && slice->goes_on_from(piece)) {
      slice->from = piece.from;
      return;
    }
    if (slice) {
      put_path_slice(*slice);
    }
    slice = piece;
  });
  if (slice) {
    put_path_slice(*slice);
  }
}

void Timeline::put_path_slice(const processors::path::PathPiece& piece) {
  const sim::Ticks from = std::max(piece.from, options_.from);
  const sim::Ticks to = std::min(piece.to, options_.to);
  if (from >= to) {
    return;
  }
  if (path_events_ == options_.most_events) {
    path_cut_at_ = path_from_;
    return;
  }
  ++path_events_;
  path_from_ = from;
  stream_.write(
      fmt::format(",\n{{\"ph\":\"X\",\"pid\":{},\"tid\":{},\"ts\":{},\"dur\":{},\"name\":\"node {}: {}\"}}",
                  cluster_named_.size() + 1, tracks_.size() + 1, microseconds(from), microseconds(to - from),
                  piece.owner.node,
                  processors::path::is_own_work(piece.kind)
                      ? "work"
                      : processors::path::path_kind_names[static_cast<std::size_t>(piece.kind)]));
}

}  // namespace marti::studies::run
