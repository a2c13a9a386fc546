// What a sweep runs: the frames to be traced once each, and the machines to be timed on them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "processors/machine/machine_config.h"
#include "sim/config.h"
#include "studies/keys/frame_keys.h"
#include "studies/keys/machine_cost.h"
#include "studies/sweep/plan/axis_values.h"
#include "studies/sweep/plan/question.h"
#include "studies/sweep/plan/shared_settings.h"

namespace marti::studies::sweep {

/// One functional run: equal values give the same image and the same work log.
struct SweepFrame {
  /// 32 hexadecimal digits of the settings, of the program's build (program_build.h) and, where the scene is
  /// a file, its rays are, or a log stands in its place, of what is in that.
  std::string key;
  keys::FrameConfig config;
  std::vector<sim::EffectiveValue> settings;  ///< that a frame reads, without host_machine.*
  /// Hash of the scene as it was planned, where it or its rays are a file; the scene must be the same when it
  /// is traced.
  std::optional<std::uint64_t> scene_hash{};

  /// Camera rays, by which frames and their machines take about as long as others.
  [[nodiscard]] double rays() const {
    return static_cast<double>(config.render.width) * config.render.height * config.render.samples;
  }
};

/// One machine on one frame. It is replayed once, however many points ask for it.
struct SweepMachine {
  std::string key;        ///< 32 hexadecimal digits of the frame's key and the machine's settings
  std::size_t frame = 0;  ///< index into SweepPlan::frames
  /// Machines with equal numbers take equal times and counts and need one replay for all of them: they differ
  /// only in figures of energy, or in widths of the interconnect that move a line in as many beats.
  std::size_t timing = 0;
  processors::machine::MachineConfig config;
  SharedSettings settings;  ///< the machine's keys only
  sim::Ticks interval = 0;  ///< of record.interval; 0: none
};

/// One point of the sweep's axes.
struct SweepPoint {
  std::vector<sim::Value> values;  ///< one for each of SweepPlan::axes
  std::size_t machine = 0;         ///< index into SweepPlan::machines
  std::size_t base = 0;            ///< the machine that its speed-up is measured against
  double cost = 0.0;               ///< by [prices]
};

/// A direction of the sweep, for people.
struct SweepDirection {
  std::vector<std::string> keys;   ///< that change together; "point" for named points
  std::vector<std::string> steps;  ///< what each step gives them
};

/// A point that is left out because its machine cannot be built.
struct SkippedPoint {
  std::string point;                 ///< "cache.ways = 8, ..."
  std::string reason;                ///< names file, line and key
  std::vector<sim::Value> values{};  ///< one for each of SweepPlan::axes
};

struct SweepPlan {
  std::string file;  ///< the configuration's name, as it stands in messages
  /// Keys that differ between points, "point" first where there are named points. The value of a key that is
  /// a list is a text.
  std::vector<std::string> axes;
  std::vector<SweepFrame> frames;
  /// All keys differ. Ordered by frame; those of the points in the points' order, then base machines that no
  /// point asks for.
  std::vector<SweepMachine> machines;
  std::vector<SweepPoint> points;      ///< that pass the filter; the last axis changes fastest
  std::uint64_t filtered_out = 0;      ///< points that do not pass
  std::optional<std::size_t> compare;  ///< the machine that all are compared with
  std::optional<keys::Prices> prices;  ///< if any is given; they rank what would help
  Question question;                   ///< of [question]
  std::string study{};                 ///< the study whose sweep this is; empty: that of `marti sweep`

  std::vector<SweepDirection> directions;  ///< all are crossed, the last changes fastest
  bool leaves_out = false;                 ///< points that cannot be run, instead of refusing all
  std::vector<SkippedPoint> skipped;       ///< only then
  std::vector<std::string> notes;          ///< about the input, each naming file and line
};

/// What becomes of a point that cannot be run.
enum class Unfit : std::uint8_t {
  by_key,   ///< sweep.skip_invalid says whether one whose machine cannot be built is left out
  left_out  ///< it is left out, also one whose scene cannot be read
};

/// Reads [sweep] and [prices] of a configuration of sweep_schema() and makes its points. Machines are read on
/// all host cores; the plan is the same at any number of them. A scene that is a file is opened: its content
/// is part of the frame's key. Throws UserError naming file, line and key; for a point whose machine cannot
/// be built, of the first such point in order, with what the point gives; for a plan beyond
/// host_machine.memory_limit, before its points are read. `meter` may stop the planning and is that of its
/// frames; null: nobody waits. `more`: axes like those of the command line, whose steps know where they are
/// from. What is refused only once a scene is traced is found by leave_out_unfit() (sweep/sweep.h).
[[nodiscard]] SweepPlan plan_sweep(sim::Config& config, std::span<const std::string> axes = {},
                                   sim::WorkMeter* meter = nullptr, std::span<const AxisArgument> more = {},
                                   Unfit unfit = Unfit::by_key);

/// What is known of a plan before it runs: what its store holds already, and what it needs.
struct SweepOutlook {
  std::size_t machines_done = 0;    ///< whose results are there
  std::size_t frames_done = 0;      ///< whose logs no machine needs any more
  std::uint64_t machine_bytes = 0;  ///< memory of the largest machines that may be timed at once
};

/// Host bytes that a plan takes, about, in which each of `points` points has `axes` values and a machine of
/// its own. A text among the values that is longer than 15 bytes takes more.
[[nodiscard]] std::uint64_t plan_bytes(std::uint64_t points, std::size_t axes);

/// The plan as text for people, a few lines.
[[nodiscard]] std::string describe(const SweepPlan& plan, const SweepOutlook& outlook = {});

}  // namespace marti::studies::sweep
