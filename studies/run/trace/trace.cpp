#include "studies/run/trace/trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "processors/machine/combinations.h"
#include "processors/passes/reference_trace.h"
#include "processors/replay/replay.h"
#include "sim/error.h"
#include "sim/parse_number.h"
#include "sim/pending_file.h"
#include "sim/sha256.h"
#include "sim/shown.h"
#include "sim/units.h"
#include "studies/host/signals_held.h"
#include "studies/keys/machine_keys.h"
#include "studies/keys/record_keys.h"
#include "studies/run/functional_run.h"
#include "studies/run/record/text_stream.h"
#include "studies/run/run_result.h"
#include "studies/run/trace/node_list.h"
#include "studies/tables/file_set.h"
#include "studies/tables/result_directory.h"
#include "studies/version.h"

namespace marti::studies::run {

namespace {

using processors::machine::Feature;

void refuse_other_machines(const sim::Config& config, const processors::machine::MachineConfig& machine) {
  if (machine.scheme != processors::machine::Scheme::image) {
    config.fail("machine.scheme", "only nodes of the image scheme have references that a trace can hold");
  }
  for (const Feature feature : {Feature::contexts, Feature::prefetch, Feature::simt}) {
    if (processors::machine::has(machine, feature)) {
      config.fail(
          processors::machine::key_of(machine, feature),
          "a trace is in the order of the program, which is not that in which such a node refers to lines");
    }
  }
  if (machine.build.sharing != processors::machine::Sharing::given) {
    config.fail("build.sharing",
                "while the tree is built, other nodes decide what a node reads; a trace needs \"given\"");
  }
}

struct TooLong {};

struct Count {
  std::uint64_t reads = 0;
  std::uint64_t writes = 0;
  std::uint64_t bytes = 0;
};

// One node's file; `most_bytes` may still be written.
Count write_trace(const processors::passes::ReferenceTrace& trace, std::uint32_t node,
                  std::uint64_t most_bytes, TextStream& file) {
  Count count;
  std::array<char, 64> line{};
  trace.for_each(node, [&](const processors::passes::Reference& reference) {
    char* at = line.data();
    *at++ = reference.write ? '1' : '0';
    *at++ = ' ';
    at = std::to_chars(at, line.data() + 20, reference.address, 16).ptr;
    *at++ = ' ';
    const std::string_view kind = memory::record_kind_names[static_cast<std::size_t>(reference.kind)];
    at = std::ranges::copy(kind, at).out;
    *at++ = '\n';
    const auto length = static_cast<std::size_t>(at - line.data());
    ++(reference.write ? count.writes : count.reads);
    count.bytes += length;
    if (count.bytes > most_bytes) {
      throw TooLong();
    }
    file.write({line.data(), length});
  });
  file.close();
  return count;
}

std::string describe(const std::filesystem::path& file, const Count& count) {
  return fmt::format("wrote {}: {} reads, {} writes, {:.1f} MiB\n", file.string(), count.reads, count.writes,
                     static_cast<double>(count.bytes) / (1024.0 * 1024.0));
}

std::string file_name(std::uint32_t node) { return fmt::format("node-{:05}.din", node); }

// Whether a file has the name of a trace of some node.
bool is_trace(const std::string& name) {
  const std::string_view stem = std::string_view(name).substr(0, name.rfind('.'));
  const auto node = sim::parse_number<std::uint32_t>(stem.substr(std::min(stem.find('-') + 1, stem.size())));
  return node && name == file_name(*node);
}

// A trace that no trace.json names may be the user's, or of any machine.
void refuse_foreign_traces(const std::filesystem::path& directory, const tables::FileSet& earlier) {
  std::error_code error;
  for (std::filesystem::directory_iterator entry(directory, error);
       !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (is_trace(name) && !tables::is_as_written(earlier, directory, name)) {
      throw sim::UserError(sim::shown(entry->path().string()) + ": is no file that " + tables::trace_name +
                           " there says `marti trace` has written; give another directory, or move it away");
    }
  }
}

// What makes two traces those of one machine on one frame.
std::string machine_of(const sim::Config& config, const FunctionalRun& functional) {
  nlohmann::ordered_json settings = nlohmann::ordered_json::object();
  for (const sim::EffectiveValue& value : config.effective_values()) {
    if (!value.key.starts_with("host_machine.")) {
      settings[value.key] = value.value;
    }
  }
  const nlohmann::ordered_json json = {{"command", "marti trace"},
                                       {"version", version},
                                       {"scene", sim::shown(functional.scene.name)},
                                       {"image_hash", fmt::format("{:016x}", functional.image_hash)},
                                       {"hit_hash", fmt::format("{:016x}", functional.frame.hit_hash)},
                                       {"settings", settings}};
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace

std::string write_traces(sim::Config& config, const TraceOptions& options,
                         const std::filesystem::path& directory) {
  const keys::FrameConfig frame = keys::read_frame(config);
  refuse_several_frames(config, frame.frames);
  const processors::machine::MachineConfig machine = keys::read_machine(config);
  (void)keys::read_record(config,
                          true);  // reads the keys, so that what `marti run` would record is no error here
  config.refuse_unused();
  refuse_beyond_memory(config, frame, machine);
  refuse_other_machines(config, machine);
  const std::vector<std::uint32_t> nodes = parse_nodes(options.nodes, machine.all_nodes());
  tables::refuse_other_results(directory, tables::trace_name);
  const tables::FileSet earlier = tables::read_file_set(directory / tables::trace_name);
  refuse_foreign_traces(directory, earlier);
  const FunctionalRun functional = run_functional(frame);
  processors::passes::ReferenceTrace trace;
  processors::replay::ReplayOptions watched;
  watched.observer = &trace;
  (void)processors::replay::replay(*functional.frame.log, machine, watched);

  std::string text;
  std::uint64_t left = options.most_bytes;
  std::vector<std::unique_ptr<TextStream>> files;
  for (const std::uint32_t node : nodes) {
    const std::filesystem::path file = directory / file_name(node);
    files.push_back(std::make_unique<TextStream>(file));
    try {
      const Count count = write_trace(trace, node, left, *files.back());
      left -= count.bytes;
      text += describe(file, count);
    } catch (const TooLong&) {
      throw sim::UserError("the traces take more than --limit = " +
                           sim::print_size(static_cast<std::int64_t>(options.most_bytes)) +
                           "; choose fewer nodes with --nodes, or raise it");
    }
  }
  tables::FileSet now{machine_of(config, functional), {}};
  for (const auto& [name, hash] : earlier.files) {
    if (earlier.of == now.of && tables::is_there(directory / name)) {
      now.files[name] = hash;
    }
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    now.files[file_name(nodes[i])] = sim::sha256_of_file(files[i]->temporary());
  }
  const host::SignalsHeld held;
  sim::PendingFile named(directory / tables::trace_name);
  named.write(tables::text_of(now));
  for (const std::unique_ptr<TextStream>& file : files) {
    file->commit();
  }
  named.commit();
  tables::remove_others(earlier, now, directory);
  return text + "wrote " + (directory / tables::trace_name).string() + "\n";
}

}  // namespace marti::studies::run
