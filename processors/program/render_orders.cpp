// The tracer with a bounding volume hierarchy whose nodes are taken in another order than depth first, and
// what rays meet in one, in a file of its own because it compiles that structure once more.
#include "accel/bvh_meets.h"
#include "accel/bvh_order.h"
#include "processors/program/render_rows.h"
#include "sim/key_error.h"

namespace marti::processors::program {

namespace {

template <class Real>
class BvhRayMeets final : public RayMeets {
 public:
  explicit BvhRayMeets(const accel::Bvh& bvh) : meets_(bvh) {}
  void add(const accel::Ray& ray, std::vector<std::uint32_t>& words) override { meets_.add(ray, words); }

 private:
  accel::BvhMeets<Real> meets_;
};

}  // namespace

std::unique_ptr<RayMeets> make_ray_meets(const accel::Bvh& bvh, bool floats) {
  if (floats) {
    return std::make_unique<BvhRayMeets<float>>(bvh);
  }
  return std::make_unique<BvhRayMeets<double>>(bvh);
}

void render_in_order(const scenes::Scene& scene, const accel::Structure& structure, const Emitters& emitters,
                     const RenderOptions& options, unsigned threads, std::vector<LogRow>& rows,
                     Frame& frame) {
  const auto* const bvh = dynamic_cast<const accel::StructureOf<accel::Bvh>*>(&structure);
  if (bvh == nullptr) {
    throw sim::KeyError("rt.order",
                        "only a bvh whose instances are copied can be walked in another order than "
                        "\"depth_first\"");
  }
  if (options.mailboxes) {
    throw sim::KeyError("structure.mailboxes", "do not combine with an rt.order other than \"depth_first\"");
  }
  const accel::OrderedBvh ordered(bvh->concrete(), options.order, options.treelet_records);
  const auto run = [&]<typename Real, typename Recorder>(Real /*which*/, Recorder /*which*/) {
    render_rows<Real, accel::OrderedBvh, Recorder>(scene, ordered, emitters, options, threads, rows, frame);
  };
  const auto in = [&]<typename Real>(Real real) {
    if (options.record) {
      run(real, RowRecorder());
    } else {
      run(real, NullRecorder());
    }
  };
  if (options.floats) {
    in(0.0F);
  } else {
    in(0.0);
  }
}

}  // namespace marti::processors::program
