#include "studies/error/rendering.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <random>

#include <fmt/format.h>

#include "processors/replay/replay.h"
#include "scenes/open.h"
#include "sim/error.h"
#include "studies/host/cpu_time.h"
#include "studies/host/image_file.h"
#include "studies/run/functional_run.h"
#include "studies/run/open_frame.h"

namespace marti::studies::error {

namespace {

using processors::program::Frame;
using processors::program::Image;
using processors::program::RenderOptions;

class Measurement {
 public:
  Measurement(const keys::FrameConfig& frame, const RenderingErrorOptions& options)
      : frame_(frame),
        options_(options),
        scene_(run::open_frame(frame)),
        triangles_(std::make_shared<const accel::TriangleSet>(scene_)) {
    study_.scene = frame.scene;
    study_.plan = plan_rendering(frame, options, scene_);
    for (const StructurePlan& plan : study_.plan.structures) {
      structures_.push_back(accel::make_structure(plan.kind, triangles_, plan.options));
    }
    refuse_too_large();
  }

  RenderingStudy run() {
    make_references();
    for (const RenderingSetting& setting : study_.plan.settings) {
      study_.points.push_back({setting, {}, false, {}, {}});
    }
    sim::begin_part(frame_.meter, "rendering each setting", "settings", study_.points.size());
    for (RenderingPoint& point : study_.points) {
      look_at(point);
      sim::count_step(frame_.meter);
    }
    std::mt19937_64 random(study_.plan.base.seed);
    std::vector<std::size_t> order(study_.points.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    sim::begin_part(frame_.meter, "measuring run times", "renderings", order.size() * options_.repeats);
    for (std::uint32_t repeat = 0; repeat < options_.repeats; ++repeat) {
      std::ranges::shuffle(order, random);
      for (const std::size_t point : order) {
        time(study_.points[point], repeat);
        sim::count_step(frame_.meter);
      }
    }
    for (RenderingPoint& point : study_.points) {
      finish(point);
    }
    return std::move(study_);
  }

 private:
  // The image that a knob's settings are compared with, and its noise floor.
  struct Reference {
    Image image;
    double floor = 0.0;
  };
  // What the timed repeats of a setting found.
  struct Found {
    double squares = 0.0;
    double relative_squares = 0.0;
    double rel_mse = 0.0;
    std::uint64_t hash = 0;
  };

  void refuse_too_large() const {
    for (const RenderingSetting& setting : study_.plan.settings) {
      keys::FrameConfig frame = frame_;
      frame.render = setting.render;
      run::refuse_beyond_memory(frame, scene_, *triangles_, *structures_[setting.structure]);
    }
  }

  [[nodiscard]] Frame render(const RenderingSetting& setting, const RenderOptions& options,
                             unsigned threads) const {
    return processors::program::render(scene_, *triangles_, *structures_[setting.structure], options,
                                       threads);
  }

  // ---- References.

  // The mean of as many renderings as the samples need; `number` tells independent references apart.
  [[nodiscard]] Image sampled_reference(std::uint32_t number) const {
    RenderOptions options = study_.plan.base;
    const std::uint32_t parts = (options_.reference_samples - 1) / processors::program::max_samples + 1;
    options.samples = (options_.reference_samples - 1) / parts + 1;
    std::vector<Vec> sums(std::size_t{options.width} * options.height);
    Image mean;
    for (std::uint32_t part = 0; part < parts; ++part) {
      options.seed = reference_seed(number * parts + part);
      mean = processors::program::render(scene_, *triangles_, *structures_[0], options).image;
      for (std::size_t i = 0; i < sums.size(); ++i) {
        for (std::size_t channel = 0; channel < 3; ++channel) {
          sums[i][channel] += static_cast<double>(mean.pixels[i][static_cast<int>(channel)]);
        }
      }
    }
    for (std::size_t i = 0; i < sums.size(); ++i) {
      for (std::size_t channel = 0; channel < 3; ++channel) {
        mean.pixels[i][static_cast<int>(channel)] = static_cast<float>(sums[i][channel] / parts);
      }
    }
    return mean;
  }

  void make_references() {
    const RenderOptions& base = study_.plan.base;
    Reference& sampled = references_[Knob::samples];
    sampled.image = sampled_reference(0);
    sampled.floor = run::image_error(sampled_reference(1), sampled.image).rmse / std::sqrt(2.0);
    study_.reference_samples = options_.reference_samples;
    study_.reference_level = root_mean_square(sampled.image);
    study_.noise_floor = sampled.floor;
    RenderOptions deep = base;
    deep.max_depth = options_.reference_depth;
    references_[Knob::depth].image = render_base(deep);
    RenderOptions all = deep;
    all.min_weight = 0.0;
    references_[Knob::weight].image = render_base(all);
    for (const Knob knob : {Knob::precision, Knob::voxel_cut, Knob::exact}) {
      references_[knob].image = render_base(base);
    }
  }

  [[nodiscard]] Image render_base(const RenderOptions& options) const {
    return processors::program::render(scene_, *triangles_, *structures_[0], options).image;
  }

  // ---- Settings.

  // References have other seeds than the measured renderings.
  [[nodiscard]] std::uint64_t reference_seed(std::uint32_t number) const {
    return study_.plan.base.seed + options_.repeats + number;
  }
  [[nodiscard]] RenderOptions options_of(const RenderingSetting& setting, std::uint32_t repeat) const {
    RenderOptions options = setting.render;
    options.seed += setting.knob == Knob::samples ? repeat : 0;
    return options;
  }

  // The counted work, and the first image's errors.
  void look_at(RenderingPoint& point) {
    RenderOptions options = options_of(point.setting, 0);
    options.record = true;
    const Frame frame = render(point.setting, options, 0);
    point.work = processors::program::totals_of(*frame.log);
    const Reference& reference = references_.at(point.setting.knob);
    point.errors = rendering_errors(frame.image, reference.image);
    if ((point.setting.knob == Knob::exact || point.setting.reference) && point.errors.first) {
      const std::size_t first = *point.errors.first;
      throw sim::InternalError(fmt::format(
          "{} ({}) must not change the image, and does: {} of {} pixels, the first at column {}, row {}",
          knob_names[static_cast<std::size_t>(point.setting.knob)], point.setting.name,
          point.errors.plain.changed, frame.image.pixels.size(), first % options.width,
          first / options.width));
    }
    found_.push_back({0.0, 0.0, 0.0, run::image_hash(frame.image)});
  }

  void time(RenderingPoint& point, std::uint32_t repeat) {
    const RenderOptions options = options_of(point.setting, repeat);
    const double before = host::process_cpu_seconds();
    const Frame frame = render(point.setting, options, 1);
    if (point.setting.machine) {
      static_cast<void>(processors::replay::replay(*frame.log, *point.setting.machine));
    }
    point.cpu_ms.push_back(1e3 * (host::process_cpu_seconds() - before));
    Found& found = found_[static_cast<std::size_t>(&point - study_.points.data())];
    const bool drawn = point.setting.knob == Knob::samples && options.samples > 1;
    if (!(drawn && repeat != 0) && run::image_hash(frame.image) != found.hash) {
      throw sim::InternalError("a rendering differs when it is repeated: " + point.setting.name);
    }
    if (drawn) {
      const RenderingErrors errors = rendering_errors(frame.image, references_.at(point.setting.knob).image);
      found.squares += errors.plain.rmse * errors.plain.rmse;
      found.relative_squares += errors.relative * errors.relative;
      found.rel_mse += errors.rel_mse;
    }
  }

  void finish(RenderingPoint& point) const {
    const Found& found = found_[static_cast<std::size_t>(&point - study_.points.data())];
    if (point.setting.knob == Knob::samples && point.setting.render.samples > 1) {
      const double repeats = options_.repeats;
      point.errors.plain.rmse = std::sqrt(found.squares / repeats);
      point.errors.relative = std::sqrt(found.relative_squares / repeats);
      point.errors.rel_mse = found.rel_mse / repeats;
    }
    const double floor = references_.at(point.setting.knob).floor;
    point.below_floor = floor > 0.0 && point.errors.plain.rmse <= floor;
  }

  using Vec = std::array<double, 3>;

  const keys::FrameConfig& frame_;
  const RenderingErrorOptions& options_;
  scenes::Scene scene_;
  std::shared_ptr<const accel::TriangleSet> triangles_;
  std::vector<std::unique_ptr<accel::Structure>> structures_;
  std::map<Knob, Reference> references_;
  std::vector<Found> found_;
  RenderingStudy study_;
};

}  // namespace

RenderingStudy measure_rendering(const keys::FrameConfig& frame, const RenderingErrorOptions& options) {
  return Measurement(frame, options).run();
}

tables::StudyOutput rendering_error(const keys::FrameConfig& frame, const RenderingErrorOptions& options) {
  return output_of(measure_rendering(frame, options));
}

}  // namespace marti::studies::error
