// What the parts of a machine take of energy, as values.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace marti::processors::machine {

/// The technology whose figures hold where none is given. none: no energy is worked out.
enum class EnergyPreset : std::uint8_t { none, nm45, nm22 };
inline constexpr std::array<std::string_view, 3> energy_preset_names = {"none", "45nm", "22nm"};

/// The value of a figure that is to be taken from what is known of caches of a size, ways and line, or of the
/// units of operations.
inline constexpr double by_shape = -1.0;

/// Figures of one level of caches, each at least 0 or by_shape.
struct CacheFigures {
  double read = by_shape;   ///< pJ to look a line up and read it
  double write = by_shape;  ///< pJ to bring a line in
  double area = by_shape;   ///< mm2 of one cache
};

/// All at least 0, or by_shape where that is the default. Of an operation in pJ.
struct EnergyFigures {
  double add = 0.0;
  double multiply = 0.0;
  double divide = 0.0;
  double square_root = 0.0;
  double compare = 0.0;
  double integer = 0.0;
  double load = 0.0;
  double store = 0.0;
  double instruction = 0.0;  ///< pJ, of each operation beside its own: fetching, decoding, registers
  CacheFigures l1;
  CacheFigures l2;
  double wire = 0.0;                   ///< pJ to move a bit by a mm
  double interconnect_length = 0.0;    ///< mm between nodes and shared memory
  double hop_length = 0.0;             ///< mm of a link of the network
  double memory_access = 0.0;          ///< pJ of an access of a bank or local memory, beside its bytes
  double memory_read = 0.0;            ///< pJ of a byte read there
  double memory_write = 0.0;           ///< pJ of a byte written there
  double node_area = 0.0;              ///< mm2 of a node without its caches
  double context_area = 0.0;           ///< mm2 of each context beyond the first
  double leakage_density = 0.0;        ///< mW of a mm2, at all times
  double rt_operation = 0.0;           ///< pJ of each operation of a ray-tracing unit beside its own
  CacheFigures rt{};                   ///< of what holds a unit's rays and its registers for lines under way
  double rt_box_area = by_shape;       ///< mm2 of what begins the test of a record's boxes in each cycle
  double rt_triangle_area = by_shape;  ///< mm2 of what begins the test of a primitive in each cycle
};

struct EnergyConfig {
  EnergyPreset preset = EnergyPreset::none;
  EnergyFigures figures;  ///< for the voltage of the preset's sources
  double voltage = 1.0;   ///< as a multiple of that voltage: what switches takes its square

  [[nodiscard]] bool on() const { return preset != EnergyPreset::none; }
};

}  // namespace marti::processors::machine
