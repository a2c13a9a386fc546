#include "processors/cost/cost_model.h"

#include <limits>

#include "processors/cost/operation_mix.h"
#include "sim/error.h"
#include "sim/time.h"

namespace marti::processors::cost {

namespace {

struct Preset {
  std::string_view name;
  machine::OperationCycles cycles;
};

constexpr std::array<std::string_view, 4> names{"unit", "mc68882-1989", "arm1176-2003", "cortex-a510-2021"};

// Names that said less, and what they are called now.
constexpr std::array<sim::RenamedChoice, 2> renamed{
    {{"mc68882", "mc68882-1989"}, {"modern", "arm1176-2003"}}};

constexpr std::array<Preset, 4> presets{{
    // One cycle for every operation: for arguments about counts, and for tests.
    {"unit",
     {.add = 1,
      .multiply = 1,
      .divide = 1,
      .square_root = 1,
      .compare = 1,
      .integer = 1,
      .load = 1,
      .store = 1}},
    // A workstation node of 1990: MC68030 with MC68882 on one clock (33 MHz class). Floating point: the
    // register-to-register totals as commonly quoted from section 8 of Motorola's MC68881/MC68882
    // Floating-Point Coprocessor User's Manual (2nd ed., 1989): FADD 56, FMUL 76, FDIV 108, FSQRT 110,
    // FCMP 38. By that section's assumptions they include the coprocessor dialogue of a processor on the same
    // clock, without wait states and with the coprocessor idle before: no overlap of one instruction's end
    // with the next one's start, which the MC68882 has (its manual gives heads and tails for it). The
    // tables themselves were not at hand; other models quote the same totals, but for FCMP, which one
    // of them has with FADD at 56. The other three are conventions, not figures: 4 cycles for an integer
    // instruction, 6 to issue the load of a long word and 4 for a store.
    {"mc68882-1989",
     {.add = 56,
      .multiply = 76,
      .divide = 108,
      .square_root = 110,
      .compare = 38,
      .integer = 4,
      .load = 6,
      .store = 4}},
    // An in-order scalar core of 2003 with a pipelined double-precision unit whose every operation waits for
    // the one before: the latencies of the ARM11's VFP11 (ARM1176JZF-S Technical Reference Manual, ARM DDI
    // 0301H, table 21-16: FADD 8, FMUL 9, FDIV and FSQRT 33, FCMP 4). Integer operations, loads and stores
    // are issued one a cycle.
    {"arm1176-2003",
     {.add = 8,
      .multiply = 9,
      .divide = 33,
      .square_root = 33,
      .compare = 4,
      .integer = 1,
      .load = 1,
      .store = 1}},
    // A small in-order core of today, the Cortex-A510 (Arm, 2021). Its pipelines are taken to be full, as
    // where a compiler puts other rays' operations between dependent ones: each operation costs the cycles
    // until the next one of its kind can begin, not its latency. Single precision, as the 4-byte coordinates
    // of the database. From LLVM's model of it, after Arm's Cortex-A510 Software Optimization Guide
    // (github.com/llvm/llvm-project, commit 48f247b, llvm/lib/Target/AArch64/AArch64SchedA510.td): a division
    // has its unit for 10 cycles (CortexA510WriteFDivSP), a square root for 9 (CortexA510WriteFSqrtSP); of
    // double precision both take 19. Additions and comparisons have two pipelines (WriteF, WriteFCmp), so do
    // multiplications (WriteFMul) and loads (WriteLD), integer operations have three (WriteI) and stores one
    // (WriteST), each of which takes a new operation every cycle. All of these cost one cycle: operations of
    // a step are issued one a cycle here, while the core can issue up to three side by side.
    {"cortex-a510-2021",
     {.add = 1,
      .multiply = 1,
      .divide = 10,
      .square_root = 9,
      .compare = 1,
      .integer = 1,
      .load = 1,
      .store = 1}},
}};

}  // namespace

std::int64_t price(const OperationMix& mix, const machine::OperationCycles& cycles, std::int64_t fixed) {
  // Prices may be anything that fits 64 bits; a sum of six prices times their counts then fits 128.
  __extension__ using Wide = __int128;
  const auto times = [](std::int64_t count, std::int64_t price) { return static_cast<Wide>(count) * price; };
  const Wide thousandths = times(mix.add, cycles.add) + times(mix.multiply, cycles.multiply) +
                           times(mix.divide, cycles.divide) + times(mix.square_root, cycles.square_root) +
                           times(mix.compare, cycles.compare) + times(mix.integer, cycles.integer);
  const Wide whole = (thousandths + 500) / 1000;
  if (whole > std::numeric_limits<std::int64_t>::max()) {
    sim::fail_time_overflow();
  }
  return sim::add_ticks(static_cast<std::int64_t>(whole), fixed);
}

std::span<const std::string_view> cost_presets() { return names; }

std::span<const sim::RenamedChoice> renamed_cost_presets() { return renamed; }

machine::OperationCycles cost_preset(std::string_view name) {
  std::string known;
  for (const Preset& preset : presets) {
    if (preset.name == name) {
      return preset.cycles;
    }
    known += (known.empty() ? "" : ", ") + std::string(preset.name);
  }
  throw sim::UserError("there is no cost preset \"" + std::string(name) + "\"; there are: " + known);
}

std::int64_t fetch_record(const machine::OperationCycles& cycles, std::int64_t words) {
  return sim::add_ticks(cycles.integer, sim::multiply_ticks(cycles.load, words));
}

std::int64_t store_record(const machine::OperationCycles& cycles, std::int64_t words) {
  return sim::add_ticks(cycles.integer, sim::multiply_ticks(cycles.store, words));
}

StepCycles step_cycles(const machine::OperationCycles& cycles, const RecordWords& words,
                       accel::Traversal traversal, bool mailboxes, program::Integrator integrator) {
  const OperationMixes& mixes = operation_mixes(traversal);
  const bool path = integrator == program::Integrator::path;
  StepCycles steps;
  for (std::size_t kind = 0; kind < program::ray_kinds; ++kind) {
    steps.ray[kind] = price(mixes.ray[kind], cycles, 0);
  }
  steps.branch = price(mixes.branch, cycles, fetch_record(cycles, words.node));
  steps.transform = price(mixes.transform, cycles, fetch_record(cycles, words.transform));
  steps.leaf = price(mixes.leaf, cycles, accel::walks_bvh(traversal) ? 0 : fetch_record(cycles, words.node));
  const std::int64_t entry = fetch_record(cycles, words.entry);
  const std::int64_t primitive = fetch_record(cycles, words.primitive);
  const std::int64_t quadric = fetch_record(cycles, words.quadric);
  // With mailboxes the look-up fetches the entry, and a test leaves the ray's number in the mailbox.
  if (mailboxes) {
    steps.lookup = price(mixes.lookup, cycles, sim::add_ticks(entry, fetch_record(cycles, 1)));
  }
  const std::int64_t beside = mailboxes ? cycles.store : entry;
  steps.test = price(mixes.test, cycles, sim::add_ticks(beside, primitive));
  steps.sphere_test = price(mixes.sphere_test, cycles, sim::add_ticks(beside, quadric));
  steps.cone_test = price(mixes.cone_test, cycles, sim::add_ticks(beside, quadric));
  // A ray to a point of a light, or into the hemisphere, is drawn as path tracing draws them: there the point
  // is a part of shading, and the direction one of scattered rays.
  std::int64_t& any_hit = steps.ray[static_cast<std::size_t>(program::RayKind::shadow)];
  if (integrator == program::Integrator::shadow) {
    const std::int64_t drawing = price(mixes.path_shade, cycles, 0) - price(mixes.shade, cycles, 0);
    any_hit = sim::add_ticks(any_hit, std::max<std::int64_t>(drawing, 0));
  } else if (integrator == program::Integrator::occlusion) {
    any_hit = steps.ray[static_cast<std::size_t>(program::RayKind::diffuse)];
  }
  // The nearest primitive and the lights are in the node's registers or local store.
  steps.shade = price(path ? mixes.path_shade : mixes.shade, cycles, fetch_record(cycles, words.material));
  steps.light = price(path ? mixes.path_light : mixes.light, cycles, 0);
  steps.texel = price(mixes.texel, cycles, fetch_record(cycles, words.texel));
  steps.any_hit = price(mixes.any_hit, cycles, fetch_record(cycles, words.material));
  if (integrator == program::Integrator::gaussians) {
    // A ray that goes on is set up as one from the camera is.
    steps.ray[static_cast<std::size_t>(program::RayKind::refraction)] =
        steps.ray[static_cast<std::size_t>(program::RayKind::camera)];
    steps.shade = price(mixes.collect, cycles, fetch_record(cycles, words.material));
    steps.any_hit = price(mixes.meet, cycles, fetch_record(cycles, words.material));
  }
  steps.cut = price(mixes.cut, cycles, fetch_record(cycles, words.node));
  steps.pass = price(mixes.cut, cycles, fetch_record(cycles, words.material));
  steps.pixel = price(mixes.pixel, cycles, store_record(cycles, words.pixel));
  return steps;
}

}  // namespace marti::processors::cost
