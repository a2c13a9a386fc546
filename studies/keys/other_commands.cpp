#include "studies/keys/other_commands.h"

#include <string>
#include <string_view>

#include "studies/keys/frame_keys.h"
#include "studies/keys/machine_keys.h"
#include "studies/keys/record_keys.h"

namespace marti::studies::keys {

void declare_sections_of_other_commands(sim::Schema& schema) {
  for (const std::string_view study : {"paper", "error", "stability"}) {
    schema.elsewhere(study, "marti study " + std::string(study));
  }
  schema.elsewhere("suite", "marti study suite");
  for (const std::string_view section : {"sweep", "question", "prices"}) {
    schema.elsewhere(section, "marti sweep");
  }
  if (schema.is_section("record")) {
    return;  // it is the schema of `marti run`, which has all sections below
  }
  sim::Schema run;
  declare_frame_keys(run);
  declare_machine_keys(run);
  declare_record_keys(run);
  std::string last;
  for (const sim::Key& key : run.keys()) {
    const std::string section = key.name.substr(0, key.name.find('.'));
    if (section != last) {
      schema.elsewhere(section, "marti run");
      last = section;
    }
  }
}

}  // namespace marti::studies::keys
