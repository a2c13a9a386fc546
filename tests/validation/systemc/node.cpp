#include "tests/validation/systemc/node.h"

#include <algorithm>

#include "sim/error.h"

namespace marti::oracle {

using memory::RecordKind;
using processors::cost::Activity;
using processors::machine::CacheOrganisation;

Node::Node(const sc_core::sc_module_name& name, Turns& turns, std::uint32_t number,
           const processors::machine::MachineConfig& config, const processors::program::WorkLog& log,
           const Database& database, const processors::cost::StepTicks& ticks)
    : sc_module(name),
      socket("socket"),
      host("host"),
      turns_(turns),
      number_(number),
      config_(config),
      hit_(config.clock.period() * config.cache.hit_cycles),
      program_(log, database, ticks, statistics_.steps) {
  switch (config.cache.organisation) {
    case CacheOrganisation::none:
      break;
    case CacheOrganisation::unified:
      caches_.emplace_back(config.cache.cache, config.cache.cache.size, number);
      break;
    case CacheOrganisation::split:
      for (const std::uint64_t size : config.cache.split_sizes) {
        caches_.emplace_back(config.cache.cache, size, number);
      }
      break;
  }
  socket.register_nb_transport_bw(this, &Node::answer);
  SC_HAS_PROCESS(Node);
  SC_METHOD(start);
  SC_METHOD(work);
  sensitive << awake_;
  dont_initialize();
}

void Node::start() { turns_.ask(Turn::dispatch, number_, *this); }

void Node::begin_packet(const std::optional<Rectangle>& packet) {
  if (!packet) {
    statistics_.finish = now();
    finished_ = true;
    return;
  }
  spend(Activity::dispatch_wait, now() - since_);
  ++statistics_.packets;
  program_.begin(*packet);
  work();
}

// Goes on until time must pass or a shared resource is needed.
void Node::work() {
  for (;;) {
    if (reading_.extent.bytes > 0) {
      if (!refer()) {
        return;
      }
    } else if (next_ < operations_.size()) {
      const Operation& operation = operations_[next_++];
      switch (operation.kind) {
        case Operation::Kind::compute:
          spend(operation.activity, operation.duration);
          if (!sleep(operation.duration)) {
            return;
          }
          break;
        case Operation::Kind::read:
          reading_ = operation;
          break;
        case Operation::Kind::write:
          turns_.ask(Turn::write, number_, *this);
          return;
      }
    } else {
      next_ = 0;
      if (!program_.next_step(operations_)) {
        since_ = now();
        turns_.ask(Turn::dispatch, number_, *this);
        return;
      }
    }
  }
}

// True when no time passes; otherwise work() is called again after it.
bool Node::sleep(Time duration_of_it) {
  if (duration_of_it == 0) {
    return true;
  }
  awake_.notify(duration(duration_of_it));
  return false;
}

// Makes the next reference of the record being read; false when its time must pass.
bool Node::refer() {
  Extent& left = reading_.extent;
  const bool cached = !caches_.empty();
  const std::uint64_t unit = cached ? config_.cache.cache.line : config_.banks.interleave;
  const std::uint64_t address = left.address;
  const std::uint64_t bytes = std::min(left.bytes, (address / unit + 1) * unit - address);
  left = {address + bytes, left.bytes - bytes};
  const auto kind = static_cast<std::size_t>(reading_.record);
  if (cached && look_up(address / unit)) {
    ++statistics_.references.hits[kind];
    spend(Activity::cache_access, hit_);
    return sleep(hit_);
  }
  ++statistics_.references.misses[kind];
  return cached ? miss(address / unit * unit, unit) : miss(address, bytes);
}

bool Node::look_up(std::uint64_t line) {
  std::size_t cache = 0;
  if (caches_.size() > 1) {
    switch (reading_.record) {
      case RecordKind::node:
      case RecordKind::transform:
        cache = 0;
        break;
      case RecordKind::list:
        cache = 1;
        break;
      case RecordKind::primitive:
        cache = 2;
        break;
      case RecordKind::material:
      case RecordKind::texel:
      case RecordKind::pixel:
        cache = 3;
        break;
    }
  }
  return caches_[cache].look_up(line);
}

bool Node::miss(std::uint64_t address, std::uint64_t bytes) {
  if (config_.placement == processors::machine::Placement::replicated) {
    const processors::machine::LocalMemoryConfig& local = config_.local;
    const auto beats = static_cast<std::int64_t>((bytes + local.width - 1) / local.width);
    const Time access = local.clock.period() * local.access_cycles;
    const Time transfer = local.clock.period() * local.cycles_per_beat * beats;
    spend(Activity::bank_access, access);
    spend(Activity::transfer, transfer);
    return sleep(access + transfer);
  }
  missed_ = {address, bytes};
  turns_.ask(Turn::read, number_, *this);
  return false;
}

void Node::take_turn(Turn turn, std::uint32_t /*node*/) {
  switch (turn) {
    case Turn::dispatch:
      host->ask(number_, *this);
      return;
    case Turn::read:
      send(payloads_.take(tlm::TLM_READ_COMMAND, missed_.address, missed_.bytes, number_));
      return;
    case Turn::write:
      if (posted_.size() < config_.write_buffer) {
        write();
      } else {
        waits_for_room_ = true;
        since_ = now();
      }
      return;
    case Turn::reply:
      break;
  }
  throw sim::InternalError("a node has no such turn");
}

void Node::send(tlm::tlm_generic_payload& payload) {
  tlm::tlm_phase phase = tlm::BEGIN_REQ;
  sc_core::sc_time none;
  const tlm::tlm_sync_enum status = socket->nb_transport_fw(payload, phase, none);
  sim::ensure(status == tlm::TLM_UPDATED && phase == tlm::END_REQ, "a request was not taken at once");
}

void Node::write() {
  const Extent& pixel = operations_[next_ - 1].extent;
  tlm::tlm_generic_payload& payload =
      payloads_.take(tlm::TLM_WRITE_COMMAND, pixel.address, pixel.bytes, number_);
  ++statistics_.writes;
  posted_.push_back({&payload, false});
  send(payload);
  work();
}

tlm::tlm_sync_enum Node::answer(tlm::tlm_generic_payload& payload, tlm::tlm_phase& /*phase*/,
                                sc_core::sc_time& /*delay*/) {
  if (payload.is_read()) {
    account(course_of(payload));
    payload.release();
    work();
    return tlm::TLM_COMPLETED;
  }
  last_write_ = now();
  const auto found = std::find_if(posted_.begin(), posted_.end(),
                                  [&payload](const Posted& posted) { return posted.payload == &payload; });
  sim::ensure(found != posted_.end(), "a write is done that nobody posted");
  found->done = true;
  // Room is freed in the order of the writes: a write that is done waits for older ones that are not.
  while (!posted_.empty() && posted_.front().done) {
    posted_.front().payload->release();
    posted_.pop_front();
  }
  if (waits_for_room_ && posted_.size() < config_.write_buffer) {
    waits_for_room_ = false;
    spend(Activity::queue_full_wait, now() - since_);
    turns_.ask(Turn::write, number_, *this);
  }
  return tlm::TLM_COMPLETED;
}

void Node::account(const Course& course) {
  spend(Activity::interconnect_wait, (course.granted - course.asked) + (course.data_start - course.ready));
  spend(Activity::transfer, (course.sent - course.granted) + (course.done - course.data_start));
  spend(Activity::bank_wait, course.bank_start - course.sent);
  spend(Activity::bank_access, course.ready - course.bank_start);
}

}  // namespace marti::oracle
