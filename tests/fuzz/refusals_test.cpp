// Wrong configurations, made at random from the schemas: each refusal says where and why.
#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "refusal.h"
#include "sim/config.h"
#include "sim/error.h"
#include "sim/units.h"
#include "studies/error/error_keys.h"
#include "studies/frames/frames_config.h"
#include "studies/keys/frame_keys.h"
#include "studies/keys/machine_keys.h"
#include "studies/keys/record_keys.h"
#include "studies/paper/paper_keys.h"
#include "studies/run/run_result.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "studies/sweep/plan/sweep_plan.h"
#include "tests/support/files.h"
#include "tests/support/wrong_configurations.h"

namespace marti::fuzz {
namespace {

namespace fs = std::filesystem;
using sim::Config;
using sim::Key;
using sim::Schema;
using sim::ValueType;

using Random = std::mt19937;

template <class T>
const T& one_of(const std::vector<T>& items, Random& random) {
  return items[random() % items.size()];
}

// A command: its keys, how it reads a configuration, and one of its files.
struct Command {
  Schema schema;
  std::function<void(Config&)> read;
  std::string file;
};

void read_machine_of_run(Config& config) {
  const studies::keys::FrameConfig frame = studies::keys::read_frame(config);
  const processors::machine::MachineConfig machine = studies::keys::read_machine(config);
  (void)studies::keys::read_record(config, false);
  config.refuse_unused();
  studies::run::refuse_beyond_memory(config, frame, machine);
}

std::vector<Command> commands() {
  return {{studies::run::run_schema(), read_machine_of_run, "marti.toml"},
          {studies::run::run_schema(), read_machine_of_run, "contexts.toml"},
          {studies::run::run_schema(), read_machine_of_run, "pipeline.toml"},
          {studies::run::run_schema(), read_machine_of_run, "space.toml"},
          {studies::run::run_schema(), read_machine_of_run, "distributed.toml"},
          {studies::run::run_schema(), [](Config& config) { (void)studies::frames::read_frames(config); },
           "animation.toml"},
          {studies::sweep::sweep_schema(), [](Config& config) { (void)studies::sweep::plan_sweep(config); },
           "sweep-small.toml"},
          {studies::paper::paper_schema(), [](Config& config) { (void)studies::paper::read_paper(config); },
           "paper.toml"}};
}

// Beside the shipped files, of which some name others.
const std::string config_name = MARTI_SOURCE "/configs/fuzz.toml";

// Bytes that must not appear unescaped in a message.
const std::vector<std::string> foreign = {"\x1b[31mred", "bell\x07",     "line\nbreak",
                                          "\xff\xfe",    "\xe2\x80\xae", std::string(3000, 'w'),
                                          "caf\xc3\xa9", "\xc2\x9b",     "\x7f"};

// As a basic string of TOML, with escapes for characters that it may not contain.
std::string toml_text(const std::string& text) { return sim::print_value(ValueType::text, text); }

std::string allowed(const Key& key, Random& random) {
  const auto print = [&](const sim::Value& value) { return sim::print_value(key.type, value); };
  std::string value;
  if (key.type == ValueType::boolean) {
    value = random() % 2 == 0 ? "true" : "false";
  } else if (key.type == ValueType::choice) {
    value = print(one_of(key.choices, random));
  } else if (key.type == ValueType::text) {
    value =
        toml_text(one_of(std::vector<std::string>{"", "0", "none", "teapot:2", "balls:1", "rule"}, random));
  } else if (key.minimum && random() % 2 == 0) {
    value = print(*key.minimum);
  } else if (key.maximum && random() % 2 == 0) {
    value = print(*key.maximum);
  } else {
    return print_values(key, key.default_value);
  }
  return key.is_list ? "[" + value + "]" : value;
}

std::string out_of_range(const Key& key, Random& random) {
  const bool below = random() % 2 == 0;
  switch (key.type) {
    case ValueType::integer:
      return below ? "-9223372036854775807" : "9223372036854775807";
    case ValueType::real:
      return below ? "-1e300" : "1e300";
    case ValueType::size:
      return below ? "\"0.3 B\"" : "\"7000000 TiB\"";
    case ValueType::frequency:
      return below ? "\"0 Hz\"" : "\"99999 THz\"";
    case ValueType::duration:
      return below ? "\"0.5 ps\"" : "\"99999999999 s\"";
    case ValueType::percentage:
      return below ? "\"-1 %\"" : "\"1e9 %\"";
    default:
      return toml_text(one_of(foreign, random));
  }
}

std::string wrong(const Key& key, Random& random) {
  static const std::vector<std::string> types = {
      "true",      "3",     "2.5",        "nan", "-inf", "1979-05-27",   "[1.5]",        "[]",
      "{ a = 1 }", "\"x\"", "[[1], [2]]", "''",  "0x10", "[{ a = [] }]", "\"3 parsecs\""};
  switch (random() % 4) {
    case 0:
      return one_of(types, random);
    case 1:
      return out_of_range(key, random);
    case 2:
      return "99999999999999999999999";
    default:
      return toml_text(one_of(foreign, random));
  }
}

// A name that is no key, and how it is written in a file.
std::string wrong_name(const std::string& key, Random& random) {
  switch (random() % 5) {
    case 0:
      return key.substr(0, key.find('.'));
    case 1:
      return key + "s";
    case 2:
      return "sweep.axes." + key;
    case 3:
      return key.substr(0, key.find('.')) + "." + toml_text(one_of(foreign, random));
    default:
      return toml_text(one_of(foreign, random));
  }
}

// Values as the lines of a file, or as options over one that is shipped.
struct Given {
  std::string text;
  std::vector<std::string> assignments;
  std::map<std::string, int> lines;  // of keys in the text
};

class Refusals : public testing::Test {
 protected:
  // Whether the configuration is refused, as it must be. Any other exception is the test's failure.
  bool refused(const Command& command, const Given& given) {
    try {
      Config config = Config::from_text(command.schema, given.text, config_name, given.assignments);
      command.read(config);
      return false;
    } catch (const sim::UserError& error) {
      check(command.schema, given, error.what());
      return true;
    }
  }

