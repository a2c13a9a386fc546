#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "processors/energy/dram_energy.h"
#include "processors/energy/energy_presets.h"
#include "processors/energy/energy_units.h"
#include "studies/keys/key_parts.h"
#include "studies/keys/machine_sections.h"

namespace marti::studies::keys {

namespace {

using processors::energy::most_of_operation;
using processors::machine::CacheFigures;
using processors::machine::EnergyFigures;

// A key that is not given, and one of -1, leave the preset's figure.
constexpr double preset_figure = -1.0;

struct FigureKey {
  std::string_view name;
  double EnergyFigures::*member;
  double most;
  std::string_view unit;
  std::string_view meaning;
};

constexpr double most_of_byte = 100'000.0;
constexpr double most_of_access = 1'000'000.0;
constexpr double most_length = 10'000.0;

constexpr std::array<FigureKey, 21> figure_keys = {{
    {"energy.add", &EnergyFigures::add, most_of_operation, "pJ", "of an addition or subtraction"},
    {"energy.multiply", &EnergyFigures::multiply, most_of_operation, "pJ", "of a multiplication"},
    {"energy.divide", &EnergyFigures::divide, most_of_operation, "pJ", "of a division"},
    {"energy.square_root", &EnergyFigures::square_root, most_of_operation, "pJ", "of a square root"},
    {"energy.compare", &EnergyFigures::compare, most_of_operation, "pJ", "of a comparison"},
    {"energy.integer", &EnergyFigures::integer, most_of_operation, "pJ", "of an integer operation"},
    {"energy.load", &EnergyFigures::load, most_of_operation, "pJ",
     "of issuing the load of a word; its cache is counted apart"},
    {"energy.store", &EnergyFigures::store, most_of_operation, "pJ", "of issuing the store of a word"},
    {"energy.instruction", &EnergyFigures::instruction, most_of_operation, "pJ",
     "of each of these operations beside its own: fetching, decoding, registers; 0 for a fixed function"},
    {"energy.wire", &EnergyFigures::wire, 10'000.0, "pJ", "of a bit moved by a mm"},
    {"energy.interconnect_length", &EnergyFigures::interconnect_length, most_length, "mm",
     "way of each byte between a node and shared memory"},
    {"energy.hop_length", &EnergyFigures::hop_length, most_length, "mm",
     "way of each byte over a link of the network"},
    {"energy.memory_access", &EnergyFigures::memory_access, most_of_access, "pJ",
     "of an access of a bank or a node's own memory beside its bytes: activating and precharging a row; "
     "with memory.model = \"dram\" the preset is dram.preset"},
    {"energy.memory_read", &EnergyFigures::memory_read, most_of_byte, "pJ",
     "of a byte that a memory reads; each read is of a cache line"},
    {"energy.memory_write", &EnergyFigures::memory_write, most_of_byte, "pJ",
     "of a byte that a memory writes; each write is of a cache line"},
    {"energy.node_area", &EnergyFigures::node_area, most_length, "mm2",
     "area of a node without its caches; of a SIMT node, of each lane of a slot"},
    {"energy.context_area", &EnergyFigures::context_area, most_length, "mm2",
     "area of each context of a node beyond the first; of a SIMT node, of each other lane of its warps"},
    {"energy.leakage_density", &EnergyFigures::leakage_density, 100'000.0, "mW",
     "power that a mm2 of nodes and caches takes at all times"},
    {"energy.rt_operation", &EnergyFigures::rt_operation, most_of_operation, "pJ",
     "of each operation of a ray-tracing unit beside its own; 0 for a fixed function"},
    {"energy.rt_box_area", &EnergyFigures::rt_box_area, most_length, "mm2",
     "area of what begins the test of a record's boxes in each cycle; the preset has a unit for each of its "
     "operations"},
    {"energy.rt_triangle_area", &EnergyFigures::rt_triangle_area, most_length, "mm2",
     "area of what begins the test of a triangle in each cycle; the preset as before"},
}};

struct CacheKey {
  std::string_view name;
  CacheFigures EnergyFigures::*level;
  double CacheFigures::*member;
  double most;
  std::string_view unit;
  std::string_view meaning;
};

constexpr std::array<CacheKey, 9> cache_keys = {{
    {"energy.l1_read", &EnergyFigures::l1, &CacheFigures::read, most_of_access, "pJ",
     "of a look-up in a node's cache, one line; the same for each of split caches"},
    {"energy.l1_write", &EnergyFigures::l1, &CacheFigures::write, most_of_access, "pJ",
     "of a line brought into a node's cache; the same for each of split caches"},
    {"energy.l1_area", &EnergyFigures::l1, &CacheFigures::area, most_length, "mm2",
     "area of the cache; of split caches, of each"},
    {"energy.l2_read", &EnergyFigures::l2, &CacheFigures::read, most_of_access, "pJ",
     "of a look-up in a second-level cache, one line"},
    {"energy.l2_write", &EnergyFigures::l2, &CacheFigures::write, most_of_access, "pJ",
     "of a line brought into a second-level cache"},
    {"energy.l2_area", &EnergyFigures::l2, &CacheFigures::area, most_length, "mm2",
     "area of a second-level cache"},
    {"energy.rt_read", &EnergyFigures::rt, &CacheFigures::read, most_of_access, "pJ",
     "of reading a ray in a ray-tracing unit before a test"},
    {"energy.rt_write", &EnergyFigures::rt, &CacheFigures::write, most_of_access, "pJ",
     "of writing it back after the test"},
    {"energy.rt_area", &EnergyFigures::rt, &CacheFigures::area, most_length, "mm2",
     "area of what holds a unit's rays, 128 bytes each, and its registers for lines under way, 16 bytes "
     "each"},
}};

void declare_figure(sim::Schema& schema, std::string_view name, double most, std::string_view unit,
                    std::string meaning, std::string_view otherwise) {
  meaning += "; -1: ";
  meaning += otherwise;
  schema.real(name, preset_figure, {preset_figure, most}, unit, meaning);
}

// Reads keys of figures, but not those that this machine has no use for.
class FigureReader {
 public:
  FigureReader(sim::Config& config, const processors::machine::MachineConfig& machine)
      : config_(config), machine_(machine) {}

  // Sets the figure if the key says another than the preset's.
  void read(std::string_view name, double& figure) {
    if (const std::optional<Reason> reason = why_unused(name)) {
      config_.mark_unused_reason(name, reason->text, reason->decided_by);
      return;
    }
    const double given = config_.real(name);
    if (given >= 0.0) {
      figure = given;
    } else if (given != preset_figure) {
      config_.fail(name, "must be at least 0, or -1 for the preset's");
    }
  }

 private:
  struct Reason {
    std::string_view text;
    std::string_view decided_by;
  };

  [[nodiscard]] std::optional<Reason> why_unused(std::string_view name) const {
    if (name.starts_with("energy.l1_") &&
        machine_.cache.organisation == processors::machine::CacheOrganisation::none) {
      return Reason{"there is no cache with cache.organisation = \"none\"", "cache.organisation"};
    }
    if (name.starts_with("energy.l2_") && machine_.l2.sharing == processors::machine::SecondLevel::none) {
      return Reason{"there is no second level with l2.sharing = \"none\"", "l2.sharing"};
    }
    if (name.starts_with("energy.rt_") && !machine_.has_rt_unit()) {
      return Reason{"there is no ray-tracing unit", "node.kind"};
    }
    if (name == "energy.context_area" && machine_.contexts == 1 &&
        machine_.kind != processors::machine::NodeKind::simt) {
      return Reason{"a node with one context has no other", "node.contexts"};
    }
    const bool image = machine_.scheme == processors::machine::Scheme::image;
    const bool distributed = machine_.placement == processors::machine::Placement::distributed;
    if (name == "energy.hop_length" && image && !distributed) {
      return Reason{"this machine has no network", "machine.scheme"};
    }
    if (name == "energy.interconnect_length" &&
        (distributed || machine_.scheme == processors::machine::Scheme::space)) {
      return Reason{"this machine has a network instead",
                    distributed ? "database.placement" : "machine.scheme"};
    }
    return std::nullopt;
  }

  sim::Config& config_;
  const processors::machine::MachineConfig& machine_;
};

}  // namespace

void declare_energy_keys(sim::Schema& schema) {
  schema.section("energy",
                 "the energy of the frame, worked out from what was counted; changes no other figure");
  schema.choice("energy.preset", "none", names(processors::machine::energy_preset_names),
                "the technology whose figures are taken (sources: energy.md); none: no energy is worked out");
  schema.real("energy.voltage", 1.0, {0.0, processors::energy::most_voltage}, "",
              "supply voltage by that of the preset's sources: operations, caches and wires take its square");
  for (const FigureKey& key : figure_keys) {
    declare_figure(schema, key.name, key.most, key.unit, std::string(key.meaning), "the preset's");
  }
  for (const CacheKey& key : cache_keys) {
    declare_figure(schema, key.name, key.most, key.unit, std::string(key.meaning),
                   key.level == &EnergyFigures::rt ? "by its bytes" : "by size, ways and line");
  }
}

void read_energy(sim::Config& config, processors::machine::MachineConfig& machine) {
  processors::machine::EnergyConfig& energy = machine.energy;
  energy.preset = config.choice_as<processors::machine::EnergyPreset>("energy.preset");
  if (energy.on()) {
    energy.voltage = config.real("energy.voltage");
    energy.figures = processors::energy::energy_figures(energy.preset);
    if (machine.banks.dram) {
      const processors::energy::DramEnergy& dram =
          processors::energy::dram_energy(machine.banks.dram->preset);
      energy.figures.memory_access = dram.activation;
      energy.figures.memory_read = dram.read;
      energy.figures.memory_write = dram.write;
    }
    FigureReader reader(config, machine);
    for (const FigureKey& key : figure_keys) {
      reader.read(key.name, energy.figures.*key.member);
    }
    for (const CacheKey& key : cache_keys) {
      reader.read(key.name, energy.figures.*key.level.*key.member);
    }
  }
  config.mark_unused_reason("energy", "no energy is worked out with energy.preset = \"none\"",
                            "energy.preset");
}

}  // namespace marti::studies::keys
