#include "studies/run/expected_times.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>

#include "accel/bsp.h"
#include "accel/octree.h"

namespace marti::studies::run {

namespace {

using processors::machine::MachineConfig;
using processors::machine::NodeKind;
using processors::machine::Scheme;

// All found by timing runs on two cores of 2.6 GHz; docs/internals/benchmarks.md says how well they hold.
constexpr double seconds_a_byte = 22e-9;      // of a text; others have fewer bytes for as much work
constexpr double bytes_a_primitive = 38.0;    // of a text
constexpr double seconds_a_ray = 1.5e-6;      // on one core
constexpr double steps_a_ray = 100.0;         // of a camera ray and all that follow from it
constexpr double stripping_of_a_step = 4e-9;  // on one core
constexpr double tracing_of_a_step = 13e-9;   // on one core
// Measuring what would help takes this much, and so much of what tracing, stripping and timing take together.
constexpr double help = 0.25;
constexpr double help_in_parts = 0.8;

// The mean of scenes, which differ by twice that and half of it.
double building_of_a_primitive(const std::string& structure) {
  return structure == accel::Octree::kind_name ? 3.3e-6 : structure == accel::Bsp::kind_name ? 4e-6 : 0.8e-6;
}

// Of a step of the log, on one core, the machine and one node together: those that have most events take
// longest.
double timing_of_a_step(const MachineConfig& machine, bool stripped) {
  if (machine.scheme == Scheme::pipeline) {
    return 63e-9;
  }
  if (machine.scheme == Scheme::space) {
    return 25e-9;
  }
  if (machine.kind == NodeKind::simt) {
    return 60e-9;
  }
  return stripped ? 1.8e-9 : machine.contexts > 1 ? 200e-9 : 20e-9;
}

double file_bytes(const std::string& scene) {
  std::error_code none;
  const std::uintmax_t bytes = std::filesystem::file_size(scene, none);
  return none ? 0.0 : static_cast<double>(bytes);
}

double cores() { return static_cast<double>(tbb::this_task_arena::max_concurrency()); }

}  // namespace

void ExpectedTimes::begin(const keys::FrameConfig& frame, const MachineConfig& machine, bool strips,
                          bool measures_help) {
  const double bytes = file_bytes(frame.scene);
  reading_ = bytes * seconds_a_byte;
  primitives_ = bytes / bytes_a_primitive;
  structure_ = frame.structure;
  rays_ = static_cast<double>(frame.render.width) * frame.render.height * frame.render.samples;
  ray_seconds_ = seconds_a_ray / cores();
  ray_steps_ = steps_a_ray;
  const bool several = machine.all_nodes() > 1;
  stripping_ = strips ? stripping_of_a_step / cores() : 0.0;
  timing_ = timing_of_a_step(machine, strips) / (several ? std::min(cores(), 2.0) : 1.0);
  // Where rays move, one node is done with all packets long before the machine is.
  even_packets_ = machine.scheme == Scheme::image;
  measures_help_ = measures_help;
  if (bytes > 0.0) {
    say();  // how large a scene is that a program makes is not known yet
  }
}

void ExpectedTimes::scene_read(std::uint64_t primitives) {
  primitives_ = static_cast<double>(primitives);
  say();
}

void ExpectedTimes::sampled(std::uint64_t rays, double seconds,
                            const processors::program::LogTotals& totals) {
  ray_steps_ = static_cast<double>(totals.all_steps()) / static_cast<double>(rays);
  // The first rays find nothing in the computer's caches: of a large scene they take many times as long.
  ray_seconds_ =
      std::min(seconds / static_cast<double>(rays), 2.0 * tracing_of_a_step * ray_steps_ / cores());
  say();
}

void ExpectedTimes::traced(const processors::program::LogTotals& totals) {
  ray_steps_ = static_cast<double>(totals.all_steps()) / std::max(rays_, 1.0);
  say();
}

void ExpectedTimes::tracing_begins() { begun_ = std::chrono::steady_clock::now(); }

void ExpectedTimes::timed() {
  taken_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun_).count();
  say();
}

void ExpectedTimes::say() const {
  const double steps = rays_ * ray_steps_;
  const double tracing = rays_ * ray_seconds_;
  const double stripping = steps * stripping_;
  const double timing = steps * timing_;
  std::vector<progress::ForeseenPart> parts = {
      {"reading", reading_, false},
      {"building", primitives_ * building_of_a_primitive(structure_), false},
      {"tracing", tracing},
      {"taking known references out", stripping},
      {"timing", timing, even_packets_}};
  if (measures_help_) {
    // Not all machines that might be timed are.
    parts.push_back(
        {"measuring", help + help_in_parts * taken_.value_or(tracing + stripping + timing), false});
  }
  foreseen_.say(std::move(parts));
}

}  // namespace marti::studies::run
