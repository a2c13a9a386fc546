#include "processors/replay/driven_memory.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "processors/node/memory_system.h"
#include "processors/replay/replay_parts.h"
#include "sim/engine.h"
#include "sim/key_error.h"

namespace marti::processors::replay {

namespace {

// Requests are made after the replies of an instant and before the memory's own events, as nodes make them.
enum class DrivenEvent : std::uint8_t { freed_read, freed_write, reply, ask, memory };

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
        memory_(node::make_memory_system(config, {engine_, *this, class_of(DrivenEvent::reply), 0, ports_,
                                                  class_of(DrivenEvent::memory), true})) {
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
    result_.latency.add(service.done - came_[port]);
    free_at(service.done, DrivenEvent::freed_read, port);
  }
  void write_done(std::uint32_t port, sim::Ticks done) override {
    free_at(done, DrivenEvent::freed_write, port / options_.outstanding);
  }

 private:
  static constexpr std::uint8_t class_of(DrivenEvent event) { return static_cast<std::uint8_t>(event); }

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
    memory_->read({port, request_.address, request_.bytes});
  }

  DrivenOptions options_;
  const NextRequest& next_;
  sim::Engine engine_;
  std::uint32_t ports_;
  std::uint32_t write_buffer_;
  std::vector<std::vector<std::uint32_t>> free_reads_;  // of each node, its ports that read nothing
  std::vector<std::uint32_t> writes_;                   // of each node, under way
  std::vector<sim::Ticks> came_;                        // of the read of each port
  std::unique_ptr<memory::Interconnect> memory_;
  walk::Request request_;  // the next one
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
  constexpr std::uint64_t most_places = std::uint64_t{1} << 24U;
  if (std::uint64_t{config.nodes} * options.outstanding > most_places) {
    throw sim::KeyError("machine.nodes", "the nodes have more than 2^24 places for requests together");
  }
  return Driver(config, options, next).run();
}

}  // namespace marti::processors::replay
