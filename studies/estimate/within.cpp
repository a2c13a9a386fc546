#include "studies/estimate/within.h"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <utility>

#include "processors/replay/replay.h"
#include "sim/config_errors.h"
#include "sim/error.h"
#include "sim/key_error.h"
#include "sim/units.h"
#include "studies/keys/machine_keys.h"
#include "studies/keys/record_keys.h"
#include "studies/run/prepared_frame.h"
#include "studies/show/result_json.h"
#include "studies/show/summary.h"

namespace marti::studies::estimate {

namespace {

// Of smaller packets a node's cache holds what several of them share, and a sample begins each window without
// it: the frame takes up to a tenth less time than a sample says, with a cache that holds most of what a
// window reads.
constexpr std::uint64_t least_packet_pixels = 64;

std::string exact_output(const run::RunResult& result, const std::string& reason, bool json) {
  return json
             ? show::json_of(result)
             : show::summary_of(result) + fmt::format("\nmethod        exact replay, no error: {}\n", reason);
}

}  // namespace

double parse_tolerance(std::string_view text) {
  try {
    const double value = text.ends_with('%') ? sim::parse_percentage(text)
                                             : 100.0 * sim::parse_percentage(std::string(text) + " %");
    if (value >= 0.0 && value <= 1.0) {
      return value;
    }
  } catch (const sim::UserError&) {  // the message below says more
  }
  throw sim::UserError(
      "\"" + std::string(text) +
      "\": a tolerance is a percentage from 0 to 100 % or a fraction, such as \"2 %\" or 0.02");
}

std::optional<std::string> not_sampled(const keys::FrameConfig& frame) {
  if (frame.render.voxel_cut > 0.0) {
    return "a frame with the voxel cut is not sampled (image.voxel_cut)";
  }
  if (frame.render.integrator == processors::program::Integrator::path) {
    return "the errors of samples of path-traced frames have not been measured (image.integrator)";
  }
  if (processors::program::sends_any_hit_rays(frame.render.integrator)) {
    return "the errors of samples of frames of shadow or occlusion rays alone have not been measured "
           "(image.integrator)";
  }
  if (frame.render.integrator == processors::program::Integrator::rays) {
    return "the errors of samples of given rays have not been measured (image.integrator)";
  }
  if (frame.render.integrator == processors::program::Integrator::gaussians) {
    return "the errors of samples of Gaussians have not been measured (image.integrator)";
  }
  return std::nullopt;
}

std::optional<std::string> not_sampled(const processors::machine::MachineConfig& machine) {
  if (std::uint64_t{machine.packets.width} * machine.packets.height < least_packet_pixels) {
    return fmt::format(
        "the errors of samples have been measured for packets of {} pixels or more, and these have {} x {}",
        least_packet_pixels, machine.packets.width, machine.packets.height);
  }
  try {
    processors::replay::check_sampled(machine);
  } catch (const sim::KeyError& error) {
    return error.reason();
  }
  if (machine.clusters > 1) {
    return "a sample is taken with machine.clusters = 1 only";
  }
  if (machine.placement != processors::machine::Placement::shared) {
    return "a sample is taken with database.placement = \"shared\" only";
  }
  return std::nullopt;
}

std::string run_within(sim::Config& config, double tolerance, bool json, run::RunOptions exact) {
  keys::FrameConfig frame = keys::read_frame(config);
  frame.wait_with(exact.meter);
  run::refuse_several_frames(config, frame.frames);
  const processors::machine::MachineConfig machine = keys::read_machine(config);
  const keys::RecordConfig record = keys::read_record(config, true);
  for (const auto& [asked, key] : {std::pair(record.timeline, "record.timeline"),
                                   {record.heat_maps, "record.heat_maps"},
                                   {record.critical_path, "record.critical_path"},
                                   {record.interval > 0, "record.interval"}}) {
    if (asked) {
      config.fail(key, "an estimate does nothing that could be recorded; leave --within out");
    }
  }
  config.refuse_unused();
  run::refuse_beyond_memory(config, frame, machine);
  std::optional<std::string> reason = not_sampled(frame);
  if (!reason) {
    reason = not_sampled(machine);
  }
  if (tolerance == 0.0) {
    reason = "nothing else is within 0 %";
  }
  if (reason) {
    return exact_output(run::run(config, std::move(exact)), *reason, json);
  }
  return sim::with_places(config, [&] {
    std::optional<run::PreparedFrame> prepared;
    run::FunctionalRun logged;
    if (frame.log == nullptr) {
      prepared.emplace(frame);
    } else {
      logged = run::run_functional(frame);
    }
    SampledFrame sampled = prepared ? sampled_frame(*prepared) : sampled_frame(logged);
    const processors::machine::PacketList packets(frame.render.width, frame.render.height, machine.packets);
    const WithinAnswer answer = estimate_within(sampled, packets, machine, tolerance);
    if (!answer.estimate) {
      exact.functional = prepared ? prepared->finish(std::move(sampled).whole()) : std::move(logged);
      return exact_output(run::run(config, std::move(exact)), answer.reason, json);
    }
    run::RunResult result;
    result.config_name = config.name();
    result.values = config.effective_values();
    result.frame_config = frame;
    result.machine = machine;
    processors::program::Frame part = std::move(sampled).part();
    if (prepared) {
      result.functional = prepared->part(std::move(part));
    } else {
      result.functional = std::move(logged);
      result.functional.frame = std::move(part);
      result.functional.totals = processors::program::totals_of(*result.functional.frame.log);
    }
    return json ? estimate_json(result, *answer.estimate, tolerance)
                : estimate_text(result, *answer.estimate, tolerance);
  });
}

}  // namespace marti::studies::estimate
