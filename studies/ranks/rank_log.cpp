#include "studies/ranks/rank_log.h"

#include <cstdint>
#include <limits>

#include "studies/program_build.h"
#include "studies/sweep/digest.h"

namespace marti::studies {

std::string log_bytes(const SweepSite& site, std::size_t frame) {
  const std::string& key = site.plan.frames[frame].key;
  const std::shared_ptr<const FrameLog> log = site.logs.take(key);
  std::string bytes;
  write_log([&](std::string_view piece) { bytes += piece; }, *log, key, build_of_program());
  return bytes;
}

void put_log(const SweepSite& site, std::size_t frame, std::string_view bytes) {
  const std::string& key = site.plan.frames[frame].key;
  const std::unique_ptr<LogSource> source = log_memory_source(bytes, "the work log of another rank");
  site.logs.put(key, read_log(*source, key, build_of_program(), std::numeric_limits<std::uint64_t>::max()));
}

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
