#include "studies/run/record/timeline.h"

#include <fmt/format.h>

#include <algorithm>

namespace marti::studies {

using processors::NodeState;
using processors::PixelPlace;

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

void Timeline::begin(const processors::ReplayInput& input) {
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
  std::string tail = "\n]";
  if (cut_at_) {
    tail += fmt::format(
        ",\"otherData\":{{\"note\":\"cut after {} slices: slices that end later are missing\"}}", events_);
  }
  stream_.write(tail + "}\n");
  stream_.close();
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
      processors::node_state_names[static_cast<std::size_t>(slice.state)], arguments));
}

// Names the node's track, and its cluster's process, before their first slice.
void Timeline::name(std::uint32_t node) {
  if (tracks_[node].named) {
    return;
  }
  tracks_[node].named = true;
  const std::uint32_t cluster = node / nodes_a_cluster_;
  const auto meta = [&](std::string_view what, const std::string& arguments) {
    stream_.write(fmt::format("{}\n{{\"ph\":\"M\",\"pid\":{},\"tid\":{},\"name\":\"{}\",\"args\":{{{}}}}}",
                              first_ ? "" : ",", cluster + 1, node + 1, what, arguments));
    first_ = false;
  };
  if (!cluster_named_[cluster]) {
    cluster_named_[cluster] = true;
    meta("process_name", fmt::format("\"name\":\"cluster {}\"", cluster));
    meta("process_sort_index", fmt::format("\"sort_index\":{}", cluster));
  }
  meta("thread_name", fmt::format("\"name\":\"node {}\"", node));
  meta("thread_sort_index", fmt::format("\"sort_index\":{}", node));
}

}  // namespace marti::studies
