// The figures of a result.json.
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "sim/error.h"
#include "studies/compare/figures.h"
#include "studies/tables/json_table.h"
#include "studies/tables/run_json.h"

namespace marti::studies {

namespace {

using Json = nlohmann::ordered_json;

// Fields that repeat the sums beside them, those that are of other machines, and the old rule of thumb of
// results of schema 1.
bool is_left_out(const std::string& path) {
  for (const std::string_view prefix :
       {"machine.per_node[].steps", "machine.per_node[].time_ps", "machine.per_node[].hits",
        "machine.per_node[].misses", "machine.build.per_node", "machine.flow.per_node",
        "machine.contexts.per_node", "machine.l2.per_cache[].hits", "machine.l2.per_cache[].misses",
        "machine.limit", "machine.what_helps"}) {
    if (path.starts_with(prefix)) {
      return true;
    }
  }
  return false;
}

bool is_peak(std::string_view path) {
  const std::string_view leaf = path.substr(path.rfind('.') + 1);
  return leaf.starts_with("max") || leaf.starts_with("most") || leaf.starts_with("longest") ||
         leaf.find("_max") != std::string_view::npos;
}

class Flattener {
 public:
  Flattener(const std::string& file, Figures& figures) : file_(file), figures_(figures) {}

  void add(const Json& value, const std::string& path, bool in_list) {
    if (is_left_out(path) || value.is_null()) {
      return;
    }
    if (value.is_object()) {
      for (const auto& [key, part] : value.items()) {
        add(part, path.empty() ? key : path + "." + key, in_list);
      }
    } else if (value.is_array()) {
      add_list(value, path, in_list);
    } else if (in_list) {
      add_to_sum(value, path);
    } else {
      figures_[path] = cell_of(value);
    }
  }

 private:
  void add_list(const Json& list, const std::string& path, bool in_list) {
    std::size_t index = 0;
    for (const Json& element : list) {
      if (element.is_object()) {
        const auto name = element.find("name");
        const bool named = !in_list && name != element.end() && name->is_string();
        add(element, path + "[" + (named ? name->get<std::string>() : "") + "]", in_list || !named);
      } else if (!element.is_array() && !in_list) {
        add(element, path + "[" + std::to_string(index) + "]", false);
      }
      ++index;
    }
  }

  // Of the objects of a list: counters only. Means and shares have no sum.
  void add_to_sum(const Json& value, const std::string& path) {
    const Cell cell = cell_of(value);
    const auto* number = std::get_if<std::int64_t>(&cell);
    if (number == nullptr) {
      return;
    }
    auto* sum = std::get_if<std::int64_t>(&figures_.try_emplace(path, std::int64_t{0}).first->second);
    if (sum == nullptr) {
      throw sim::UserError(file_ + ": " + path + ": is there twice");
    }
    if (is_peak(path)) {
      *sum = std::max(*sum, *number);
    } else if (__builtin_add_overflow(*sum, *number, sum)) {
      throw sim::UserError(file_ + ": " + path + ": its sum does not fit in 64 bits");
    }
  }

