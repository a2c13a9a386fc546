#include "processors/replay/machine_parts.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "processors/node/node_array.h"
#include "processors/replay/replay_parts.h"
#include "processors/walk/kept_visits.h"
#include "sim/engine.h"
#include "sim/wait_until.h"

namespace marti::processors::replay {

namespace {

using sim::Ticks;

constexpr Ticks never = std::numeric_limits<Ticks>::max();

// 0 where the host answers at once.
Ticks window_of(const machine::MachineConfig& config) {
  return config.host.assignment == machine::Assignment::dynamic
             ? config.host.clock.cycles(config.host.latency_cycles)
             : never;
}

// Whether victims of the nodes' caches come from streams of random numbers, which are numbered through all
// nodes.
bool draws_victims(const machine::MachineConfig& config) {
  const auto random = [](const memory::CacheConfig& cache) {
    return cache.replacement == memory::Replacement::random;
  };
  return (config.cache.organisation != machine::CacheOrganisation::none && random(config.cache.cache)) ||
         (config.l2.sharing == machine::SecondLevel::private_caches && random(config.l2.cache));
}

// Threads that do a piece of work together again and again, each time only for some microseconds.
class Team {
 public:
  // share(worker, workers) does the share of one of so many workers.
  Team(unsigned threads, std::function<void(unsigned, unsigned)> share) : share_(std::move(share)) {
    for (unsigned worker = 1; worker < threads; ++worker) {
      others_.emplace_back([this, worker] { help(worker); });
    }
  }
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;
  ~Team() {
    begin(0);
    for (std::thread& other : others_) {
      other.join();
    }
  }

  // Returns when the whole work is done, by as many threads as the team has or by the calling one alone.
  void work(unsigned workers) {
    if (workers > 1) {
      begin(workers);
    }
    share_(0, workers);
    sim::wait_until([this] { return working_.load(std::memory_order_acquire) == 0; },
                    [] { std::this_thread::yield(); });
  }

 private:
  // Has the others do their shares, or end if there are no workers.
  void begin(unsigned workers) {
    workers_ = workers;
    working_.store(static_cast<unsigned>(others_.size()), std::memory_order_relaxed);
    number_.fetch_add(1, std::memory_order_release);
    number_.notify_all();
  }
  void help(unsigned worker) {
    for (std::uint32_t number = 0;; ++number) {
      sim::wait_until([&] { return number_.load(std::memory_order_acquire) != number; },
                      [&] { number_.wait(number, std::memory_order_acquire); });
      if (workers_ == 0) {
        return;
      }
      share_(worker, workers_);
      working_.fetch_sub(1, std::memory_order_acq_rel);
    }
  }

  std::function<void(unsigned, unsigned)> share_;
  unsigned workers_ = 0;
  alignas(64) std::atomic<std::uint32_t> number_ = 0;  // of the piece of work
  alignas(64) std::atomic<unsigned> working_ = 0;      // others that have not done their shares
  std::vector<std::thread> others_;
};

// Whether threads work together. On a computer with other work they may wait for each other longer than they
// save: then one goes on alone, for twice as long each time that trying again was of no use.
class Pace {
 public:
  [[nodiscard]] bool together() const { return together_; }

  // A window is over, with so many events in all.
  void count(std::uint64_t events) {
    const auto now = std::chrono::steady_clock::now();
    if (++windows_ < most_windows && now - since_ < longest) {
      return;
    }
    const double pace = static_cast<double>(events - events_) /
                        std::max(1e-9, std::chrono::duration<double>(now - since_).count());
    if (together_) {
      decide(pace);
    } else {
      alone_ = pace;
      together_ = rest_ == 0 || --rest_ == 0;
    }
    windows_ = 0;
    events_ = events;
    since_ = std::chrono::steady_clock::now();
  }

 private:
  // After a stretch of some windows, and not much time, that threads have worked together.
  void decide(double pace) {
    if (pace < clearly_less * alone_) {
      together_ = false;
      rest_ = next_rest_;
      next_rest_ = std::min(2 * next_rest_, longest_rest);
      stretches_ = 0;
    } else if (stretches_++ % looks_again == 0) {
      together_ = false;  // for one stretch, to know how fast one thread is
      if (stretches_ > 1) {
        next_rest_ = shortest_rest;
      }
    }
  }