  static void check(const Schema& schema, const Given& given, const std::string& message) {
    const Refusal refusal = refusal_of(message, config_name);
    // A key that is not declared is the user's own, shortened where it is long.
    const std::string own = refusal.key.substr(0, refusal.key.find("..."));
    const auto is_among = [&](const std::string& assignment) {
      return sim::shown(assignment, sim::all_shown).starts_with(own);
    };
    if (refusal.set) {
      promise(std::any_of(given.assignments.begin(), given.assignments.end(), is_among),
              "no such option: " + message);
      return;
    }
    promise(!refusal.key.empty(), "without a key: " + message);
    const bool declared = schema.find(refusal.key) || schema.is_section(refusal.key);
    const std::string last = own.substr(own.rfind('.') + 1);
    const bool written = sim::shown(given.text, sim::all_shown).find(last) != std::string::npos ||
                         std::any_of(foreign.begin(), foreign.end(), [&](const std::string& text) {
                           return sim::shown(text).find(last) != std::string::npos;
                         });
    promise(declared || written, "an unknown key: " + message);
    const auto line = given.lines.find(refusal.key);
    promise(line == given.lines.end() || refusal.line == line->second, "another line: " + message);
  }
};

// The keys that a shipped file gives, one a line, and further ones to be given.
Given as_file(const Command& command, const std::string& shipped,
              const std::vector<std::pair<std::string, std::string>>& more) {
  std::map<std::string, std::string> values;
  std::vector<std::string> order;
  const auto give = [&](const std::string& key, const std::string& value) {
    if (values.insert_or_assign(key, value).second) {
      order.push_back(key);
    }
  };
  const Config config = Config::from_text(command.schema, shipped, "shipped");
  for (std::size_t key = 0; key < command.schema.keys().size(); ++key) {
    const Key& declared = command.schema.keys()[key];
    if (config.given_at(key) && declared.name != "scene.source") {
      give(declared.name, print_values(declared, config.values_at(key)));
    }
  }
  for (const auto& [key, value] : more) {
    give(key, value);
  }
  Given given;
  int line = 0;
  for (const std::string& key : order) {
    given.text += key + " = " + values[key] + "\n";
    given.lines[key] = ++line;
  }
  return given;
}

std::string as_option(const std::string& key, const std::string& value) { return key + "=" + value; }

TEST_F(Refusals, OfValuesOfTheWrongKind) {
  const std::vector<std::string> machines = {"contexts.toml", "pipeline.toml", "space.toml",
                                             "distributed.toml"};
  Random random(11);
  int refusals = 0;
  for (const Command& command : commands()) {
    const std::string shipped = test::read(fs::path(MARTI_SOURCE) / "configs" / command.file);
    for (const Key& key : command.schema.keys()) {
      const std::string value = wrong(key, random);
      const std::string bad = wrong_name(key.name, random);
      const std::string raw = one_of(foreign, random);
      const std::array<Given, 5> all = {as_file(command, shipped, {{key.name, value}}),
                                        as_file(command, shipped, {{bad, value}}),
                                        {shipped, {as_option(key.name, value)}, {}},
                                        {shipped, {as_option(key.name, raw)}, {}},
                                        {shipped, {as_option(bad, value)}, {}}};
      for (std::size_t i = 0; i < all.size(); ++i) {
        // One file of `marti run` is enough here.
        if (std::find(machines.begin(), machines.end(), command.file) != machines.end()) {
          continue;
        }
        // A correct sweep takes long to read.
        if (command.file.starts_with("sweep") && i != 2 && i != 4) {
          continue;
        }
        ASSERT_NO_THROW(refusals += refused(command, all[i]) ? 1 : 0)
            << command.file << ", " << i << ": " << key.name << " = " << value << ", " << bad;
      }
    }
  }
  EXPECT_GT(refusals, 1500);
}

// Each value is allowed; together they contradict each other.
TEST_F(Refusals, OfValuesThatContradictEachOther) {
  Random random(12);
  int refusals = 0;
  for (const Command& command : commands()) {
    if (command.file.starts_with("sweep")) {
      continue;
    }
    const std::string shipped = test::read(fs::path(MARTI_SOURCE) / "configs" / command.file);
    for (int i = 0; i < 60; ++i) {
      std::vector<std::pair<std::string, std::string>> more;
      Given options{shipped, {}, {}};
      for (std::size_t n = 1 + random() % 6; n > 0; --n) {
        const Key& key = command.schema.keys()[random() % command.schema.keys().size()];
        more.emplace_back(key.name, allowed(key, random));
        options.assignments.push_back(as_option(more.back().first, more.back().second));
      }
      ASSERT_NO_THROW(refusals += refused(command, as_file(command, shipped, more)) ? 1 : 0) << i;
      ASSERT_NO_THROW(refusals += refused(command, options) ? 1 : 0) << i;
    }
  }
  EXPECT_GT(refusals, 400);
}

// Errors that show only when a frame is rendered and timed. The last value is the one that is refused.
TEST_F(Refusals, OfWhatIsFoundWhileAMachineRuns) {
  const std::vector<std::vector<std::pair<std::string, std::string>>> cases = {
      {{"scene.source", "\"teapot:0\""}},
      {{"scene.source", "\"no\\u001b[1m:3\""}},
      {{"scene.camera", "\"left\""}},
      {{"scene.scene", "\"1\""}},
      {{"scene.animation", "\"walk\\u0007\""}},
      {{"frames.first", "7"}},
      {{"scene.source", "\"balls:1\""}, {"image.voxel_cut", "2.0"}},
      {{"image.width", "2000"}, {"image.height", "2000"}, {"host_machine.memory_limit", "\"1 MiB\""}},
      {{"layout.primitive", "\"64 KiB\""}, {"cache.organisation", "\"none\""}, {"node.clock", "\"1 Hz\""}},
      {{"interconnect.kind", "\"crossbar\""},
       {"interconnect.latency_cycles", "100000"},
       {"interconnect.clock", "\"1 Hz\""}},
      {{"host.clock", "\"100 Hz\""}, {"host.latency_cycles", "1000000000"}}};
  const Schema schema = studies::run::run_schema();
  for (const auto& values : cases) {
    std::string text = "image.width = 8\nimage.height = 8\nmachine.nodes = 2\n";
    std::string set = text + "scene.source = \"teapot:2\"\n";
    std::vector<std::string> assignments;
    std::map<std::string, int> lines;
    int line = 2;
    for (const auto& [key, value] : values) {
      if (const std::size_t at = text.find(key + " ="); at != std::string::npos) {
        text.replace(at, text.find('\n', at) - at, key + " = " + value);
      } else {
        text += key + " = " + value + "\n";
      }
      lines[key] = static_cast<int>(std::count(
                       text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find(key)), '\n')) +
                   1;
      assignments.push_back(as_option(key, value));
      ++line;
    }
    const std::string& blamed = values.back().first;
    const auto message = [&](const std::string& file,
                             const std::vector<std::string>& options) -> std::string {
      try {
        Config config = Config::from_text(schema, file, config_name, options);
        (void)studies::run::run(config);
      } catch (const sim::UserError& error) {
        return error.what();
      }
      return config_name + ": nothing: is refused";
    };
    const Refusal in_file = refusal_of(message(text, {}), config_name);
    EXPECT_EQ(in_file.key, blamed) << message(text, {});
    EXPECT_EQ(in_file.line, lines[blamed]) << message(text, {});
    const Refusal set_by_option = refusal_of(message(set, assignments), config_name);
    EXPECT_TRUE(set_by_option.set) << message(set, assignments);
    EXPECT_EQ(set_by_option.key, blamed) << message(set, assignments);
  }
}

// Mistakes of people, each with the words that the refusal must have.
TEST_F(Refusals, OfConfigurationsThatPeopleWrite) {
  test::expect_refusals(test::wrong_configurations(), [](const char* text) {
    Config config = Config::from_text(studies::run::run_schema(), text, "wrong.toml");
    (void)studies::run::run(config);
  });
}

}  // namespace
}  // namespace marti::fuzz
