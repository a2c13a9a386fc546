#include "studies/sweep/ranks/plan_digest.h"

#include "studies/host/program_build.h"
#include "studies/sweep/plan/digest.h"

namespace marti::studies {

std::string digest_of(const SweepPlan& plan) {
  Digest digest;
  digest.add(build_of_program());
  for (const SweepFrame& frame : plan.frames) {
    digest.add(frame.key);
  }
  for (const SweepMachine& machine : plan.machines) {
    digest.add(machine.key);
  }
  return digest.hex();
}

}  // namespace marti::studies