  // Stretches of a frame differ in how much an event takes.
  static constexpr double clearly_less = 0.6;
  static constexpr std::uint32_t most_windows = 64;
  static constexpr std::chrono::milliseconds longest{2};
  static constexpr std::uint32_t looks_again = 64;  // stretches
  static constexpr std::uint32_t shortest_rest = 64;
  static constexpr std::uint32_t longest_rest = 1U << 14U;

  bool together_ = true;
  double alone_ = 0.0;  // events a second of one thread
  std::uint32_t stretches_ = 0;
  std::uint32_t rest_ = 0;  // stretches that one thread goes on alone
  std::uint32_t next_rest_ = shortest_rest;
  std::uint32_t windows_ = 0;
  std::uint64_t events_ = 0;
  std::chrono::steady_clock::time_point since_ = std::chrono::steady_clock::now();
};

// Clusters in a row with all that only they use.
struct alignas(64) Part {
  Part(const walk::ReplayInput& whole, std::uint32_t first_cluster, std::uint32_t clusters)
      : config(whole.config), input(whole.with_config(config)) {
    config.clusters = clusters;
    place.first_node = first_cluster * config.nodes;
    place.asks_later = config.host.assignment == machine::Assignment::dynamic;
    input.part = &place;
  }
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;

  // The place in the whole machine's order of an event of this part, whose components are counted from the
  // part's first node.
  [[nodiscard]] sim::Event of_whole(sim::Event event) const {
    event.order += std::uint64_t{place.first_node} << sim::sequence_bits;
    return event;
  }

  machine::MachineConfig config;
  walk::MachinePart place;
  walk::ReplayInput input;
  sim::Engine engine;
  std::unique_ptr<node::NodeArray> nodes;
  Interconnects interconnects;
  std::vector<std::pair<std::uint32_t, std::optional<node::Grant>>> grants;  // of the window before
  std::exception_ptr fault;
};

class MachineParts {
 public:
  MachineParts(const walk::ReplayInput& input, node::Host& host, const Division& division)
      : input_(input), host_(host), threads_(division.threads), window_(division.window) {
    if (input_.visits == nullptr) {
      input_.visits = &visits_;  // planned once for all parts
    }
    const auto first_of = [&](unsigned part) {
      return static_cast<std::uint32_t>(std::uint64_t{input.config.clusters} * part / division.parts);
    };
    for (unsigned number = 0; number < division.parts; ++number) {
      const std::uint32_t first = first_of(number);
      Part& part = *parts_.emplace_back(std::make_unique<Part>(input_, first, first_of(number + 1) - first));
      part.engine.reserve_for(part.config.all_nodes());
      part.nodes = node::make_node_array(part.input, part.engine, host_);
      part.interconnects =
          connect_memory(part.config, part.engine, static_cast<std::uint8_t>(node::EventClass::memory),
                         *part.nodes, nullptr, nullptr);
    }
  }

  void run(std::uint64_t start_seed) {
    for (const auto& part : parts_) {
      part->nodes->start(start_seed);
    }
    end_window();
    Team team(threads_, [this](unsigned worker, unsigned workers) {
      for (std::size_t number = worker; number < parts_.size(); number += workers) {
        go_on(*parts_[number]);
      }
    });
    for (Pace pace; !done_; pace.count(events())) {
      team.work(pace.together() ? threads_ : 1);
      end_window();
    }
    if (fault_ != nullptr) {
      std::rethrow_exception(fault_);
    }
  }

  MachineResult result() {
    Ticks end = 0;
    for (const auto& part : parts_) {
      end = std::max(end, part->nodes->end());
    }
    MachineResult whole;
    for (const auto& part : parts_) {
      part->nodes->end_not_before(end);
      part->nodes->finish();
      add(common_result(part->config, part->engine, *part->nodes, part->interconnects, input_.layout, end),
          whole);
    }
    return whole;
  }

 private:
  // To the end of the window.
  void go_on(Part& part) const {
    try {
      for (const auto& [node, grant] : part.grants) {
        part.nodes->grant(node, grant);
      }
      part.grants.clear();
      part.nodes->run_before(part.engine, window_end_);
    } catch (...) {
      part.fault = std::current_exception();
    }
  }

