// The knobs of the renderer.
#include <fmt/format.h>

#include <memory>

#include "accel/structure.h"
#include "processors/program/render.h"
#include "studies/error/setting.h"
#include "studies/run/open_frame.h"
#include "studies/tables/text_units.h"

namespace marti::studies::error {

namespace {

using processors::program::RenderOptions;

// A scene that is rendered again and again.
struct Renderer {
  explicit Renderer(const keys::FrameConfig& frame)
      : scene(run::open_frame(frame)),
        triangles(std::make_shared<const accel::TriangleSet>(scene)),
        structure(accel::make_structure(frame.structure, triangles, frame.structure_options)) {}

  scenes::Scene scene;
  std::shared_ptr<const accel::TriangleSet> triangles;
  std::unique_ptr<accel::Structure> structure;
};

class Knobs {
 public:
  Knobs(const ErrorConfig& config, std::vector<Setting>& settings)
      : config_(config),
        settings_(settings),
        renderer_(std::make_shared<const Renderer>(config.frame)),
        base_(keys::made_small(config.frame.render, config.side)),
        is_path_(base_.integrator == processors::program::Integrator::path) {
    base_.record = false;
  }

  void add() {
    if (!config_.samples.empty()) {
      add_samples(reference_factor * config_.samples.back(), true);
    }
    for (const std::uint32_t samples : config_.samples) {
      add_samples(samples, false);
    }
    RenderOptions deep = base_;
    if (!config_.depths.empty()) {
      deep.max_depth = 2 * config_.depths.back();
      add_setting("depth", tables::counted(deep.max_depth, "ray"), deep.max_depth, deep, true);
    }
    for (const std::uint32_t depth : config_.depths) {
      RenderOptions options = base_;
      options.max_depth = depth;
      add_setting("depth", tables::counted(depth, "ray"), depth, options);
    }
    // To cut rays off would darken a path-traced image.
    if (!is_path_ && !config_.weights.empty()) {
      deep.min_weight = 0.0;  // the weight ends the chains, as far as it can
      add_setting("weight", "all", 0.0, deep, true);
      for (const double weight : config_.weights) {
        deep.min_weight = weight;
        add_setting("weight", fmt::format("{:g}", weight), weight, deep);
      }
    }
    add_setting("precision", "double", 53.0, base_, true);
    RenderOptions floats = base_;
    floats.floats = true;
    add_setting("precision", "float", 24.0, floats);
    // It averages triangles only, and a path also follows scattered light.
    if (!is_path_ && config_.frame.structure == "octree" && renderer_->scene.quadrics.empty() &&
        !config_.voxel_cuts.empty()) {
      add_setting("voxel cut", "none", 0.0, base_, true);
      for (const double cut : config_.voxel_cuts) {
        RenderOptions options = base_;
        options.voxel_cut = cut;
        add_setting("voxel cut", fmt::format("{:g} pixels", cut), cut, options);
      }
    }
  }

 private:
  // The settings after one that is exact are held against it.
  Setting& add_setting(std::string way, std::string name, double value, const RenderOptions& options,
                       bool is_exact = false) {
    exact_ = is_exact ? settings_.size() : exact_;
    Setting& setting = settings_.emplace_back();
    setting.asked = image;
    setting.way = std::move(way);
    setting.name = std::move(name);
    setting.value = value;
    setting.exact = exact_;
    setting.run = [renderer = renderer_, options](std::uint32_t) {
      return Answer{0.0, rendered(*renderer, options), ""};
    };
    return setting;
  }

  // Each repeat draws samples of its own, and the exact setting others than all that is held against it.
  void add_samples(std::uint32_t samples, bool is_exact) {
    RenderOptions options = base_;
    options.samples = samples;
    options.seed += is_exact ? config_.repeats : 0;
    Setting& setting = add_setting("samples", fmt::format("{} a pixel", samples), samples, options, is_exact);
    setting.drawn = samples > 1 || is_path_;  // a single camera ray goes through the pixel's centre
    setting.run = [renderer = renderer_, options](std::uint32_t repeat) {
      RenderOptions other = options;
      other.seed += repeat;
      return Answer{0.0, rendered(*renderer, other), ""};
    };
  }

  // By one thread, so that the processor time is that of the rays.
  static processors::program::Image rendered(const Renderer& renderer, const RenderOptions& options) {
    return processors::program::render(renderer.scene, *renderer.triangles, *renderer.structure, options, 1)
        .image;
  }

  const ErrorConfig& config_;
  std::vector<Setting>& settings_;
  std::shared_ptr<const Renderer> renderer_;
  RenderOptions base_;
  bool is_path_;
  std::size_t exact_ = 0;
};

}  // namespace

void add_image_knobs(const ErrorConfig& config, std::vector<Setting>& settings) {
  Knobs(config, settings).add();
}

}  // namespace marti::studies::error
