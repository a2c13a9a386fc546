#include "studies/keys/logged_frame.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "sim/error.h"
#include "sim/input_files.h"
#include "sim/key_error.h"
#include "sim/shown.h"
#include "studies/keys/frame_keys.h"

namespace marti::studies::keys {

namespace {

constexpr std::string_view log_key = "scene.log";

/// Why each use but the first needs more than a log, in the order of FrameUse.
constexpr std::array<std::string_view, 7> needs_scene = {
    "",
    "counts operations while it traces the scene",
    "builds other structures of several scenes, and traces them",
    "moves the scene's parts and builds its structure again, frame by frame",
    "builds other structures of the scene, and traces them",
    "compares images and structures, for which it traces the scene again",
    "moves the scene to where numbers end, and compares images",
};

/// A log that was opened, with the values of its settings.
struct OpenedLog {
  std::shared_ptr<const LoggedFrame> frame;
  std::vector<std::pair<std::string, std::vector<sim::Value>>> settings;
};

std::vector<std::pair<std::string, std::vector<sim::Value>>> values_of(const sim::Schema& schema,
                                                                       const LoggedFrame& log) {
  std::string text;
  for (const log_file::LogHead::Setting& setting : log.head.settings) {
    text += setting.key + " = " + setting.value + "\n";
  }
  const sim::Config given = sim::Config::from_text(schema, text, sim::shown(log.file.string()));
  std::vector<std::pair<std::string, std::vector<sim::Value>>> values;
  for (std::size_t key = 0; key < schema.keys().size(); ++key) {
    if (given.given_at(key)) {
      const std::string& name = schema.keys()[key].name;
      if (!is_kept_in_log(name)) {
        throw sim::UserError(sim::shown(log.file.string()) +
                             ": is no work log that this program can read: it says " + sim::shown(name));
      }
      const std::span<const sim::Value> of_key = given.values_at(key);
      values.emplace_back(name, std::vector<sim::Value>(of_key.begin(), of_key.end()));
    }
  }
  return values;
}

OpenedLog open_log(const sim::Schema& schema, const std::filesystem::path& file,
                   const sim::MemoryBudget& memory) {
  log_file::PackedReader reader(file);
  reader.limit(memory);
  auto frame = std::make_shared<LoggedFrame>();
  frame->file = file;
  frame->id = reader.id();
  log_file::Fields<log_file::PackedReader> fields(reader);
  log_file::describe(fields, frame->head);
  sim::note_input(file);
  return {frame, values_of(schema, *frame)};
}

/// Logs that were opened: a sweep reads the keys of each of its points.
class OpenedLogs {
 public:
  OpenedLog open(const sim::Schema& schema, const std::filesystem::path& file,
                 const sim::MemoryBudget& memory) {
    struct stat now {};
    if (::stat(file.c_str(), &now) != 0) {
      return open_log(schema, file, memory);  // which says why it cannot
    }
    const Version version(now.st_ino, now.st_size, now.st_mtim.tv_sec, now.st_mtim.tv_nsec);
    const std::lock_guard lock(mutex_);
    auto& [known, log] = logs_[file.string()];
    if (log.frame == nullptr || known != version) {
      log = open_log(schema, file, memory);
      known = version;
    }
    return log;
  }

 private:
  using Version = std::tuple<ino_t, off_t, time_t, std::int64_t>;

  std::mutex mutex_;
  std::map<std::string, std::pair<Version, OpenedLog>> logs_;
};

std::string name_of(const LoggedFrame& log) { return "the log " + sim::shown(log.file.string()); }

void take_settings(sim::Config& config, const OpenedLog& log) {
  const sim::Schema& schema = config.schema();
  const std::string of_log = name_of(*log.frame);
  // A log that the command names takes the place of the scene that the file describes.
  const bool in_place = config.assigned(log_key);
  for (const auto& [name, values] : log.settings) {
    const std::size_t index = *schema.find(name);
    const sim::Key& key = schema.keys()[index];
    if (!config.given(key.name) || (in_place && !config.assigned(key.name))) {
      config.set({index, values, 0, of_log + ": " + name + " = " + print_values(key, values)});
    } else if (!std::ranges::equal(config.values_at(index), values)) {
      config.fail(name, of_log + " was made with " + print_values(key, values) +
                            "; leave the key out, or take scene.source in the place of scene.log");
    }
  }
}

}  // namespace

bool is_kept_in_log(std::string_view key) {
  // The exact image beside that of a voxel cut is an image, and frames are those of a log each.
  constexpr std::array<std::string_view, 3> not_kept = {log_key, "image.voxel_cut_reference",
                                                        "frames.verify"};
  constexpr std::array<std::string_view, 4> sections = {"scene.", "frames.", "image.", "structure."};
  return std::ranges::find(not_kept, key) == not_kept.end() &&
         std::ranges::any_of(sections, [&](std::string_view section) { return key.starts_with(section); });
}

std::shared_ptr<const LoggedFrame> read_log(sim::Config& config, FrameUse use) {
  static OpenedLogs opened;
  if (!config.given(log_key) || config.text(log_key).empty()) {
    return nullptr;
  }
  if (use != FrameUse::timing) {
    config.fail(log_key, "this study " + std::string(needs_scene[static_cast<std::size_t>(use)]) +
                             "; a log serves to time machines. Take scene.source in its place");
  }
  OpenedLog log;
  try {
    log = opened.open(config.schema(), directory_of(config, log_key) / config.text(log_key),
                      read_memory(config));
  } catch (const sim::KeyError& error) {
    config.fail(error.key(), error.reason());
  } catch (const sim::UserError& error) {
    config.fail(log_key, error.what());
  }
  take_settings(config, log);
  return log.frame;
}

void check_recorded(const sim::Config& config, const LoggedFrame& log,
                    processors::program::RenderOptions& render) {
  const log_file::LogHead& head = log.head;
  const auto refuse = [&](const std::string& lack) {
    config.fail(log_key,
                name_of(log) + " " + lack +
                    "; write it again with the node.kind, rt.order, rt.sort, rt.share and layout.treelet "
                    "that these machines have");
  };
  const auto order = [](accel::WalkOrder of) {
    return std::string(accel::walk_order_names[static_cast<std::size_t>(of)]);
  };
  if (render.order != head.order) {
    refuse("has rays that take nodes in the order \"" + order(head.order) + "\", not in \"" +
           order(render.order) + "\"");
  }
  if (render.treelet_records != head.treelet_records) {
    refuse("has rays that go through treelets of " + std::to_string(head.treelet_records) +
           " records, not of " + std::to_string(render.treelet_records));
  }
  // Only these walks record it (RenderOptions::entered).
  const bool entered = render.entered && render.order == accel::WalkOrder::depth_first && !render.mailboxes;
  if (entered && !head.entered) {
    refuse("was written for nodes without stacks, and lacks which children a ray enters");
  }
  if (render.ray_words && !head.ray_words) {
    refuse("was written for nodes that do not sort rays, and lacks by what they are sorted");
  }
  if (render.meets && !render.mailboxes && !head.meets) {
    refuse("was written for nodes whose lanes do not help each other, and lacks what each ray meets");
  }
  render.entered = head.entered;
  render.meets = head.meets;
  render.ray_words = head.ray_words;
}

}  // namespace marti::studies::keys