  [[nodiscard]] std::uint64_t events() const {
    std::uint64_t sum = 0;
    for (const auto& part : parts_) {
      sum += part->engine.events();
    }
    return sum;
  }

  // At the end of a window, while no part goes on. The next window begins with the first that is left to do.
  void end_window() noexcept {
    try {
      bool answered = false;
      Ticks begin = never;
      answer_requests([&](Part& part, const walk::PacketRequest& request) {
        const std::optional<node::Grant> grant =
            host_.next(part.place.first_node + request.node, request.turn.time);
        part.grants.emplace_back(request.node, grant);
        begin = std::min(begin, grant ? grant->start : never);
        answered = true;
      });
      for (const auto& part : parts_) {
        begin = std::min(begin, part->engine.next_time());
        if (part->fault != nullptr && fault_ == nullptr) {
          fault_ = part->fault;
        }
      }
      window_end_ = begin > never - window_ ? never : begin + window_;
      done_ = fault_ != nullptr || (begin == never && !answered);
    } catch (...) {
      fault_ = std::current_exception();
      done_ = true;
    }
  }

  // Calls answer(part, request) for the requests of all parts, each part's in the order in which they were
  // made, in the order of the whole machine.
  template <class Answer>
  void answer_requests(const Answer& answer) {
    struct Head {
      Part* part;
      std::size_t next;
      sim::Event turn;
    };
    std::vector<Head> heads;
    for (const auto& part : parts_) {
      if (!part->place.requests.empty()) {
        heads.push_back({part.get(), 0, part->of_whole(part->place.requests.front().turn)});
      }
    }
    while (!heads.empty()) {
      const auto head = std::min_element(heads.begin(), heads.end(), [](const Head& one, const Head& other) {
        return one.turn < other.turn;
      });
      std::vector<walk::PacketRequest>& requests = head->part->place.requests;
      answer(*head->part, requests[head->next]);
      if (++head->next != requests.size()) {
        head->turn = head->part->of_whole(requests[head->next].turn);
      } else {
        requests.clear();
        heads.erase(head);
      }
    }
  }

  void add(MachineResult part, MachineResult& whole) const {
    if (whole.nodes.empty()) {
      whole = std::move(part);
      whole.copies = input_.config.placement == machine::Placement::replicated ? input_.config.all_nodes()
                                                                               : input_.config.clusters;
      return;
    }
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    append(whole.nodes, part.nodes);
    append(whole.clusters, part.clusters);
    append(whole.l2.caches, part.l2.caches);
    append(whole.l2.waits, part.l2.waits);
    whole.events += part.events;
  }

  walk::ReplayInput input_;
  walk::KeptVisits visits_;
  node::Host& host_;
  unsigned threads_;
  Ticks window_;
  std::vector<std::unique_ptr<Part>> parts_;
  Ticks window_end_ = 0;
  bool done_ = false;
  std::exception_ptr fault_;
};

}  // namespace

const char* why_no_parts(const machine::MachineConfig& config, std::uint32_t fewest_nodes) {
  return config.scheme != machine::Scheme::image ? "rays move between nodes"
         : config.clusters == 1                  ? "its nodes share a memory or a network"
         : window_of(config) == 0                ? "the host answers at once"
         : draws_victims(config)                 ? "its caches replace lines at random"
         : config.all_nodes() < fewest_nodes     ? "it has few nodes"
                                                 : nullptr;
}

std::optional<Division> division_of(const walk::ReplayInput& input, unsigned threads, unsigned parts,
                                    std::uint32_t fewest_nodes) {
  // Several parts a thread even out how long these take, and more of what a part uses stays in the host's
  // caches until its window ends.
  constexpr unsigned parts_a_thread = 8;
  const unsigned wanted = parts != 0 ? parts : threads < 2 ? 1 : parts_a_thread * threads;
  const unsigned used = std::min(wanted, input.config.clusters);
  if (used < 2 || why_no_parts(input.config, fewest_nodes) != nullptr || !node::can_be_parts(input)) {
    return std::nullopt;
  }
  return Division{used, std::min(threads, used), window_of(input.config)};
}

MachineResult replay_parts(const walk::ReplayInput& input, node::Host& host, const Division& division,
                           std::uint64_t start_seed) {
  MachineParts parts(input, host, division);
  parts.run(start_seed);
  return parts.result();
}

}  // namespace marti::processors::replay
