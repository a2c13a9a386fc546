#include <string>

#include "sim/parse_number.h"
#include "sim/shown.h"
#include "studies/keys/key_parts.h"
#include "studies/keys/machine_sections.h"

namespace marti::studies::keys {

namespace {

using processors::machine::BuildConfig;
using processors::machine::InitialTree;
using processors::machine::Sharing;

// "full", "rule" or a level, which is written as a text too, so that the key has one type.
void read_initial_level(const sim::Config& config, BuildConfig& build) {
  const std::string& text = config.text("build.initial_level");
  if (text == "full") {
    build.initial = InitialTree::full;
    return;
  }
  if (text == "rule") {
    build.initial = InitialTree::rule;
    return;
  }
  build.initial = InitialTree::level;
  build.level = sim::parse_number<decltype(build.level)>(text).value_or(0);
  if (build.level == 0 || build.level > most_levels) {
    config.fail("build.initial_level", "must be \"full\", \"rule\" or a level from \"1\" to \"" +
                                           std::to_string(most_levels) + "\", not \"" + sim::shown(text) +
                                           "\"");
  }
}

// Reads all keys that say where the initial tree ends.
void read_initial_tree(sim::Config& config, BuildConfig& build) {
  read_initial_level(config, build);
  if (build.initial == InitialTree::rule) {
    build.rule_k = config.real("build.rule_k");
  }
  config.mark_unused_reason("build.rule_k", "it has no effect without build.initial_level = \"rule\"",
                            "build.initial_level");
}

}  // namespace

void declare_build_keys(sim::Schema& schema) {
  schema.section("build", "how the machine gets its tree");
  schema.choice(
      "build.sharing", "given", names(processors::machine::sharing_names),
      "given: the whole tree is there and costs nothing; none: it is built before the frame, and paid; "
      "shared: an initial tree is built before the frame, and each node below it by the processor "
      "node that needs it first, while others wait; private: each processor node builds what it needs below "
      "the initial "
      "tree in its own memory (see local)");
  schema.text(
      "build.initial_level", "rule",
      "where the initial tree ends: a level (\"1\": nothing is built beforehand), \"full\", or \"rule\": "
      "at the first level with more than rule_k leaves for each node that is not a leaf");
  schema.real(
      "build.rule_k", 10.0, {0.0, 1e6}, "",
      "leaves for each other node at which the rule stops: 3 is the worst case, 10 what is recommended");
}

BuildConfig read_build(sim::Config& config) {
  BuildConfig build;
  build.sharing = config.choice_as<Sharing>("build.sharing");
  const std::string chosen =
      "it has no effect with build.sharing = \"" + config.choice_name("build.sharing") + "\"";
  if (build.sharing == Sharing::given) {
    config.mark_unused_reason("build", chosen, "build.sharing");
    return build;
  }
  const std::string& structure = config.choice_name("structure.kind");
  if (structure == "bvh") {
    config.fail("build.sharing",
                "must be \"given\" with structure.kind = \"bvh\": a split there depends on all primitives "
                "below it, so the machine would have to sort them all before its first ray");
  }
  if (structure != "octree" && structure != "bsp") {
    config.fail("build.sharing", "must be \"given\" with structure.kind = \"" + structure +
                                     "\": only an octree or a bsp tree is built by splitting nodes");
  }
  if (build.sharing == Sharing::none) {
    config.mark_unused_reason("build", chosen, "build.sharing");
    return build;
  }
  read_initial_tree(config, build);
  return build;
}

BuildConfig read_dynamic_build(sim::Config& config) {
  BuildConfig build = read_build(config);
  if (build.sharing == Sharing::shared || build.sharing == Sharing::private_trees) {
    return build;
  }
  if (config.given("build.sharing")) {
    config.fail("build.sharing", "the study builds on demand: it must be \"shared\" or \"private\"");
  }
  build.sharing =
      config.choice_name("database.placement") == "shared" ? Sharing::shared : Sharing::private_trees;
  read_initial_tree(config, build);
  return build;
}

}  // namespace marti::studies::keys
