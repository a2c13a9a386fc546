#include "studies/verify/verify_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "processors/program/shading.h"
#include "sim/error.h"
#include "sim/mapped.h"
#include "studies/host/image_file.h"
#include "studies/run/plan/make_plan.h"
#include "studies/show/result_json.h"

namespace marti::studies::verify {

namespace {

// One row without the shadow rays and lights at points of these materials, and where each pixel begins in it.
processors::program::LogRow strip_row(const std::vector<bool>& materials,
                                      const processors::program::LogRow& row) {
  using processors::program::Step;
  std::vector<std::uint32_t> words;
  std::vector<std::uint32_t> begin;
  bool unlit = false;    // the current point has one of these materials
  bool leaving = false;  // inside a ray that is left out
  std::size_t pixel = 0;
  std::size_t at = 0;
  for (; at < row.words.size(); at += processors::program::step_words(&row.words[at])) {
    for (; row.begin[pixel] <= at && pixel + 1 < row.begin.size(); ++pixel) {
      begin.push_back(static_cast<std::uint32_t>(words.size()));
    }
    const Step step = processors::program::step_of(row.words[at]);
    const std::uint32_t operand = processors::program::operand_of(row.words[at]);
    if (step == Step::shade) {
      unlit = operand < materials.size() && materials[operand];
    } else if (step == Step::ray) {
      leaving = unlit && processors::program::ray_kind_of(operand) == processors::program::RayKind::shadow;
    }
    const bool visit = processors::program::visits_node(step) || step == Step::pass || step == Step::ray;
    if ((leaving && visit) || (unlit && step == Step::light)) {
      continue;
    }
    for (std::size_t word = 0; word < processors::program::step_words(&row.words[at]); ++word) {
      words.push_back(row.words[at + word]);
    }
  }
  begin.resize(row.begin.size(), static_cast<std::uint32_t>(words.size()));
  return {{words.begin(), words.end()}, {begin.begin(), begin.end()}};
}

std::string difference_of_images(const processors::program::Image& a, const processors::program::Image& b) {
  std::size_t different = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    for (int channel = 0; channel < 3; ++channel) {
      if (std::bit_cast<std::uint32_t>(a.pixels[i][channel]) !=
          std::bit_cast<std::uint32_t>(b.pixels[i][channel])) {
        ++different;
        break;
      }
    }
  }
  return different == 0 ? "" : fmt::format("{} pixels differ", different);
}

// What differs between the planned frame and one with more items kept. `unlit`: the materials at which only
// the latter may have shadow rays.
std::string difference_of_frames(const run::FunctionalRun& planned, const run::FunctionalRun& kept,
                                 const std::vector<bool>* unlit) {
  if (std::string pixels = difference_of_images(planned.frame.image, kept.frame.image); !pixels.empty()) {
    return pixels;
  }
  if (unlit == nullptr && planned.frame.hit_hash != kept.frame.hit_hash) {
    return "hits of rays differ";
  }
  return unlit == nullptr ? difference_of(*planned.frame.log, *kept.frame.log)
                          : difference_of(*planned.frame.log, without_shadows_at(*unlit, *kept.frame.log));
}

std::string machine_of(const run::RunResult& result) {
  nlohmann::ordered_json machine = nlohmann::ordered_json::parse(show::json_of(result))["machine"];
  // Both are found once, not by the runs that are compared with the first.
  machine.erase("what_helps");
  machine.erase("critical_path");
  return machine.dump();
}

class Verifier {
 public:
  explicit Verifier(const run::RunResult& result) : result_(result) {
    const keys::FrameConfig& frame = result.frame_config;
    scenes::OpenOptions open = frame.open;
    open.file.size_only = host::size_of_image;
    unlit_ = unlit_materials(scenes::open_scene(frame.scene, open, host::decode_image));
  }

  PlanVerdict verdict() {
    for (const run::PlanEntry& entry : result_.functional.plan.entries) {
      if (entry.decision == run::PlanDecision::left_out) {
        attempt(run::name_of(entry.item), [&] { check(entry.item); });
      }
    }
    for (const run::PlanItem item : {run::PlanItem::contention, run::PlanItem::cache}) {
      check_machine(item);
    }
    attempt("all kept", [&] { check_all(); });
    return std::move(verdict_);
  }

