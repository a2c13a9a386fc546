// Measures how far the samples of `marti run --within` are from exact runs beside their own intervals, on
// five scenes in two sizes and twenty machines each, and prints the table of
// studies/estimate/measured_errors.h.
//   bench_estimates [DIVISOR]      default: 1; images are so many times smaller in width and height
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "bench/estimates/allowances.h"
#include "processors/replay/replay.h"
#include "sim/config.h"
#include "sim/mix.h"
#include "studies/estimate/measured_errors.h"
#include "studies/estimate/sample_machine.h"
#include "studies/estimate/sampled_frame.h"
#include "studies/keys/frame_keys.h"
#include "studies/keys/machine_keys.h"
#include "studies/run/prepared_frame.h"
#include "studies/run/run_result.h"

namespace {

using namespace marti;
using bench::MeasuredSample;
using processors::machine::MachineConfig;
using studies::estimate::Figure;

constexpr std::array scene_names = {"gears:2", "tetra:6", "teapot:4", "teapot:12", "large"};
constexpr std::array sides = {512U, 1024U};
constexpr std::array all_nodes = {1U, 16U, 32U, 64U};
constexpr std::array caches = {2U, 8U, 16U, 64U, 1024U};           // KiB
constexpr std::array<std::uint64_t, 3> all_strata = {16, 32, 64};  // of two windows each
constexpr std::uint64_t seed = 1;
// Fast nodes, so that the bus of many of the machines is nearly full.
constexpr std::string_view settings = "image.max_depth = 2\nnode.clock = \"400 MHz\"\n";

// Every case draws samples of its own.
void add_samples(const studies::run::PreparedFrame& prepared, const MachineConfig& machine, std::size_t scene,
                 std::uint64_t number, const studies::estimate::MachineFigures& exact,
                 std::vector<MeasuredSample>& samples) {
  const processors::program::RenderOptions& render = prepared.config().render;
  const processors::machine::PacketList packets(render.width, render.height, machine.packets);
  for (const std::uint64_t strata : all_strata) {
    const studies::estimate::PacketWindows windows(packets, studies::estimate::window_length(machine.nodes),
                                                   strata, sim::mix(seed ^ sim::mix(number)));
    if (windows.has_all() || windows.strata().size() < strata) {
      continue;  // a sample of the whole frame has no error
    }
    studies::estimate::SampledFrame frame = studies::estimate::sampled_frame(prepared);
    const processors::program::WorkLog& log = frame.with(windows);
    processors::walk::KeptVisits visits;
    const studies::estimate::LatticeWork work(log, machine, frame.lattice(), packets, visits);
    const studies::estimate::Estimate found =
        studies::estimate::with_one_node(
            studies::estimate::sample_machine(log, machine, windows, work, visits), log, machine, windows,
            work, visits)
            .machine;
    MeasuredSample& sample = samples.emplace_back();
    sample.scene = scene;
    sample.one_node = machine.nodes == 1;
    sample.load = studies::estimate::load_class_of(found.value[Figure::use]);
    sample.size = studies::estimate::size_class_of(windows.drawn());
    sample.interval = found.half_width;
    for (std::size_t i = 0; i < studies::estimate::figure_count; ++i) {
      const auto figure = static_cast<Figure>(i);
      sample.error[figure] = bench::error_of(figure, found.value[figure], exact[figure]);
    }
  }
}

void print_table(const std::vector<MeasuredSample>& samples) {
  using studies::estimate::sample_sizes;
  for (std::size_t load = 0; load < studies::estimate::load_classes.size(); ++load) {
    std::array<bench::Allowance, sample_sizes.size()> found;
    std::printf("    // busy up to %g %%:", 100.0 * studies::estimate::load_classes[load]);
    for (std::size_t size = 0; size < found.size(); ++size) {
      found[size] = bench::allowance_of(samples, load, size).value_or(bench::Allowance());
      std::printf("%s %llu windows: %zu samples, %.1f %% covered", size == 0 ? "" : ";",
                  static_cast<unsigned long long>(sample_sizes[size]), found[size].cases,
                  100.0 * found[size].covered);
    }
    std::printf("\n    {{");
    for (std::size_t size = 0; size < found.size(); ++size) {
      std::printf("%s{{", size == 0 ? "" : ",\n      ");
      for (std::size_t i = 0; i < studies::estimate::figure_count; ++i) {
        std::printf("%s%.17g", i == 0 ? "" : ", ", found[size].allowance.values[i]);
      }
      std::printf("}}");
    }
    std::printf("}},\n");
  }
}

}  // namespace

int main(int argc, char** argv) {
  const auto divisor = static_cast<std::uint32_t>(argc > 1 ? std::atoi(argv[1]) : 1);
  sim::Config given = sim::Config::from_text(studies::run::run_schema(), settings, "bench_estimates");
  studies::keys::FrameConfig config = studies::keys::read_frame(given);
  MachineConfig machine = studies::keys::read_machine(given);
  std::vector<MeasuredSample> samples;
  std::uint64_t number = 0;
  for (std::size_t scene = 0; scene < scene_names.size(); ++scene) {
    for (const std::uint32_t side : sides) {
      config.scene = scene_names.at(scene);
      config.render.width = side / divisor;
      config.render.height = side / divisor;
      const studies::run::PreparedFrame prepared(config);
      const processors::program::Frame whole = prepared.trace();
      for (const std::uint32_t kib : caches) {
        double alone = 0.0;  // the frame time of one node, which comes first
        for (const std::uint32_t nodes : all_nodes) {
          machine.nodes = nodes;
          machine.cache.cache.size = std::uint64_t{kib} * 1024;
          studies::estimate::MachineFigures exact =
              studies::estimate::figures_of(machine, processors::replay::replay(*whole.log, machine));
          alone = nodes == 1 ? exact[Figure::end] : alone;
          exact[Figure::speed_up] = alone / exact[Figure::end];
          add_samples(prepared, machine, scene, number++, exact, samples);
        }
      }
      std::fprintf(stderr, "%s, %u x %u: %zu samples so far\n", config.scene.c_str(), config.render.width,
                   config.render.height, samples.size());
    }
  }
  print_table(samples);
  return 0;
}
