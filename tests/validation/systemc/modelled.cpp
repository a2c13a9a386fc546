// Which machines the SystemC model is one of. The bindings name every member of every part of a
// configuration, so that a new member does not compile before it is modelled or refused here.
#include <algorithm>
#include <initializer_list>

#include "sim/error.h"
#include "tests/validation/systemc/machine.h"

namespace marti::oracle {

namespace {

template <class Enum>
void ensure_one_of(Enum value, std::initializer_list<Enum> modelled, const char* message) {
  sim::ensure(std::find(modelled.begin(), modelled.end(), value) != modelled.end(), message);
}

void refuse(const processors::machine::NodeCacheConfig& config) {
  using memory::Replacement;
  using processors::machine::CacheOrganisation;
  [[maybe_unused]] const auto& [organisation, cache, split_sizes, hit_cycles] = config;
  [[maybe_unused]] const auto& [size, line, ways, replacement, seed] = cache;
  ensure_one_of(organisation, {CacheOrganisation::none, CacheOrganisation::unified, CacheOrganisation::split},
                "the SystemC model has no such cache organisation");
  ensure_one_of(
      replacement,
      {Replacement::lru, Replacement::fifo, Replacement::random, Replacement::plru, Replacement::srrip},
      "the SystemC model has no such replacement");
}

void refuse(const memory::InterconnectConfig& config) {
  using memory::BusMode;
  using memory::InterconnectKind;
  [[maybe_unused]] const auto& [kind, mode, arbitration, clock, width, cycles_per_beat, address_cycles,
                                latency_cycles] = config;
  ensure_one_of(kind, {InterconnectKind::ideal, InterconnectKind::bus, InterconnectKind::crossbar},
                "the SystemC model has no such interconnect");
  ensure_one_of(mode, {BusMode::held, BusMode::split}, "the SystemC model has no such bus");
  sim::ensure(arbitration == memory::Arbitration::fifo || kind != InterconnectKind::bus,
              "the SystemC model's bus is granted by fifo");
}

void refuse(const processors::machine::PacketConfig& packets, const processors::machine::HostConfig& host) {
  using processors::machine::Assignment;
  using processors::machine::PacketOrder;
  [[maybe_unused]] const auto& [width, height, order] = packets;
  [[maybe_unused]] const auto& [assignment, clock, latency_cycles, occupancy_cycles] = host;
  ensure_one_of(order, {PacketOrder::scanline, PacketOrder::morton, PacketOrder::hilbert},
                "the SystemC model has no such order of packets");
  ensure_one_of(assignment, {Assignment::dynamic, Assignment::interleaved, Assignment::blocks},
                "the SystemC model has no such assignment");
}

void refuse(const memory::LayoutConfig& layout, const memory::BankConfig& banks,
            const processors::machine::LocalMemoryConfig& local) {
  using memory::NodeOrder;
  [[maybe_unused]] const auto& [node, transform, entry, primitive, quadric, material, texel, pixel,
                                record_alignment, section_alignment, order, leaf, treelet] = layout;
  [[maybe_unused]] const auto& [count, interleave, clock, access_cycles, busy_cycles, shared_cache, dram] =
      banks;
  [[maybe_unused]] const auto& [local_clock, width, local_access_cycles, cycles_per_beat] = local;
  sim::ensure(leaf == memory::LeafLayout::list, "the leaves of the SystemC model have lists");
  sim::ensure(!shared_cache, "the SystemC model has no cache before the banks");
  sim::ensure(!dram, "the SystemC model has banks of fixed times only");
  ensure_one_of(order, {NodeOrder::breadth_first, NodeOrder::depth_first, NodeOrder::treelets},
                "the SystemC model has no such order of nodes");
}

}  // namespace

void refuse_what_is_not_modelled(const processors::machine::MachineConfig& config) {
  using processors::machine::Placement;
  // network, messages, pipeline and space have a meaning only in schemes that are refused; distribution and
  // network only with a placement that is; switch_cycles only with more than one context. Energy changes no
  // time.
  [[maybe_unused]] const auto& [clusters, nodes, kind, simt, rt, clock, operations, word_bytes, pixels,
                                write_buffer, contexts, switch_cycles, prefetch, layout, cache, l2, placement,
                                distribution, local, interconnect, banks, packets, host, build, scheme,
                                network, messages, pipeline, space, count, energy] = config;
  sim::ensure(kind == processors::machine::NodeKind::core, "a node of the SystemC model is a scalar core");
  sim::ensure(pixels == processors::machine::Pixels::written,
              "a node of the SystemC model writes its pixels");
  sim::ensure(contexts == 1 && !prefetch.on(), "a node of the SystemC model has one context and no prefetch");
  sim::ensure(l2.sharing == processors::machine::SecondLevel::none,
              "the SystemC model has no second-level caches");
  sim::ensure(!count.any(), "the SystemC model does not classify misses");
  sim::ensure(scheme == processors::machine::Scheme::image, "the SystemC model has the image scheme only");
  sim::ensure(build.sharing == processors::machine::Sharing::given, "the SystemC model's tree is given");
  ensure_one_of(placement, {Placement::shared, Placement::replicated},
                "the SystemC model has no such placement");
  refuse(cache);
  refuse(interconnect);
  refuse(packets, host);
  refuse(layout, banks, local);
}

}  // namespace marti::oracle
