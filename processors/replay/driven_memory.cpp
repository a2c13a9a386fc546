#include "processors/replay/driven_memory.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>
#include <vector>

#include "processors/energy/energy.h"
#include "processors/node/memory_system.h"
#include "processors/replay/energy_counts.h"
#include "processors/replay/replay_parts.h"
#include "processors/walk/lines_under_way.h"
#include "processors/walk/node_caches.h"
#include "processors/walk/second_level.h"
#include "sim/engine.h"
#include "sim/key_error.h"

namespace marti::processors::replay {

namespace {

// Requests are made after the replies of an instant and before the memory's own events, as nodes make them.
enum class DrivenEvent : std::uint8_t { freed_read, freed_write, reply, ask, memory };

// The private caches of all nodes, and the lines that are on their way to them, each brought by a port.
class DrivenCaches {
 public:
  DrivenCaches(const machine::MachineConfig& config, std::uint32_t ports)
      : line_shift_(static_cast<unsigned>(std::countr_zero(config.cache.cache.line))),
        hit_ticks_(config.clock.cycles(config.cache.hit_cycles)),
        tags_(config),
        second_level_(config),
        lines_(config.nodes),
        done_(ports),
        waiting_(ports) {}

  /// Looks a read up that a port makes at `now`; counts it. Returns when its data are there; walk::never if
  /// the line is on its way: then arrives() says so. Nothing: the port has to ask for the line.
  std::optional<sim::Ticks> read(const DrivenRequest& request, std::uint32_t port, sim::Ticks now,
                                 cost::ReferenceCounts& counts) {
    const walk::AnyCaches::View view = tags_.view(request.node);
    const auto line = static_cast<std::uint32_t>(request.address >> line_shift_);
    const auto key = walk::LinesUnderWay::Key{view.cache_of(request.kind)} << 32U | line;
    walk::LinesUnderWay& lines = lines_[request.node];
    const bool held = view.access(request.kind, line);
    const std::uint32_t brings = lines.find(key, now);
    const bool under_way = brings != walk::LinesUnderWay::none;
    ++(held || under_way ? counts.hits : counts.misses)[static_cast<std::size_t>(request.kind)];
    if (under_way && done_[brings] == walk::never) {
      waiting_[brings].push_back(port);
      return walk::never;
    }
    if (held || under_way) {
      const sim::Ticks hit = sim::add_ticks(now, hit_ticks_);
      return under_way ? std::max(done_[brings], hit) : hit;
    }
    lines.begin(key, port, now);
    done_[port] = walk::never;
    if (const std::optional<sim::Ticks> hit = second_level_.hit(request.node, line)) {
      (void)arrives(request.node, port, sim::add_ticks(now, *hit));
      return done_[port];
    }
    return std::nullopt;
  }
  /// The line that a port has asked for is there at `done`. Returns the ports that have waited for it.
  std::vector<std::uint32_t> arrives(std::uint32_t node, std::uint32_t port, sim::Ticks done) {
    lines_[node].arrives(port, done);
    done_[port] = done;
    return std::exchange(waiting_[port], {});
  }
  [[nodiscard]] const walk::PrivateSecondLevel& second_level() const { return second_level_; }

 private:
  unsigned line_shift_;
  sim::Ticks hit_ticks_;
  walk::AnyCaches tags_;
  walk::PrivateSecondLevel second_level_;
  std::vector<walk::LinesUnderWay> lines_;           // of each node
  std::vector<sim::Ticks> done_;                     // when the line of each port is there
  std::vector<std::vector<std::uint32_t>> waiting_;  // for the line of each port
};

class Driver final : public memory::InterconnectClient, public sim::EventHandler {
 public:
  Driver(const machine::MachineConfig& config, const DrivenOptions& options, const NextRequest& next)
      : options_(options),
        next_(next),
        ports_(config.nodes * options.outstanding),
        write_buffer_(config.write_buffer),
        free_reads_(config.nodes),
        writes_(config.nodes),
        came_(ports_),
        line_bytes_(config.reference_bytes()),
        memory_(node::make_memory_system(config, {engine_, *this, class_of(DrivenEvent::reply), 0, ports_,
                                                  class_of(DrivenEvent::memory), true})) {
    if (options.caches) {
      caches_.emplace(config, ports_);
    }
    for (std::uint32_t port = ports_; port-- > 0;) {
      free_reads_[port / options.outstanding].push_back(port);
    }
    for (std::uint8_t c = 0; c <= class_of(DrivenEvent::memory); ++c) {
      engine_.attach(c, *this);
    }
  }

  DrivenResult run() {
    post_ask(0);
    engine_.run(std::numeric_limits<std::uint64_t>::max());
    sim::ensure(!has_request_ && in_flight_ == 0, "a memory has not served all requests");
    result_.machine.end = end_;
    add_cluster(*memory_, end_, result_.machine);
    if (caches_ && caches_->second_level().present()) {
      result_.machine.l2 = caches_->second_level().result();
    }
    result_.machine.events = engine_.events();
    return std::move(result_);
  }

