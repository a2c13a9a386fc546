#include "studies/sweep/plan/read_point.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "studies/keys/machine_keys.h"
#include "studies/run/run_result.h"
#include "studies/sweep/plan/digest.h"

namespace marti::studies::sweep {

namespace {

constexpr std::array<std::string_view, 2> single = {"machine.clusters", "machine.nodes"};
constexpr std::string_view interval_key = "record.interval";
constexpr std::array<std::string_view, 4> counting_keys = {"count.miss_classes", "count.sharing",
                                                           "count.attribution", interval_key};

std::vector<bool> keys_read(const sim::Config& config) {
  std::vector<bool> used(config.schema().keys().size());
  for (std::size_t key = 0; key < used.size(); ++key) {
    used[key] = config.used_at(key);
  }
  return used;
}

void add(Digest& digest, const std::string& key, const std::string& value) {
  digest.add(key);
  digest.add("=");
  digest.add(value);
  digest.add("\n");
}

bool is_host(const std::string& key) { return key.starts_with("host_machine."); }

sim::EffectiveValue effective(const sim::Config& config, std::size_t key) {
  const sim::Key& declared = config.schema().keys()[key];
  return {declared.name, print_values(declared, config.values_at(key)), config.given_at(key),
          config.where(declared.name)};
}

// Adds what a setting says about times and counts: nothing if it is about energy. An interconnect's width
// decides how many beats its transfers take. Where these are whole lines and pixels, machines with equal
// beats take equal times. A SIMT node's writes have several pixels.
void add_timing(Digest& digest, const sim::EffectiveValue& setting,
                const processors::machine::MachineConfig& machine) {
  using namespace processors::machine;
  if (setting.key.starts_with("energy.")) {
    return;
  }
  if (setting.key == "interconnect.width" && machine.cache.organisation != CacheOrganisation::none &&
      machine.build.sharing == Sharing::given && machine.kind == NodeKind::core) {
    const auto beats = [&](std::uint32_t bytes) { return std::to_string(machine.interconnect.beats(bytes)); };
    add(digest, "beats", beats(machine.cache.cache.line) + " " + beats(machine.layout.pixel_bytes));
  } else {
    add(digest, setting.key, setting.value);
  }
}

void set(sim::Config& config, std::string_view key, sim::Value value) {
  config.set({*config.schema().find(key), {std::move(value)}, 0, "the machine of one node"});
}

}  // namespace

ReadPoint read_point(sim::Config config) {
  ReadPoint point{std::move(config), {}, {}, {}, {}, 0, {}, {}, {}};
  const std::vector<sim::Key>::size_type keys = point.config.schema().keys().size();
  point.frame = keys::read_frame(point.config);
  run::refuse_several_frames(point.config, point.frame.frames);
  point.frame_keys = keys_read(point.config);
  point.machine = keys::read_machine(point.config);
  run::refuse_beyond_memory(point.config, point.frame, point.machine);
  // Machines without intervals are the same whether or not there are any in their sweep.
  const std::size_t of_interval = *point.config.schema().find(interval_key);
  if (std::get<sim::Ticks>(point.config.values_at(of_interval)[0]) > 0) {
    point.interval = point.config.duration(interval_key);
  }

  Digest frame;
  Digest machine;
  Digest timing;
  const std::vector<bool> used = keys_read(point.config);
  point.settings.reserve(
      static_cast<std::size_t>(std::ranges::count(used, true) - std::ranges::count(point.frame_keys, true)));
  for (std::size_t key = 0; key < keys; ++key) {
    const sim::Key& declared = point.config.schema().keys()[key];
    if (point.frame_keys[key]) {
      if (!is_host(declared.name)) {
        add(frame, declared.name, print_values(declared, point.config.values_at(key)));
      }
    } else if (point.config.used_at(key)) {
      point.settings.push_back(effective(point.config, key));
      add(machine, declared.name, point.settings.back().value);
      add_timing(timing, point.settings.back(), point.machine);
    }
  }
  point.frame_digest = frame.hex();
  point.machine_digest = machine.hex();
  // What an interval's energy is, is not kept beside what it counts.
  point.timing_digest = point.interval > 0 ? point.machine_digest : timing.hex();
  return point;
}

std::vector<sim::EffectiveValue> frame_settings(const ReadPoint& point) {
  std::vector<sim::EffectiveValue> settings;
  for (std::size_t key = 0; key < point.frame_keys.size(); ++key) {
    if (point.frame_keys[key] && !is_host(point.config.schema().names()[key])) {
      settings.push_back(effective(point.config, key));
    }
  }
  return settings;
}

sim::Config one_node_config(const ReadPoint& point) {
  sim::Config one = point.config.with({});
  for (std::size_t key = 0; key < point.frame_keys.size(); ++key) {
    if (one.given_at(key) && !point.config.used_at(key)) {
      one.reset(key);
    }
  }
  for (const std::string_view key : single) {
    set(one, key, std::int64_t{1});
  }
  for (const std::string_view key : counting_keys) {
    one.reset(*one.schema().find(key));
  }
  if (point.machine.scheme == processors::machine::Scheme::pipeline) {
    set(one, "machine.scheme", std::string("image"));
    set(one, "node.pixels", std::string("collected"));
    set(one, "host.assignment", std::string("blocks"));
  }
  return one;
}

bool is_set_for_one_node(std::string_view key) {
  return std::ranges::find(single, key) != single.end() ||
         std::ranges::find(counting_keys, key) != counting_keys.end();
}

}  // namespace marti::studies::sweep
