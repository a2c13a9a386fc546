// Configurations that must be refused, and many of `marti run`: tests/fuzz reads them all, tests/cli starts
// the program with some of them.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/user_error.h"

namespace marti::test {

struct WrongConfiguration {
  const char* text;                    ///< of wrong.toml
  std::vector<std::string> complaint;  ///< parts of the message
};

/// `read` must refuse the text of each with all parts of its complaint, in one line.
template <class Read>
void expect_refusals(const std::vector<WrongConfiguration>& cases, const Read& read) {
  for (const WrongConfiguration& wrong : cases) {
    const std::string message = user_error_of([&] { read(wrong.text); });
    for (const std::string& part : wrong.complaint) {
      EXPECT_PRED_FORMAT2(testing::IsSubstring, part, message) << wrong.text;
    }
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

inline const std::vector<WrongConfiguration>& wrong_configurations() {
  static const std::vector<WrongConfiguration> all = {
      {"[cache]\nsiz = \"16 KiB\"\n", {"wrong.toml:2", "cache.siz", "cache.size"}},
      {"[cache]\nsize = \"17 B\"\n", {"wrong.toml:2", "cache.size", "line"}},
      {"[cache]\nsize = true\n", {"wrong.toml:2", "cache.size"}},
      {"[scene]\neye = [1.0, 2.0]\n", {"wrong.toml:2", "scene.eye", "three coordinates"}},
      {"[scene]\nfield_of_view = 180.0\n", {"wrong.toml:2", "scene.field_of_view"}},
      {"[machine]\nscheme = \"pipeline\"\nnodes = 2\n", {"wrong.toml:3", "machine.nodes", "at least 3"}},
      {"[machine]\nscheme = \"pipeline\"\n[pipeline]\nsearch = 3\n",
       {"pipeline.nearest", "all three stages"}},
      {"[machine]\nscheme = \"pipeline\"\n[pipeline]\nsearch = 3\nnearest = 3\nshade = 3\n",
       {"wrong.toml:4", "pipeline.search", "9", "machine.nodes = 16"}},
      {"[machine]\nscheme = \"pipeline\"\n[pipeline]\nin_flight = 1000\n",
       {"wrong.toml:4", "pipeline.in_flight", "more than 118"}},
      {"[machine]\nscheme = \"pipeline\"\n[host]\nassignment = \"blocks\"\n",
       {"wrong.toml:4", "host.assignment", "machine.scheme"}},
      {"[machine]\nscheme = \"pipeline\"\n[build]\nsharing = \"shared\"\n",
       {"wrong.toml:4", "build.sharing", "must be given"}},
      {"[pipeline]\nqueue = 4\n", {"wrong.toml:2", "pipeline.queue", "machine.scheme"}},
      {"[messages]\nray = \"8 B\"\n", {"wrong.toml:2", "messages.ray", "machine.scheme"}},
      {"[cache]\nline = \"24 B\"\n", {"wrong.toml:2", "cache.line", "power of two"}},
      {"[cache]\norganisation = \"none\"\nsize = \"1 KiB\"\n", {"wrong.toml:3", "cache.size", "none"}},
      {"[cache]\nreplacement = \"lur\"\n", {"wrong.toml:2", "cache.replacement", "lru"}},
      {"[structure]\nkind = \"kdtree\"\n", {"wrong.toml:2", "structure.kind", "\"bsp\" here"}},
      {"[costs]\npreset = \"modern\"\n", {"wrong.toml:2", "costs.preset", "\"arm1176-2003\" here"}},
      {"[costs]\npreset = \"mc68882\"\n", {"wrong.toml:2", "costs.preset", "\"mc68882-1989\" here"}},
      {"[l2]\nsharing = \"shared\"\nclock = \"0.5 Hz\"\n", {"wrong.toml:3", "l2.clock", "1 Hz"}},
      {"[l2]\nclock = \"1 GHz\"\n", {"wrong.toml:2", "l2.clock", "l2.sharing"}},
      {"[energy]\nadd = 1.0\n", {"wrong.toml:2", "energy.add", "energy.preset"}},
      {"[energy]\npreset = \"7nm\"\n", {"wrong.toml:2", "energy.preset", "22nm"}},
      {"[energy]\npreset = \"45nm\"\nadd = -0.5\n", {"wrong.toml:3", "energy.add", "at least 0"}},
      {"[energy]\npreset = \"45nm\"\nadd = nan\n", {"wrong.toml:3", "energy.add", "nan"}},
      {"[energy]\npreset = \"45nm\"\nwire = 1e300\n", {"wrong.toml:3", "energy.wire", "1e+300"}},
      {"[energy]\npreset = \"45nm\"\nvoltage = -1.0\n", {"wrong.toml:3", "energy.voltage"}},
      {"[energy]\npreset = \"45nm\"\nhop_length = 1.0\n", {"wrong.toml:3", "energy.hop_length", "network"}},
      {"[energy]\npreset = \"45nm\"\nl2_read = 1.0\n", {"wrong.toml:3", "energy.l2_read", "l2.sharing"}},
      {"[energy]\npreset = \"45nm\"\n[cache]\nsize = \"8 MiB\"\n",
       {"wrong.toml:4", "cache.size", "8 MiB", "2 KiB to 4 MiB", "energy.l1_read"}},
      {"[energy]\npreset = \"22nm\"\nleakage_density = 1e5\nnode_area = 1e4\n[image]\nwidth = 24\nheight = "
       "16\n",
       {"wrong.toml:2", "energy.preset", "9,223 J"}},
      {"[machine]\nnodes = 0\n", {"wrong.toml:2", "machine.nodes"}},
      {"[machine]\nnodes = -5\n", {"wrong.toml:2", "machine.nodes"}},
      {"[machine]\nnodes = 16777216\nclusters = 2\n", {"wrong.toml:2", "machine.nodes", "2^24"}},
      {"[machine]\nnodes = 1.5\n", {"wrong.toml:2", "machine.nodes"}},
      {"[image]\nwidth = 99999999999999999999\n", {"wrong.toml:2"}},
      {"[image]\nwidth = 32768\nheight = 32768\nmax_depth = 64\n", {"memory_limit"}},
      {"[interconnect]\nkind = \"ideal\"\nwidth = \"8 B\"\n",
       {"wrong.toml:3", "interconnect.width", "ideal"}},
      {"[memory]\ninterleave = \"48 B\"\n", {"wrong.toml:2", "memory.interleave", "power of two"}},
      {"[node]\nclock = \"33\"\n", {"wrong.toml:2", "node.clock"}},
      {"[scene]\nsource = \"teepot:12\"\n", {"teepot", "teapot"}},
      {"[scene]\nsource = \"teapot:0\"\n", {"teapot"}},
      {"[scene]\nsource = \"missing.glb\"\n", {"missing.glb"}},
      {"[scene]\nsource = \"teapot:2\"\nframe = 3\n", {"frame"}},
      {"[structure]\nkind = \"none\"\nmax_level = 3\n", {"wrong.toml:3", "structure.max_level", "none"}},
      {"[structure]\nkind = \"grid\"\nmax_level = 3\n", {"wrong.toml:3", "structure.max_level", "grid"}},
      {"[structure]\nkind = \"bsp\"\ngrid_density = 3.0\n",
       {"wrong.toml:3", "structure.grid_density", "bsp"}},
      {"[structure]\nkind = \"bvh\"\nmax_objects = 3\n", {"wrong.toml:3", "structure.max_objects", "bvh"}},
      {"[structure]\nbvh_children = \"4\"\n", {"wrong.toml:2", "structure.bvh_children", "octree"}},
      {"[structure]\nkind = \"bvh\"\nbvh_children = \"8_quantised\"\nbvh_leaf = 4\n",
       {"wrong.toml:4", "structure.bvh_leaf", "at most 3", "8_quantised"}},
      {"[structure]\nkind = \"bvh\"\n[layout]\nnode = \"8 B\"\n",
       {"wrong.toml:4", "layout.node", "structure.bvh_children"}},
      {"[structure]\nkind = \"bvh\"\n[build]\nsharing = \"shared\"\n",
       {"wrong.toml:4", "build.sharing", "bvh", "given"}},
      {"[structure]\nkind = \"bvh\"\n[image]\nvoxel_cut = 1.0\n",
       {"wrong.toml:4", "image.voxel_cut", "octree", "bvh"}},
      {"[layout]\ntreelet = \"1 KiB\"\n", {"wrong.toml:2", "layout.treelet", "node_order"}},
      {"[build]\nrule_k = 3.0\n", {"wrong.toml:2", "build.rule_k", "given"}},
      {"[build]\nsharing = \"none\"\ninitial_level = \"3\"\n",
       {"wrong.toml:3", "build.initial_level", "none"}},
      {"[build]\nsharing = \"shared\"\ninitial_level = \"3\"\nrule_k = 3.0\n",
       {"wrong.toml:4", "build.rule_k", "rule"}},
      {"[build]\nsharing = \"shared\"\ninitial_level = \"0\"\n", {"wrong.toml:3", "build.initial_level"}},
      {"[build]\nsharing = \"shared\"\ninitial_level = \"low\"\n", {"wrong.toml:3", "full", "rule", "low"}},
      {"[structure]\nkind = \"grid\"\n[build]\nsharing = \"none\"\n",
       {"wrong.toml:4", "build.sharing", "structure.kind", "grid"}},
      {"[database]\nplacement = \"replicated\"\n[build]\nsharing = \"shared\"\n",
       {"wrong.toml:4", "build.sharing", "replicated"}},
      {"[network]\nkind = \"mesh\"\n", {"wrong.toml:2", "network.kind", "no messages"}},
      {"[database]\ninterleave = \"64 B\"\n", {"wrong.toml:2", "database.interleave", "distributed"}},
      {"[database]\nplacement = \"distributed\"\ninterleave = \"16 B\"\n",
       {"wrong.toml:3", "database.interleave", "32 bytes"}},
      {"[database]\nplacement = \"distributed\"\ninterleave = \"48 B\"\n",
       {"wrong.toml:3", "database.interleave", "power of two"}},
      {"[database]\nplacement = \"distributed\"\n[memory]\nbanks = 8\n",
       {"wrong.toml:4", "memory.banks", "[local]"}},
      {"[database]\nplacement = \"distributed\"\n[interconnect]\nkind = \"crossbar\"\n",
       {"wrong.toml:4", "interconnect.kind", "[network]"}},
      {"[database]\nplacement = \"distributed\"\n[network]\nkind = \"ideal\"\nwidth = \"8 B\"\n",
       {"wrong.toml:5", "network.width", "ideal"}},
      {"[database]\nplacement = \"distributed\"\n[build]\nsharing = \"shared\"\n",
       {"wrong.toml:4", "build.sharing", "overtake", "private"}},
      {"[interconnect]\nkind = \"crossbar\"\narbitration = \"round_robin\"\n",
       {"wrong.toml:3", "interconnect.arbitration", "crossbar"}},
      {"[interconnect]\narbitration = \"fixed_priority\"\n[build]\nsharing = \"shared\"\n",
       {"build.sharing", "overtake", "interconnect.arbitration"}},
      {"[dram]\npolicy = \"frfcfs\"\n", {"wrong.toml:2", "dram.policy", "memory.model"}},
      {"[memory]\nmodel = \"dram\"\nbanks = 8\n", {"wrong.toml:3", "memory.banks", "[dram]"}},
      {"[memory]\nmodel = \"dram\"\n[dram]\nqueue = 8\n", {"wrong.toml:4", "dram.queue", "frfcfs"}},
      {"[memory]\nmodel = \"dram\"\n[dram]\nchannels = 3\n",
       {"wrong.toml:4", "dram.channels", "power of two"}},
      {"[memory]\nmodel = \"dram\"\n[dram]\nchannels = 256\nranks = 2\nbanks = 64\n",
       {"wrong.toml:6", "dram.banks", "65536"}},
      {"[memory]\nmodel = \"dram\"\n[dram]\nmapping = [\"columns\"]\n",
       {"wrong.toml:4", "dram.mapping", "columns"}},
      {"[memory]\nmodel = \"dram\"\n[dram]\nmapping = [\"column\", \"row\"]\n",
       {"wrong.toml:4", "dram.mapping", "bank_group"}},
      {"[memory]\nmodel = \"dram\"\n[dram]\ntrefi = 300\n", {"wrong.toml:4", "dram.trefi", "433"}},
      {"[memory]\nmodel = \"dram\"\n[dram]\npolicy = \"frfcfs\"\n[interconnect]\nmode = \"held\"\n",
       {"wrong.toml:4", "dram.policy", "interconnect.mode"}},
      {"[memory]\nmodel = \"dram\"\n[dram]\npolicy = \"frfcfs\"\n[build]\nsharing = \"shared\"\n",
       {"wrong.toml:6", "build.sharing", "dram.policy"}},
      {"[memory]\nmodel = \"dram\"\n[dram]\npolicy = \"frfcfs\"\n[record]\ncritical_path = true\n",
       {"wrong.toml:6", "record.critical_path", "frfcfs"}},
      {"[interconnect]\nkind = \"ideal\"\n[memory]\nmodel = \"dram\"\n",
       {"wrong.toml:4", "memory.model", "ideal"}},
      {"[database]\nplacement = \"distributed\"\n[memory]\nmodel = \"dram\"\n",
       {"wrong.toml:4", "memory.model", "[local]"}},
      {"nodes = 3\n", {"wrong.toml:1", "nodes"}},
      {"[cache\n", {"wrong.toml:1"}},
      {"[cache]\nsize = \"1536 MiB\"\nline = \"1 B\"\nways = 0\n", {"wrong.toml:2", "cache.size", "2^28"}},
      {"[machine]\nnodes = 16000000\n[cache]\nsize = \"1 MiB\"\n",
       {"wrong.toml:2", "machine.nodes", "memory_limit"}},
      {"[cache]\nsize = \"1 KiB\"\nsize = \"2 KiB\"\n", {"wrong.toml:3"}},
  };
  return all;
}

}  // namespace marti::test