  void handle(const sim::Event& event) override {
    const std::uint32_t component = event.component();
    switch (static_cast<DrivenEvent>(event.event_class())) {
      case DrivenEvent::ask:
        advance();
        return;
      case DrivenEvent::freed_read:
        --in_flight_;
        free_reads_[component / options_.outstanding].push_back(component);
        break;
      case DrivenEvent::freed_write:
        --in_flight_;
        --writes_[component];
        break;
      case DrivenEvent::reply:
        memory_->reply(component);
        return;
      case DrivenEvent::memory:
        memory_->proceed(component, event.sequence());
        return;
    }
    if (waits_) {
      waits_ = false;
      post_ask(engine_.now());
    }
  }

  void read_done(std::uint32_t port, const memory::Service& service) override {
    finish_read(port, service.done);
    if (caches_) {
      for (const std::uint32_t waiting : caches_->arrives(port / options_.outstanding, port, service.done)) {
        finish_read(waiting, service.done);
      }
    }
  }
  void write_done(std::uint32_t port, sim::Ticks done) override {
    free_at(done, DrivenEvent::freed_write, port / options_.outstanding);
  }

 private:
  static constexpr std::uint8_t class_of(DrivenEvent event) { return static_cast<std::uint8_t>(event); }

  void finish_read(std::uint32_t port, sim::Ticks done) {
    result_.latency.add(done - came_[port]);
    free_at(done, DrivenEvent::freed_read, port);
  }
  void free_at(sim::Ticks done, DrivenEvent event, std::uint32_t component) {
    end_ = std::max(end_, done);
    engine_.post(sim::Event::make(std::max(done, engine_.now()), class_of(event), component, 0));
  }

  void post_ask(sim::Ticks time) { engine_.post(sim::Event::make(time, class_of(DrivenEvent::ask), 0, 0)); }

  // Asks for the next request if it has come and has a place. The one behind it has an event of its own: what
  // the memory replies at this instant comes between them, as it does between nodes.
  void advance() {
    if (!has_request_) {
      has_request_ = next_(request_);
      if (!has_request_) {
        return;
      }
    }
    if (options_.timed && request_.time > engine_.now()) {
      post_ask(request_.time);
      return;
    }
    waits_ = request_.write ? writes_[request_.node] == write_buffer_ : free_reads_[request_.node].empty();
    if (!waits_) {
      ask();
      has_request_ = false;
      post_ask(engine_.now());
    }
  }

  void ask() {
    if (options_.meter != nullptr) {
      options_.meter->count();
    }
    ++in_flight_;
    result_.late += options_.timed && request_.time < engine_.now() ? 1 : 0;
    if (request_.write) {
      ++writes_[request_.node];
      memory_->write({request_.node * options_.outstanding, request_.address, request_.bytes});
      return;
    }
    const std::uint32_t port = free_reads_[request_.node].back();
    free_reads_[request_.node].pop_back();
    came_[port] = options_.timed ? request_.time : engine_.now();
    if (!caches_) {
      memory_->read({port, request_.address, request_.bytes});
      return;
    }
    const std::optional<sim::Ticks> there = caches_->read(request_, port, engine_.now(), result_.references);
    if (!there) {
      memory_->read({port, request_.address / line_bytes_ * line_bytes_, line_bytes_});
    } else if (*there != walk::never) {
      finish_read(port, *there);
    }
  }

  DrivenOptions options_;
  const NextRequest& next_;
  sim::Engine engine_;
  std::uint32_t ports_;
  std::uint32_t write_buffer_;
  std::vector<std::vector<std::uint32_t>> free_reads_;  // of each node, its ports that read nothing
  std::vector<std::uint32_t> writes_;                   // of each node, under way
  std::vector<sim::Ticks> came_;                        // of the read of each port
  std::uint32_t line_bytes_;
  std::optional<DrivenCaches> caches_;
  std::unique_ptr<memory::Interconnect> memory_;
  DrivenRequest request_;  // the next one
  bool has_request_ = false;
  bool waits_ = false;  // for a place
  std::uint64_t in_flight_ = 0;
  sim::Ticks end_ = 0;
  DrivenResult result_;
};

}  // namespace

DrivenResult drive_memory(const machine::MachineConfig& config, const DrivenOptions& options,
                          const NextRequest& next) {
  if (config.placement != machine::Placement::shared) {
    throw sim::KeyError("database.placement", "only a shared memory can be driven by itself");
  }
  if (config.scheme == machine::Scheme::space) {
    throw sim::KeyError("machine.scheme",
                        "only a shared memory can be driven by itself, and each node has its own");
  }
  if (options.caches && config.cache.organisation == machine::CacheOrganisation::none) {
    throw sim::KeyError("cache.organisation", "there are no caches that a trace could go through");
  }
  constexpr std::uint64_t most_places = std::uint64_t{1} << 24U;
  if (std::uint64_t{config.nodes} * options.outstanding > most_places) {
    throw sim::KeyError("machine.nodes", "the nodes have more than 2^24 places for requests together");
  }
  energy::check_energy(config);
  DrivenResult driven = Driver(config, options, next).run();
  if (config.energy.on()) {
    driven.machine.energy = energy::energy_of_accesses(config, energy_counts(config, driven));
  }
  return driven;
}

}  // namespace marti::processors::replay
