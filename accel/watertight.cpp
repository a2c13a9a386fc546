#include "accel/watertight.h"

#include "sim/error.h"

namespace marti::accel {

void reject_ray() {
  throw sim::InternalError("a ray's origin and direction must be finite and its direction not zero");
}

bool HitFilter::passes(std::uint32_t triangle, const std::array<double, 3>& weights) const {
  if (!cut_outs_->asks(triangle)) {
    return true;
  }
  const AnyHit hit = cut_outs_->ask(triangle, weights);
  if (listener_ != nullptr) {
    listener_->any_hit(hit);
  }
  return hit.counts;
}

double HitFilter::offer(std::uint32_t gaussian, double limit) const {
  if (listener_ != nullptr) {
    listener_->any_hit({nearest_->record(gaussian), scenes::no_texture, 0, false});
  }
  return nearest_->offer(gaussian, limit);
}

namespace {

// Kahan: a * b - c * d with an error of at most 1.5 ulp, so the sign is exact and zero means zero.
template <class Real>
Real difference_of_products(Real a, Real b, Real c, Real d) {
  using std::fma;
  const Real cd = c * d;
  const Real rounding = fma(-c, d, cd);
  const Real difference = fma(a, b, -cd);
  return difference + rounding;
}

}  // namespace

template <class Real>
EdgeFunctions<Real> accurate_edges(const Sheared<Real>& a, const Sheared<Real>& b, const Sheared<Real>& c) {
  return {difference_of_products(c.x, b.y, c.y, b.x), difference_of_products(a.x, c.y, a.y, c.x),
          difference_of_products(b.x, a.y, b.y, a.x)};
}

template EdgeFunctions<float> accurate_edges(const Sheared<float>&, const Sheared<float>&,
                                             const Sheared<float>&);
template EdgeFunctions<double> accurate_edges(const Sheared<double>&, const Sheared<double>&,
                                              const Sheared<double>&);
template EdgeFunctions<Counted> accurate_edges(const Sheared<Counted>&, const Sheared<Counted>&,
                                               const Sheared<Counted>&);

}  // namespace marti::accel
