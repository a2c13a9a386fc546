#include "studies/tables/provenance.h"

#include <sys/utsname.h>
#include <tbb/task_arena.h>

#include <fstream>
#include <string>

#include "studies/version.h"

namespace marti::studies::tables {

namespace {

std::string processor_model() {
  std::ifstream file("/proc/cpuinfo");
  std::string line;
  while (std::getline(file, line)) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) {
      return line.substr(colon + 2);
    }
  }
  return "unknown";
}

std::string system_name() {
  utsname name{};
  return uname(&name) == 0 ? std::string(name.sysname) + " " + name.release + " " + name.machine : "unknown";
}

}  // namespace

Table provenance_table(std::span<const sim::EffectiveValue> values) {
  Table table("provenance", "Program and settings",
              {text_column("setting", "version, or a key of the configuration"),
               text_column("value", "its value, as in a TOML file"),
               count_column("given", "1: by file or command line; 0: the default")});
  table.add_row({"version", version, std::int64_t{0}});
  for (const sim::EffectiveValue& value : values) {
    table.add_row({value.key, value.value, value.given});
  }
  return table;
}

Table host_table() {
  Table table("host", "The computer that ran the study",
              {text_column("what", "property"), text_column("value", "its value")});
  table.add_row({"processor", processor_model()});
  table.add_row({"system", system_name()});
  table.add_row({"threads", std::to_string(tbb::this_task_arena::max_concurrency())});
  return table;
}

}  // namespace marti::studies::tables
