#include "studies/limits/frame_model.h"

#include <algorithm>
#include <cmath>

#include "studies/limits/service_times.h"

namespace marti::studies {

namespace {

using processors::MachineConfig;

// Parts of the end of a frame in which the number of nodes at work is taken as constant.
constexpr int end_phases = 8;

// A mean number of nodes at work is at least this, so that it can be divided by.
constexpr double least_active = 1e-6;

// Waits are stretched or shortened by at most this factor.
constexpr double most_stretch = 64.0;

double ratio(double measured, double expected) {
  return measured > 0.0 && expected > 0.0 ? measured / expected : 1.0;
}

double scaled(double time, std::int64_t before, std::int64_t after) {
  return before > 0 ? time * static_cast<double>(after) / static_cast<double>(before) : time;
}

double area(const MachineConfig& machine) {
  return static_cast<double>(machine.packets.width) * static_cast<double>(machine.packets.height);
}

}  // namespace

std::optional<FrameModel> FrameModel::of(const MachineConfig& machine, const PointFigures& figures) {
  const bool described = machine.scheme == processors::Scheme::image &&
                         machine.placement == processors::Placement::shared &&
                         machine.build.sharing == processors::Sharing::given && machine.ports_of_node() == 1;
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
  const auto period = [](const MachineConfig& machine) { return machine.clock.period(); };
  work.computing = scaled(work.computing, period(machine_), period(changed));
  work.cache_access = scaled(work.cache_access, period(machine_) * machine_.cache.hit_cycles,
                             period(changed) * changed.cache.hit_cycles);
  return work;
}

double FrameModel::cluster_reads(const FrameWork& work) const {
  return work.reads > 0.0 ? work.reads / machine_.clusters : 1.0;
}

double FrameModel::customers_of(const MachineConfig& machine, double pieces) const {
  const double packets = std::ceil(pieces * figures_.packets / machine.clusters);
  return std::max(1.0, std::min<double>(machine.nodes, packets));
}

void FrameModel::scale() {
  const ServiceTimes times = service_times(machine_);
  const double accesses = figures_.reads + figures_.writes;
  scales_.transfer = ratio(figures_.transfer, figures_.reads * times.transfer);
  scales_.bank_access = ratio(figures_.bank_access, figures_.reads * times.bank_access);
  scales_.interconnect_busy =
      ratio(figures_.interconnect_busy, figures_.reads * times.read_busy() + figures_.writes * times.write);
  scales_.bank_load = ratio(figures_.bank_busy, accesses * times.bank_busy);
  const double even = 1.0 / (static_cast<double>(machine_.banks.count) * machine_.clusters);
  busiest_bank_ = figures_.bank_busy > 0.0 ? figures_.most_bank_busy / figures_.bank_busy : even;
  busiest_bank_ = std::min(1.0, busiest_bank_ * machine_.clusters);
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

void FrameModel::find_phases() {
  const double nodes = machine_.nodes;
  const double customers = customers_of(machine_, 1.0);
  full_time_ = customers < nodes ? 0.0 : std::min(figures_.earliest_finish, figures_.end);
  end_time_ = figures_.end - full_time_;
  const double idle = figures_.idle / machine_.clusters - (nodes - customers) * figures_.end;
  const double at_work = end_time_ > 0.0 ? customers - idle / end_time_ : customers;
  end_active_ = std::clamp(at_work, least_active, customers);
}

double FrameModel::shape_end(const std::vector<double>& throughputs) {
  const double customers = customers_of(machine_, 1.0);
  const double full = throughput_at(throughputs, customers) * full_time_;
  end_.clear();
  if (end_time_ <= 0.0) {
    return full;
  }
  // The number at work is customers * (time that is left / end_time_) ^ exponent.
  const double power = customers / end_active_;
  double falling = 0.0;
  for (int i = 0; i < end_phases; ++i) {
    const double left = 1.0 - static_cast<double>(i) / end_phases;
    const double active =
        customers * end_phases * (std::pow(left, power) - std::pow(left - 1.0 / end_phases, power)) / power;
    end_.push_back({end_time_ / end_phases, std::max(active, least_active)});
    falling += throughput_at(throughputs, end_.back().active) * end_.back().time;
  }
  const double constant = throughput_at(throughputs, end_active_) * end_time_;
  const double more = constant - falling;
  const double missing = cluster_reads(work_) - full - falling;
  const double part = more > 1e-9 * constant ? std::clamp(missing / more, 0.0, 1.0) : 0.0;
  for (Phase& phase : end_) {
    phase.time *= 1.0 - part;
  }
  end_.push_back({end_time_ * part, end_active_});
  return full + std::lerp(falling, constant, part);
}

void FrameModel::find_stretch() {
  constexpr int halvings = 24;
  const QueueModel queues = queues_of(machine_, work_);
  const auto customers = static_cast<std::uint64_t>(customers_of(machine_, 1.0));
  const double wanted = cluster_reads(work_);
  const auto reads_with = [&](double stretch) {
    throughputs_ = throughputs(queues, customers, stretch);
    return shape_end(throughputs_);
  };
  double reads = reads_with(1.0);
  if (std::abs(reads / wanted - 1.0) > 1e-9 && !queues.stations.empty()) {
    double low = 1.0 / most_stretch;
    double high = most_stretch;
    for (int i = 0; i < halvings; ++i) {
      stretch_ = std::sqrt(low * high);
      (reads_with(stretch_) > wanted ? low : high) = stretch_;
    }
    reads = reads_with(stretch_);
  }
  rest_ = reads > 0.0 ? wanted / reads : 1.0;
}

double FrameModel::end_of(const MachineConfig& changed, const FrameWork& work) const {
  const double pieces = area(machine_) / area(changed);
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

}  // namespace marti::studies
