#include "studies/run/trace/trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "processors/replay/replay.h"
#include "processors/walk/observer.h"
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
#include "studies/run/trace/request_format.h"
#include "studies/tables/file_set.h"
#include "studies/tables/result_directory.h"
#include "studies/tables/text_units.h"
#include "studies/version.h"

namespace marti::studies::run {

namespace {

using processors::machine::MachineConfig;

struct TooLong {};

// A file that is being written, under a temporary name, and what it has so far.
struct TraceFile {
  explicit TraceFile(const std::filesystem::path& name) : file(name), stream(name) {}

  std::filesystem::path file;
  TextStream stream;
  std::vector<std::uint32_t> nodes;  // whose requests or references it has
  std::uint64_t reads = 0;
  std::uint64_t writes = 0;
  std::uint64_t bytes = 0;

  // `left` bytes may still be written to all files together.
  void write(std::string_view text, std::uint64_t& left) {
    if (text.size() > left) {
      throw TooLong();
    }
    left -= text.size();
    bytes += text.size();
    stream.write(text);
  }
};

using TraceFiles = std::vector<std::unique_ptr<TraceFile>>;

// The file that has a node's part of a trace.
std::string file_name(const RequestFormat& format, bool references, std::uint32_t node) {
  if (!references && !format.file_per_node) {
    return fmt::format("requests{}", format.ending);
  }
  return fmt::format("{}-{:05}{}", references && !format.only_references ? "references" : "node", node,
                     format.ending);
}

// Writes what chosen nodes ask of the memory, or refer to, while they do.
class TraceWriter final : public processors::walk::Observer {
 public:
  TraceWriter(const RequestFormat& format, bool references, const MachineConfig& machine,
              std::span<const std::uint32_t> nodes, const std::filesystem::path& directory,
              std::uint64_t left)
      : references_(references), left_(left), file_of_(machine.all_nodes()), append_(format.append(machine)) {
    for (const std::uint32_t node : nodes) {
      const std::filesystem::path name = directory / file_name(format, references, node);
      if (files_.empty() || files_.back()->file != name) {
        files_.push_back(std::make_unique<TraceFile>(name));
        files_.back()->write(format.head(references), left_);
      }
      files_.back()->nodes.push_back(node);
      file_of_[node] = files_.back().get();
    }
  }

  void begin(const processors::walk::ReplayInput& input) override { layout_.emplace(input.layout); }
  void spent(std::uint32_t /*node*/, processors::walk::NodeState /*state*/, sim::Ticks /*from*/,
             sim::Ticks /*to*/, processors::walk::PixelPlace /*pixel*/) override {}
  [[nodiscard]] bool hears_requests() const override { return true; }
  void requested(const processors::walk::Request& request) override {
    if (request.write || !references_) {
      write({request, layout_->kind_at(request.address), std::nullopt});
    }
  }
  [[nodiscard]] bool hears_references() const override { return references_; }
  void referred(const processors::walk::Request& reference, memory::RecordKind kind, bool hit) override {
    write({reference, kind, hit});
  }

  [[nodiscard]] TraceFiles finish() {
    for (const std::unique_ptr<TraceFile>& file : files_) {
      file->stream.close();
    }
    return std::move(files_);
  }

 private:
  void write(const TraceEntry& entry) {
    TraceFile* const file = file_of_[entry.node];
    if (file == nullptr) {
      return;
    }
    ++(entry.write ? file->writes : file->reads);
    text_.clear();
    append_(entry, text_);
    file->write(text_, left_);
  }

