#include "studies/show/verify_plan.h"

#include <cstring>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/error.h"
#include "studies/run/plan/make_plan.h"
#include "studies/show/result_json.h"

namespace marti::studies::show {

namespace {

bool same_pixels(const processors::program::Image& a, const processors::program::Image& b) {
  return a.pixels.size() == b.pixels.size() &&
         std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(a.pixels[0])) == 0;
}

std::string machine_of(const run::RunResult& result) {
  nlohmann::ordered_json machine = nlohmann::ordered_json::parse(json_of(result))["machine"];
  // Both are found once, not by the run that is compared with the first.
  machine.erase("what_helps");
  machine.erase("critical_path");
  return machine.dump();
}

std::string difference_of_runs(const run::RunResult& planned, const run::RunResult& kept) {
  const processors::program::Frame& first = planned.functional.frame;
  const processors::program::Frame& second = kept.functional.frame;
  if (!same_pixels(first.image, second.image)) {
    return "pixels";
  }
  if (first.hit_hash != second.hit_hash) {
    return "hits of rays";
  }
  if (std::string logs = difference_of(*first.log, *second.log); !logs.empty()) {
    return logs;
  }
  return machine_of(planned) == machine_of(kept) ? "" : "figures of the machine";
}

}  // namespace

std::string difference_of(const processors::program::WorkLog& a, const processors::program::WorkLog& b) {
  if (a.traversal != b.traversal || a.integrator != b.integrator || a.mailboxes != b.mailboxes ||
      a.width != b.width || a.height != b.height || a.samples != b.samples || a.primitives != b.primitives ||
      a.quadrics != b.quadrics || a.materials != b.materials || a.voxels != b.voxels ||
      a.lights != b.lights || a.texture_begin != b.texture_begin || a.rows.size() != b.rows.size()) {
    return "the databases of the work logs";
  }
  if (a.topology.nodes != b.topology.nodes || a.topology.entries != b.topology.entries) {
    return "the trees of the work logs";
  }
  for (std::size_t y = 0; y < a.rows.size(); ++y) {
    if (a.rows[y].words != b.rows[y].words || a.rows[y].begin != b.rows[y].begin) {
      return fmt::format("row {} of the work logs", y);
    }
  }
  return "";
}

PlanVerdict verify_plan(const run::RunResult& result) {
  PlanVerdict verdict;
  const auto say = [&](const std::string& text) {
    verdict.text += fmt::format("{:<14}{}\n", verdict.text.empty() ? "verified" : "", text);
  };
  const auto differs = [&](const std::string& what) {
    verdict.holds = false;
    say("DIFFERS with everything kept: " + what);
  };
  try {
    const bool shadows = run::is_left_out(result.functional.plan, run::PlanItem::shadow_rays);
    const std::string difference =
        difference_of_runs(result, run::run_again(result, run::KeptItems::all_but_shadow_rays()));
    if (!difference.empty()) {
      differs(difference);
    } else {
      say("with everything kept the same image, hits, work log, and every figure of the machine");
    }
    if (shadows) {
      const run::RunResult all = run::run_again(result, run::KeptItems::all());
      const std::uint64_t more = all.functional.frame.rays.all() - result.functional.frame.rays.all();
      if (!same_pixels(result.functional.frame.image, all.functional.frame.image)) {
        differs("pixels, with the shadow rays that no light could show");
      } else {
        say(fmt::format("the same image with the {} shadow rays that no light could show", more));
      }
    }
  } catch (const sim::UserError& error) {
    say(std::string("not verified, what was left out cannot be kept: ") + error.what());
  }
  return verdict;
}

}  // namespace marti::studies::show
