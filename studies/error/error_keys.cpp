#include "studies/error/error_keys.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "memory/cache_config.h"
#include "scenes/open.h"
#include "sim/key_error.h"
#include "sim/units.h"
#include "studies/estimate/simulator_methods.h"
#include "studies/host/image_file.h"
#include "studies/keys/key_parts.h"
#include "studies/keys/machine_keys.h"
#include "studies/keys/other_commands.h"
#include "studies/run/run_result.h"

namespace marti::studies::error {

namespace {

constexpr std::array<std::string_view, 2> family_names = {"simulator", "rendering"};

// Refuses machines that cannot be built or that a method cannot answer for.
void check_machines(const sim::Config& config, const ErrorConfig& error) {
  for (const std::uint64_t cache : error.caches) {
    const processors::machine::MachineConfig machine = machine_with(error.machine, error.nodes.back(), cache);
    try {
      processors::machine::check(machine);
    } catch (const sim::KeyError& problem) {
      const bool size = problem.key() == "cache.size";
      config.fail(size ? "error.cache_sizes" : problem.key(),
                  (size ? sim::print_size(static_cast<std::int64_t>(cache)) + ": " : "") + problem.reason());
    }
    run::refuse_beyond_memory(config, error.frame, machine);
    for (const estimate::Method& method : estimate::simulator_methods()) {
      try {
        estimate::check_method(method, machine);
      } catch (const sim::KeyError& problem) {
        config.fail(problem.key(), "the study measures every method on the machine, and " + problem.reason());
      }
    }
  }
}

// Opens every scene before anything is measured.
void check_scenes(const sim::Config& config, const ErrorConfig& error) {
  for (const std::string& scene : error.scenes) {
    try {
      (void)scenes::open_scene(scene, error.frame.open, host::decode_image);
    } catch (const sim::UserError& problem) {
      config.fail("error.scenes", problem.what());
    }
  }
}

}  // namespace

void declare_error_keys(sim::Schema& schema) {
  schema.section("error",
                 "only for `marti study error`: the scenes and machines on which cheaper methods are held "
                 "against exact replay; image, structure and the rest of the machine are those of this file");
  sim::Key families;
  families.name = "error.families";
  families.type = sim::ValueType::choice;
  families.is_list = true;
  families.choices = {family_names.begin(), family_names.end()};
  families.default_value = {families.choices[0], families.choices[1]};
  families.meaning =
      "what is measured: cheaper ways of timing machines, on error.scenes, and cheaper settings of the "
      "renderer, on scene.source";
  schema.add(std::move(families));
  schema.texts("error.scenes", {"gears:2", "tetra:6", "teapot:4", "teapot:12", "large"},
               "scenes whose frames are timed");
  schema.integers("error.sides", {512, 1024}, {1, 32768}, "pixels",
                  "sides of the square images that are timed, in the place of image.width and image.height");
  schema.integers("error.nodes", {1, 4, 16, 64, 256}, {1, 65536}, "nodes",
                  "nodes of a machine, in the place of machine.nodes; 1 must be among them");
  sim::Key sizes;
  sizes.name = "error.cache_sizes";
  sizes.type = sim::ValueType::size;
  sizes.is_list = true;
  for (const std::int64_t size : {32, 2048, 16384, 4 * 1024 * 1024}) {
    sizes.default_value.emplace_back(std::int64_t{size});
  }
  sizes.minimum = sim::Value(std::int64_t{1});
  sizes.maximum = sim::Value(std::int64_t{1} << 32U);
  sizes.meaning = "sizes of each node's cache, in the place of cache.size";
  schema.add(std::move(sizes));
  schema.integer("error.repeats", 3, {1, 1000}, "",
                 "times that each run time is measured, in interleaved order");
  schema.integer("error.seed", 1, {0, std::int64_t{1} << 62U}, "", "seed of the samples of packets");
}

sim::Schema error_schema() {
  sim::Schema schema;
  keys::declare_frame_keys(schema);
  keys::declare_machine_keys(schema);
  declare_error_keys(schema);
  declare_rendering_error_keys(schema);
  keys::declare_sections_of_other_commands(schema);
  return schema;
}

processors::machine::MachineConfig machine_with(const processors::machine::MachineConfig& machine,
                                                std::uint32_t nodes, std::uint64_t cache_bytes) {
  processors::machine::MachineConfig other = machine;
  other.nodes = nodes;
  memory::CacheConfig& cache = other.cache.cache;
  cache.size = cache_bytes;
  const std::uint64_t lines = cache_bytes / cache.line;
  if (cache.ways > lines && lines > 0) {
    cache.ways = static_cast<std::uint32_t>(lines);
  }
  return other;
}

ErrorConfig read_error(sim::Config& config) {
  ErrorConfig error;
  error.frame = keys::read_one_frame(config);
  for (const sim::Value& name : config.values("error.families")) {
    const auto at = std::ranges::find(family_names, std::get<std::string>(name));
    const auto family = static_cast<ErrorFamily>(at - family_names.begin());
    if (std::ranges::find(error.families, family) == error.families.end()) {
      error.families.push_back(family);
    }
  }
  if (error.families.empty()) {
    config.fail("error.families", "must name a family");
  }
  const auto measures = [&](ErrorFamily family) {
    return std::ranges::find(error.families, family) != error.families.end();
  };
  if (measures(ErrorFamily::rendering)) {
    error.rendering = read_rendering_error(config, error.frame);
  } else {
    config.mark_unused_reason("error.rendering", "error.families does not name \"rendering\"",
                              "error.families");
  }
  error.machine = keys::read_machine(config);
  error.scenes = keys::study_scenes(config, "error.scenes");
  error.sides = keys::ascending<std::uint32_t>(config, "error.sides");
  if (error.sides.empty()) {
    config.fail("error.sides", "must name a side");
  }
  error.nodes = keys::ascending<std::uint32_t>(config, "error.nodes");
  if (error.nodes.empty() || error.nodes.front() != 1) {
    config.fail("error.nodes", "must hold 1, against which speed-up is measured");
  }
  error.caches = keys::ascending<std::uint64_t>(config, "error.cache_sizes");
  if (error.caches.empty()) {
    config.fail("error.cache_sizes", "must name a size");
  }
  error.repeats = keys::count(config, "error.repeats");
  error.seed = static_cast<std::uint64_t>(config.integer("error.seed"));
  config.refuse_unused();
  if (measures(ErrorFamily::simulator)) {
    check_machines(config, error);
    check_scenes(config, error);
  }
  return error;
}

}  // namespace marti::studies::error