  const std::string& file_;
  Figures& figures_;
};

std::map<std::string, std::string> settings_of(const RunJson& run) {
  std::map<std::string, std::string> settings;
  for (const auto& [key, setting] : run.at("config.keys").items()) {
    const auto value = setting.is_object() ? setting.find("value") : setting.end();
    if (value == setting.end() || !value->is_string()) {
      run.refuse("config.keys." + key + " has no text \"value\"");
    }
    settings[key] = value->get<std::string>();
  }
  return settings;
}

struct Renamed {
  std::string_view from;  // beginning of a run's name
  std::string_view to;    // of a sweep's
};

// The first that fits counts.
constexpr Renamed renamed[] = {
    {"machine.frame_time_ps", "end_ps"},
    {"machine.time_ps.", "time_"},
    {"machine.steps.", "steps_"},
    {"machine.host.", "host_"},
    {"machine.per_node[].", "node_"},
    {"machine.per_cluster[].interconnect.waits.", "interconnect_wait_"},
    {"machine.per_cluster[].interconnect.", "interconnect_"},
    {"machine.per_cluster[].banks[].waits.", "bank_wait_"},
    {"machine.per_cluster[].banks[].", "bank_"},
    {"machine.per_cluster[].distributed.network.waits.", "network_wait_"},
    {"machine.per_cluster[].distributed.network.", "network_"},
    {"machine.per_cluster[].distributed.", "distributed_"},
    {"machine.flow.networks[].waits.", "network_wait_"},
    {"machine.flow.networks[].", "network_"},
    {"machine.flow.counts.", "flow_"},
    {"machine.flow.regions", "regions"},
    {"machine.flow.top_nodes", "top_nodes"},
    {"machine.flow.duplicated_primitives", "duplicated_primitives"},
    {"machine.flow.sampling_work_ps", "sampling_work_ps"},
    {"machine.build.counts.", "build_"},
    {"machine.build.all_levels.", "tree_"},
    {"machine.build.", "build_"},
    {"machine.l2.per_cache[].", "l2_"},
    {"machine.l2.", "l2_"},
    {"machine.contexts.counts.", "contexts_"},
    {"machine.counts.miss_classes.all.", "all_misses_"},
    {"machine.counts.sharing.", "sharing_"},
    {"machine.nodes", ""},  // of one cluster in a run, of all clusters in a sweep
    {"machine.clusters", "clusters"},
    {"machine.", ""},
    {"image.image_hash", "frame.image_hash"},
    {"image.hit_hash", "frame.hit_hash"},
    {"image.width", "frame.width"},
    {"image.height", "frame.height"},
    {"scene.name", "frame.scene"},
    {"scene.", "frame."},
    {"structure.", "frame.structure_"},
    {"work_log.", "frame.log_"},
};

// "machine.references.node.hits": "node_hits", and the like. Empty for any other name.
std::string name_of_kind(std::string_view name) {
  constexpr Renamed kinds[] = {{"machine.references.", "_"},
                               {"machine.counts.miss_classes.", "_misses_"},
                               {"image.rays.", "_rays"},
                               {"image.hits.", "_hits"}};
  for (const auto& [prefix, joint] : kinds) {
    if (!name.starts_with(prefix) || name.starts_with("machine.counts.miss_classes.all.")) {
      continue;
    }
    const std::string_view rest = name.substr(prefix.size());
    const std::size_t dot = rest.find('.');
    const std::string kind(rest.substr(0, dot));
    if (dot == std::string_view::npos) {
      return "frame." + kind + std::string(joint);
    }
    return kind + std::string(joint) + std::string(rest.substr(dot + 1));
  }
  return {};
}

std::string renamed_as_in_sweep(std::string_view name) {
  if (std::string kind = name_of_kind(name); !kind.empty()) {
    return kind;
  }
  for (const auto& [from, to] : renamed) {
    if (name.starts_with(from)) {
      return from == "machine.nodes" ? "" : std::string(to) + std::string(name.substr(from.size()));
    }
  }
  return {};
}

}  // namespace

ComparedResult read_run(const std::filesystem::path& path, const std::string& name) {
  const RunJson run = read_run_json(path);
  ComparedResult result;
  result.name = name;
  const Json& version = run.find("marti.version");
  result.version = version.is_string() ? version.get<std::string>() : "unknown";
  result.settings = settings_of(run);
  Flattener flattener(run.file(), result.figures);
  (void)run.at("machine");
  for (const auto& [key, value] : run.json().items()) {
    if (key != "marti" && key != "config" && key != "files") {
      flattener.add(value, key, false);
    }
  }
  return result;
}

Figures named_as_in_sweep(const Figures& run) {
  Figures figures;
  for (const auto& [name, value] : run) {
    if (const std::string other = renamed_as_in_sweep(name); !other.empty()) {
      figures.emplace(other, value);
    }
  }
  return figures;
}

}  // namespace marti::studies
