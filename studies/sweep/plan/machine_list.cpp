#include "studies/sweep/plan/machine_list.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "scenes/open.h"
#include "sim/config_errors.h"
#include "sim/error.h"
#include "studies/host/image_file.h"
#include "studies/host/program_build.h"
#include "studies/run/open_frame.h"
#include "studies/run/scene_hash.h"
#include "studies/sweep/plan/digest.h"

namespace marti::studies::sweep {

std::size_t MachineList::enter(ReadPoint& read) {
  const std::size_t frame = enter_frame(read);
  // One log serves all machines of the frame.
  processors::program::RenderOptions& render = frames_[frame].config.render;
  render.entered = render.entered || read.frame.render.entered;
  render.ray_words = render.ray_words || read.frame.render.ray_words;
  render.meets = render.meets || read.frame.render.meets;
  const auto on_frame = [&](const std::string& machine) {
    Digest digest;
    digest.add(frames_[frame].key);
    digest.add(machine);
    return digest.hex();
  };
  std::string key = on_frame(read.machine_digest);
  const auto [place, fresh] = machine_of_key_.emplace(key, machines_.size());
  if (fresh) {
    const std::size_t timing =
        timing_of_key_.emplace(on_frame(read.timing_digest), timing_of_key_.size()).first->second;
    machines_.push_back({std::move(key), frame, timing, read.machine,
                         settings_.share(std::move(read.settings)), read.interval});
    first_point_.push_back(no_point);
  }
  return place->second;
}

void MachineList::reserve(std::size_t machines) {
  machines_.reserve(machines);
  first_point_.reserve(machines);
}

void MachineList::used_by_point(std::size_t machine, std::size_t point) {
  first_point_[machine] = std::min(first_point_[machine], point);
}

void MachineList::move_into(SweepPlan& plan) && {
  std::vector<std::size_t> order(machines_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return std::pair(machines_[a].frame, first_point_[a]) < std::pair(machines_[b].frame, first_point_[b]);
  });
  std::vector<std::size_t> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    place[order[i]] = i;
  }
  // Permutes the list in place, cycle by cycle: a second list would take as much memory again.
  std::vector<std::size_t> to = place;
  for (std::size_t i = 0; i < to.size(); ++i) {
    while (to[i] != i) {
      std::swap(machines_[i], machines_[to[i]]);
      std::swap(to[i], to[to[i]]);
    }
  }
  plan.machines = std::move(machines_);
  plan.frames = std::move(frames_);
  for (SweepPoint& point : plan.points) {
    point.machine = place[point.machine];
    point.base = place[point.base];
  }
  if (plan.compare) {
    plan.compare = place[*plan.compare];
  }
}

std::size_t MachineList::enter_frame(const ReadPoint& read) {
  // The same file name means another file in another base directory.
  const bool file = scenes::reads_files(read.frame.scene) || !read.frame.open.rays.empty();
  const keys::LoggedFrame* const log = read.frame.log.get();
  const std::string known =
      read.frame_digest + (log != nullptr ? log->file.string()
                           : file ? read.frame.open.base_directory.string() + read.frame.open.rays.string()
                                  : "");
  if (const auto found = frame_of_digest_.find(known); found != frame_of_digest_.end()) {
    return found->second;
  }
  Digest digest;
  digest.add(std::string(host::build_of_program()) + "\n" + read.frame_digest);
  std::optional<std::uint64_t> hash;
  if (log != nullptr) {
    digest.add("\n" + std::to_string(log->id));
  } else if (file) {
    const scenes::Scene scene = sim::with_places(read.config, [&] { return run::open_frame(read.frame); });
    hash = run::scene_hash(scene);
    digest.add("\n" + std::to_string(*hash) + " " + std::to_string(scenes::facts_of(scene).polygons));
    // The notes are kept with the frame's row, so they are part of its key.
    for (const std::string& note : scene.notes) {
      digest.add("\n" + note);
    }
  }
  std::string key = digest.hex();
  const auto same = std::ranges::find(frames_, key, &SweepFrame::key);
  const auto index = static_cast<std::size_t>(same - frames_.begin());
  if (same == frames_.end()) {
    frames_.push_back({std::move(key), read.frame, frame_settings(read), hash});
  }
  frame_of_digest_.emplace(known, index);
  return index;
}

}  // namespace marti::studies::sweep