 private:
  void say(std::string_view what, const std::string& difference, std::string_view proof) {
    verdict_.holds = verdict_.holds && difference.empty();
    verdict_.text += fmt::format("{:<14}{}: {}\n", verdict_.text.empty() ? "verified" : "", what,
                                 difference.empty() ? std::string(proof) : "DIFFERS: " + difference);
  }

  // Keeping an item may need a part of a file that cannot be read: then there is nothing to compare with.
  template <class Check>
  void attempt(std::string_view what, const Check& compare) {
    try {
      compare();
    } catch (const sim::UserError& error) {
      verdict_.text += fmt::format("{:<14}{}: not verified, it cannot be kept: {}\n",
                                   verdict_.text.empty() ? "verified" : "", what, error.what());
    }
  }

  void check(run::PlanItem item) {
    keys::FrameConfig config = result_.frame_config;
    config.keep.keep(item);
    const run::FunctionalRun kept = run::run_functional(config);
    const bool shadows = item == run::PlanItem::shadow_rays;
    const std::string difference =
        difference_of_frames(result_.functional, kept, shadows ? &unlit_ : nullptr);
    const std::uint64_t more = kept.frame.rays.all() - result_.functional.frame.rays.all();
    say(run::name_of(item), difference,
        more == 0 ? "same image, same hits, same work log"
                  : fmt::format("same image; without the {} shadow rays more that are sent when it is kept, "
                                "the same work log",
                                more));
  }

  // Items of the machine do not change the frame, so it is not rendered again.
  void check_machine(run::PlanItem item) {
    const auto& entries = result_.plan.entries;
    const bool left_out = std::ranges::any_of(entries, [&](const run::PlanEntry& entry) {
      return entry.item == item && entry.decision == run::PlanDecision::left_out;
    });
    if (left_out) {
      run::KeptItems keep = result_.frame_config.keep;
      keep.keep(item);
      const bool same = machine_of(result_) == machine_of(run::time_again(result_, keep));
      say(run::name_of(item), same ? "" : "figures of the machine differ",
          "every figure of the machine is the same");
    }
  }

  void check_all() {
    const run::RunResult all = run::run_again(result_, run::KeptItems::all());
    const bool same_rays = all.functional.frame.hit_hash == result_.functional.frame.hit_hash;
    std::string difference =
        difference_of_frames(result_.functional, all.functional, same_rays ? nullptr : &unlit_);
    if (difference.empty() && same_rays && machine_of(result_) != machine_of(all)) {
      difference = "figures of the machine differ";
    }
    say("all kept", difference,
        same_rays ? "same image, same hits, same work log, and every figure of the machine is the same"
                  : "same image, the same work log but for these rays; the machine's figures are those of "
                    "other rays and are not compared");
  }

  const run::RunResult& result_;
  std::vector<bool> unlit_;
  PlanVerdict verdict_;
};

}  // namespace

processors::program::WorkLog without_shadows_at(const std::vector<bool>& materials,
                                                const processors::program::WorkLog& log) {
  processors::program::WorkLog kept = log;
  for (processors::program::LogRow& row : kept.rows) {
    row = strip_row(materials, row);
  }
  return kept;
}

std::vector<bool> unlit_materials(const scenes::Scene& scene) {
  return sim::mapped(scene.materials, [&](const scenes::Material& material) {
    return processors::program::asks_lights(material) && !processors::program::shows_light(material);
  });
}

std::string difference_of(const processors::program::WorkLog& a, const processors::program::WorkLog& b) {
  if (a.traversal != b.traversal || a.integrator != b.integrator || a.mailboxes != b.mailboxes ||
      a.width != b.width || a.height != b.height || a.samples != b.samples || a.primitives != b.primitives ||
      a.quadrics != b.quadrics || a.materials != b.materials || a.voxels != b.voxels ||
      a.lights != b.lights || a.texture_begin != b.texture_begin || a.rows.size() != b.rows.size()) {
    return "the work logs are of other databases";
  }
  if (a.topology.nodes != b.topology.nodes || a.topology.entries != b.topology.entries) {
    return "the work logs are of other trees";
  }
  for (std::size_t y = 0; y < a.rows.size(); ++y) {
    if (a.rows[y].words != b.rows[y].words || a.rows[y].begin != b.rows[y].begin) {
      return fmt::format("the work logs differ in row {}", y);
    }
  }
  return "";
}

PlanVerdict verify_plan(const run::RunResult& result) { return Verifier(result).verdict(); }

}  // namespace marti::studies::verify
