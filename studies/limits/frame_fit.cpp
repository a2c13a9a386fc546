// How a frame model is fitted to the figures of a timed frame.
#include <algorithm>
#include <cmath>

#include "studies/limits/frame_model.h"
#include "studies/limits/service_times.h"

namespace marti::studies::limits {

namespace {

// Parts of the end of a frame in which the number of nodes at work is taken as constant.
constexpr int end_phases = 8;

// A mean number of nodes at work is at least this, so that it can be divided by.
constexpr double least_active = 1e-6;

// Waits are stretched or shortened by at most this factor.
constexpr double most_stretch = 64.0;

double ratio(double measured, double expected) {
  return measured > 0.0 && expected > 0.0 ? measured / expected : 1.0;
}

}  // namespace

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

}  // namespace marti::studies::limits
