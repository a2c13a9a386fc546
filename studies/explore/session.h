// One configuration, explored: its frame is rendered once, and machines with other settings are timed on its
// work log.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/config.h"
#include "sim/schema.h"
#include "sim/work_meter.h"
#include "studies/explore/explored_machines.h"
#include "studies/run/run_result.h"

namespace marti::studies::explore {

/// Whether the key describes the machine. Keys of the frame, of the computer and of what is recorded do not:
/// the frame is rendered only once.
[[nodiscard]] bool is_control(const sim::Key& key);

class Session {
 public:
  /// Reads the configuration, renders its frame and times its machine. Throws UserError for anything that is
  /// wrong with them.
  /// `meter` is told how far this is; null: nobody waits.
  Session(const std::filesystem::path& file, std::vector<std::string> assignments,
          sim::WorkMeter* meter = nullptr);

  /// As JSON: the controls with section, type, range, choices and meaning, the value that each key has in the
  /// configuration, and what else of the configuration a copy of it must have.
  [[nodiscard]] const std::string& keys() const { return keys_; }

  /// The page, which asks for all that follows.
  [[nodiscard]] const std::string& page() const { return page_; }

  /// The result of the machine with these settings, as `marti run --json` prints it with them behind the
  /// session's own; {"error": message, "key": name or null} when the machine is refused. `meter` is
  /// told how far it is; after its stop() this throws sim::Stopped. Several threads may call it.
  [[nodiscard]] std::string answer(const Settings& settings, helps::Measuring what_helps,
                                   sim::WorkMeter* meter = nullptr) const;

  /// answer() as "result", and as "page" what the report of this machine shows (report::page_parts); without
  /// charts where the program has no scripts that draw them.
  [[nodiscard]] std::string shown(const Settings& settings, helps::Measuring what_helps,
                                  sim::WorkMeter* meter = nullptr) const;

  /// The machine's frame time by a model, in a fraction of the time that answer() takes: {"end",
  /// "end_of_one"} in ps, and how many "packets" it was made of, "of_packets"; null for a machine that the
  /// model does not describe; else as answer().
  [[nodiscard]] std::string modelled(const Settings& settings) const;

  /// The page of `marti report` for the machine with these settings, with a table of all machines that were
  /// simulated; std::nullopt, and `refused` as answer() says it, when the machine is refused.
  [[nodiscard]] std::optional<std::string> report(const Settings& settings, std::string& refused,
                                                  sim::WorkMeter* meter = nullptr) const;

 private:
  // What `make` returns, or what is wrong as answer() says it.
  template <class Make>
  [[nodiscard]] std::string refused_or(const Make& make) const;
  // The configuration with these settings. Throws UserError for a key that a machine lacks.
  [[nodiscard]] sim::Config config_with(const Settings& settings) const;
  [[nodiscard]] std::string timed(const Settings& settings, helps::Measuring what_helps,
                                  sim::WorkMeter* meter) const;

  std::string name_;
  std::string text_;  // of the file
  std::vector<std::string> assignments_;
  sim::Schema schema_;
  run::FunctionalRun functional_;
  mutable run::KeptStrippedLogs stripped_logs_;  // guards itself
  mutable ExploredMachines explored_;            // guards itself
  std::string keys_;
  std::string page_;
};

}  // namespace marti::studies::explore
