#include "studies/run/trace/trace.h"

#include <fmt/format.h>

#include <algorithm>
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

#include "processors/machine/combinations.h"
#include "processors/passes/reference_trace.h"
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

using processors::machine::Feature;
using processors::machine::MachineConfig;

// The format of references, and the ending of its files.
constexpr std::string_view references = "din";

void refuse_other_machines(const sim::Config& config, const MachineConfig& machine) {
  if (machine.scheme != processors::machine::Scheme::image) {
    config.fail(
        "machine.scheme",
        "only nodes of the image scheme have references that a trace can hold; --format csv and others hold "
        "what any node asks of the memory");
  }
  for (const Feature feature : {Feature::contexts, Feature::prefetch, Feature::simt}) {
    if (processors::machine::has(machine, feature)) {
      config.fail(processors::machine::key_of(machine, feature),
                  "a trace of references is in the order of the program, which is not that in which such a "
                  "node refers to "
                  "lines; --format csv and others hold what it asks of the memory");
    }
  }
  if (machine.build.sharing != processors::machine::Sharing::given) {
    config.fail("build.sharing",
                "while the tree is built, other nodes decide what a node reads; a trace needs \"given\"");
  }
}

struct TooLong {};

// A file that is being written, under a temporary name, and what it has so far.
struct TraceFile {
  explicit TraceFile(const std::filesystem::path& name) : file(name), stream(name) {}

  std::filesystem::path file;
  TextStream stream;
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

std::string file_name(std::string_view ending, std::uint32_t node) {
  return fmt::format("node-{:05}.{}", node, ending);
}

// What the nodes refer to, before their caches.
TraceFiles write_references(const processors::program::WorkLog& log, const MachineConfig& machine,
                            std::span<const std::uint32_t> nodes, const std::filesystem::path& directory,
                            std::uint64_t left) {
  processors::passes::ReferenceTrace trace;
  processors::replay::ReplayOptions watched;
  watched.observer = &trace;
  (void)processors::replay::replay(log, machine, watched);
  TraceFiles files;
  for (const std::uint32_t node : nodes) {
    TraceFile& file =
        *files.emplace_back(std::make_unique<TraceFile>(directory / file_name(references, node)));
    std::string line;
    trace.for_each(node, [&](const processors::passes::Reference& reference) {
      line.clear();
      fmt::format_to(std::back_inserter(line), "{} {:x} {}\n", reference.write ? 1 : 0, reference.address,
                     memory::record_kind_names[static_cast<std::size_t>(reference.kind)]);
      ++(reference.write ? file.writes : file.reads);
      file.write(line, left);
    });
    file.stream.close();
  }
  return files;
}

// Writes what chosen nodes ask of the memory, while they do.
class RequestWriter final : public processors::walk::Observer {
 public:
  RequestWriter(const RequestFormat& format, const MachineConfig& machine,
                std::span<const std::uint32_t> nodes, const std::filesystem::path& directory,
                std::uint64_t left)
      : format_(format), machine_(machine), left_(left), file_of_(machine.all_nodes()) {
    for (const std::uint32_t node : nodes) {
      if (format.file_per_node || files_.empty()) {
        const std::string name =
            format.file_per_node ? file_name(format.file, node) : std::string(format.file);
        files_.push_back(std::make_unique<TraceFile>(directory / name));
        files_.back()->write(format.head(), left_);
      }
      file_of_[node] = files_.back().get();
    }
  }

  void begin(const processors::walk::ReplayInput& input) override {
    layout_.emplace(input.layout);
    append_ = format_.append(machine_, *layout_);
  }
  void spent(std::uint32_t /*node*/, processors::walk::NodeState /*state*/, sim::Ticks /*from*/,
             sim::Ticks /*to*/, processors::walk::PixelPlace /*pixel*/) override {}
  [[nodiscard]] bool hears_requests() const override { return true; }
  void requested(const processors::walk::Request& request) override {
    TraceFile* const file = file_of_[request.node];
    if (file == nullptr) {
      return;
    }
    ++(request.write ? file->writes : file->reads);
    text_.clear();
    append_(request, text_);
    file->write(text_, left_);
  }

  [[nodiscard]] TraceFiles finish() {
    for (const std::unique_ptr<TraceFile>& file : files_) {
      file->stream.close();
    }
    return std::move(files_);
  }

 private:
  const RequestFormat& format_;
  const MachineConfig& machine_;
  std::uint64_t left_;
  TraceFiles files_;
  std::vector<TraceFile*> file_of_;  // null: another node's
  std::optional<memory::Layout> layout_;
  AppendRequest append_;
  std::string text_;
};

// Null for the format of references.
const RequestFormat* format_named(std::string_view name) {
  const std::span<const RequestFormat> all = request_formats();
  const auto found = std::ranges::find(all, name, &RequestFormat::name);
  return found == all.end() ? nullptr : &*found;
}

void check_format(const RequestFormat& format, const MachineConfig& machine, std::size_t nodes) {
  (void)format.append(machine, memory::Layout(machine.layout, {}));
  constexpr std::size_t most_files = 512;
  if (format.file_per_node && nodes > most_files) {
    throw sim::UserError(
        fmt::format("--format {}: writes a file for each of {} nodes at the same time; choose "
                    "at most {} with --nodes",
                    format.name, nodes, most_files));
  }
}

// Whether a file has the name of a trace.
bool is_trace(const std::string& name) {
  const std::string_view stem = std::string_view(name).substr(0, name.rfind('.'));
  const auto node = sim::parse_number<std::uint32_t>(stem.substr(std::min(stem.find('-') + 1, stem.size())));
  return (node && name == file_name(references, *node)) ||
         std::ranges::any_of(request_formats(), [&](const RequestFormat& format) {
           return format.file_per_node ? node && name == file_name(format.file, *node) : name == format.file;
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
  std::vector<std::string> names = {std::string(references)};
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
  const RequestFormat* const format = format_named(options.format);
  if (format == nullptr) {
    refuse_other_machines(config, machine);
  } else {
    check_format(*format, machine, nodes.size());
  }
  tables::refuse_other_results(directory, tables::trace_name);
  const tables::FileSet earlier = tables::read_file_set(directory / tables::trace_name);
  refuse_foreign_traces(directory, earlier);
  const FunctionalRun functional = run_functional(frame);

  TraceFiles files;
  try {
    if (format == nullptr) {
      files = write_references(*functional.frame.log, machine, nodes, directory, options.most_bytes);
    } else {
      RequestWriter writer(*format, machine, nodes, directory, options.most_bytes);
      processors::replay::ReplayOptions watched;
      watched.observer = &writer;
      (void)processors::replay::replay(*functional.frame.log, machine, watched);
      files = writer.finish();
    }
  } catch (const TooLong&) {
    throw sim::UserError("the traces take more than --limit = " +
                         sim::print_size(static_cast<std::int64_t>(options.most_bytes)) +
                         "; choose fewer nodes with --nodes, or raise it");
  }
  tables::FileSet now{machine_of(config, functional), {}};
  for (const auto& [name, hash] : earlier.files) {
    if (earlier.of == now.of && tables::is_there(directory / name)) {
      now.files[name] = hash;
    }
  }
  std::string text;
  for (const std::unique_ptr<TraceFile>& file : files) {
    now.files[file->file.filename().string()] = sim::sha256_of_file(file->stream.temporary());
    text += fmt::format("wrote {}: {}, {}, {:.1f} MiB\n", file->file.string(),
                        tables::counted(file->reads, "read"), tables::counted(file->writes, "write"),
                        static_cast<double>(file->bytes) / (1024.0 * 1024.0));
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