  bool references_;
  std::uint64_t left_;
  TraceFiles files_;
  std::vector<TraceFile*> file_of_;  // null: another node's
  std::optional<memory::Layout> layout_;
  AppendEntry append_;
  std::string text_;
};

const RequestFormat& format_named(std::string_view name) {
  const std::span<const RequestFormat> all = request_formats();
  const auto found = std::ranges::find(all, name, &RequestFormat::name);
  sim::ensure(found != all.end(), "a trace of an unknown format");
  return *found;
}

void check_format(const RequestFormat& format, bool references, const MachineConfig& machine,
                  std::size_t nodes) {
  (void)format.append(machine);
  constexpr std::size_t most_files = 512;
  if ((references || format.file_per_node) && nodes > most_files) {
    throw sim::UserError(
        fmt::format("--format {}: writes a file for each of {} nodes at the same time; choose "
                    "at most {} with --nodes",
                    format.name, nodes, most_files));
  }
}

// Whether a file has the name of a trace.
bool is_trace(const std::string& name) {
  const std::string_view rest = std::string_view(name).substr(std::min(name.find('-') + 1, name.size()));
  const auto node = sim::parse_number<std::uint32_t>(rest.substr(0, 5));
  return std::ranges::any_of(request_formats(), [&](const RequestFormat& format) {
    return std::ranges::any_of(std::array{false, true}, [&](bool references) {
      return (node || (!references && !format.file_per_node)) &&
             name == file_name(format, references, node.value_or(0));
    });
  });
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

std::vector<std::string> trace_formats() {
  std::vector<std::string> names;
  for (const RequestFormat& format : request_formats()) {
    names.emplace_back(format.name);
  }
  return names;
}

std::string write_traces(sim::Config& config, const TraceOptions& options,
                         const std::filesystem::path& directory) {
  const keys::FrameConfig frame = keys::read_frame(config);
  refuse_several_frames(config, frame.frames);
  const MachineConfig machine = keys::read_machine(config);
  (void)keys::read_record(config,
                          true);  // reads the keys, so that what `marti run` would record is no error here
  config.refuse_unused();
  refuse_beyond_memory(config, frame, machine);
  const std::vector<std::uint32_t> nodes = parse_nodes(options.nodes, machine.all_nodes());
  const RequestFormat& format = format_named(options.format);
  const bool references = options.references || format.only_references;
  check_format(format, references, machine, nodes.size());
  tables::refuse_other_results(directory, tables::trace_name);
  const tables::FileSet earlier = tables::read_file_set(directory / tables::trace_name);
  refuse_foreign_traces(directory, earlier);
  const FunctionalRun functional = run_functional(frame);

  TraceFiles files;
  try {
    TraceWriter writer(format, references, machine, nodes, directory, options.most_bytes);
    processors::replay::ReplayOptions watched;
    watched.observer = &writer;
    (void)processors::replay::replay(*functional.frame.log, machine, watched);
    files = writer.finish();
  } catch (const TooLong&) {
    throw sim::UserError("the traces take more than --limit = " +
                         sim::print_size(static_cast<std::int64_t>(options.most_bytes)) +
                         "; choose fewer nodes with --nodes, or raise it");
  }
  tables::FileSet now{machine_of(config, functional), {}};
  for (const auto& [name, hash] : earlier.files) {
    if (earlier.of == now.of && tables::is_there(directory / name)) {
      now.files[name] = hash;
      if (const auto note = earlier.notes.find(name); note != earlier.notes.end()) {
        now.notes[name] = note->second;
      }
    }
  }
  std::string text;
  for (const std::unique_ptr<TraceFile>& file : files) {
    const std::string name = file->file.filename().string();
    now.files[name] = sim::sha256_of_file(file->stream.temporary());
    now.notes[name] = "nodes " + text_of_nodes(file->nodes);
    text +=
        fmt::format("wrote {}: {}, {}, {}\n", file->file.string(), tables::counted(file->reads, "read"),
                    tables::counted(file->writes, "write"), tables::bytes(static_cast<double>(file->bytes)));
  }
  const host::SignalsHeld held;
  sim::PendingFile named(directory / tables::trace_name);
  named.write(tables::text_of(now));
  for (const std::unique_ptr<TraceFile>& file : files) {
    file->stream.commit();
  }
  named.commit();
  tables::remove_others(earlier, now, directory);
  return text + "wrote " + (directory / tables::trace_name).string() + "\n";
}

}  // namespace marti::studies::run
