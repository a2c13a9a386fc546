#include "studies/limits/frame_model.h"

#include <algorithm>
#include <cmath>

#include "studies/limits/service_times.h"

namespace marti::studies::limits {

namespace {

using processors::machine::MachineConfig;

double scaled(double time, double before, double after) {
  return before > 0.0 ? time * after / before : time;
}

}  // namespace

double packet_area(const MachineConfig& machine) {
  return static_cast<double>(machine.packets.width) * static_cast<double>(machine.packets.height);
}

std::optional<FrameModel> FrameModel::of(const MachineConfig& machine, const PointFigures& figures) {
  const bool described = machine.scheme == processors::machine::Scheme::image &&
                         machine.placement == processors::machine::Placement::shared &&
                         machine.build.sharing == processors::machine::Sharing::given &&
                         machine.ports_of_node() == 1 && !machine.banks.dram;
  const double work = figures.computing + figures.cache_access + figures.delays;
  if (!described || figures.end <= 0.0 || figures.packets <= 0.0 || work <= 0.0 ||
      machine.nodes > most_customers) {
    return std::nullopt;
  }
  return FrameModel(machine, figures);
}

FrameModel::FrameModel(const MachineConfig& machine, const PointFigures& figures)
    : machine_(machine),
      figures_(figures),
      work_{figures.computing, figures.cache_access, figures.delays, figures.reads, figures.writes} {
  scale();
  find_phases();
  find_stretch();
}

FrameWork FrameModel::work_on(const MachineConfig& changed) const {
  FrameWork work = work_;
  const auto period = [](const MachineConfig& machine) {
    return static_cast<double>(machine.clock.period());
  };
  const auto hit = [&](const MachineConfig& machine) {
    return period(machine) * static_cast<double>(machine.cache.hit_cycles);
  };
  work.computing = scaled(work.computing, period(machine_), period(changed));
  work.cache_access = scaled(work.cache_access, hit(machine_), hit(changed));
  return work;
}

double FrameModel::cluster_reads(const FrameWork& work) const {
  return work.reads > 0.0 ? work.reads / machine_.clusters : 1.0;
}

double FrameModel::customers_of(const MachineConfig& machine, double pieces) const {
  const double packets = std::ceil(pieces * figures_.packets / machine.clusters);
  return std::max(1.0, std::min<double>(machine.nodes, packets));
}

QueueModel FrameModel::queues_of(const MachineConfig& machine, const FrameWork& work) const {
  QueueModel model;
  const double local = work.computing + work.cache_access + work.delays;
  if (work.reads <= 0.0) {
    model.think = local / machine_.clusters;
    return model;
  }
  const ServiceTimes times = service_times(machine);
  model.think =
      local / work.reads + scales_.transfer * times.transfer + scales_.bank_access * times.bank_access;
  const double writes = work.writes / work.reads;
  const double busy = scales_.interconnect_busy;
  for (Station station : interconnect_stations(machine, writes)) {
    station.service *= busy;
    station.half_square *= busy * busy;
    model.stations.push_back(station);
  }
  if (times.bank_busy > 0.0 && times.held <= 0.0) {
    // A held bus serves for its banks. Each bank gets its share of the accesses; more banks share them in the
    // same proportions.
    const double banks = machine.banks.count;
    const double first = std::clamp(busiest_bank_ * machine_.banks.count / banks, 1.0 / banks, 1.0);
    const auto bank = [&](double share, double waits) {
      model.stations.push_back({scales_.bank_load * (1.0 + writes) * share, waits, times.bank_busy,
                                times.bank_busy * times.bank_busy / 2.0});
    };
    bank(first, first);
    if (banks > 1.0) {
      bank((1.0 - first) / (banks - 1.0), 1.0 - first);
    }
  }
  return model;
}

double FrameModel::end_of(const MachineConfig& changed, const FrameWork& work) const {
  const double pieces = packet_area(machine_) / packet_area(changed);
  const double before = customers_of(machine_, 1.0);
  const double after = customers_of(changed, pieces);
  const std::vector<double> rates =
      throughputs(queues_of(changed, work), static_cast<std::uint64_t>(std::max(before, after)), stretch_);
  const double reads = cluster_reads(work);
  // The last packets take as many reads of a node as before, or fewer where they are smaller.
  const double each = reads / cluster_reads(work_) / pieces;
  double end = 0.0;
  double done = 0.0;
  for (const Phase& phase : end_) {
    const double active = phase.active * after / before;
    const double rate = throughput_at(rates, active);
    const double cycle_before = phase.active / throughput_at(throughputs_, phase.active);
    const double time = phase.time * each * (active / rate) / cycle_before;
    end += time;
    done += rate * time * rest_;
  }
  if (done >= reads) {
    return end * reads / done;
  }
  return end + (reads - done) / (throughput_at(rates, after) * rest_);
}

}  // namespace marti::studies::limits
