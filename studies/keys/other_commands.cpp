#include "studies/keys/other_commands.h"

#include <string>
#include <string_view>

#include "studies/keys/frame_keys.h"
#include "studies/keys/machine_keys.h"
#include "studies/keys/record_keys.h"

namespace marti::studies::keys {

void declare_sections_of_other_commands(sim::Schema& schema) {
  for (const std::string_view study : {"paper", "schemes", "error", "stability"}) {
    schema.elsewhere(study, "marti study " + std::string(study));
  }
  schema.elsewhere("sweep", "marti sweep");
  schema.elsewhere("prices", "marti sweep");
  sim::Schema run;
  declare_frame_keys(run);
  declare_machine_keys(run);
  declare_record_keys(run);
  for (const sim::Key& key : run.keys()) {
    schema.elsewhere(key.name.substr(0, key.name.find('.')), "marti run");
  }
}

}  // namespace marti::studies::keys
