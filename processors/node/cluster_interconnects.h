// The interconnects of all clusters, as their nodes use them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "memory/bus.h"
#include "memory/interconnect.h"
#include "sim/error.h"

namespace marti::processors::node {

/// A bus that serves first come, first served is the common case, so its code is joined with that of the
/// nodes: `Client` is the class of the cluster's client, so that the compiler knows what it is told.
class ClusterInterconnects {
 public:
  void connect(std::vector<memory::Interconnect*> interconnects) {
    interconnects_ = std::move(interconnects);
    for (memory::Interconnect* const interconnect : interconnects_) {
      if (auto* const bus = dynamic_cast<memory::Bus*>(interconnect)) {
        buses_.push_back(bus);
      }
    }
    sim::ensure(buses_.empty() || buses_.size() == interconnects_.size(),
                "clusters with interconnects of different classes");
  }
  [[nodiscard]] std::size_t size() const { return interconnects_.size(); }
  [[nodiscard]] memory::Interconnect& operator[](std::uint32_t cluster) const {
    return *interconnects_[cluster];
  }

  template <class Client>
  void read(std::uint32_t cluster, Client& client, const memory::Transaction& transaction) {
    if (!buses_.empty()) [[likely]] {
      buses_[cluster]->read_for(client, transaction);
    } else {
      interconnects_[cluster]->read(transaction);
    }
  }
  template <class Client>
  void write(std::uint32_t cluster, Client& client, const memory::Transaction& transaction) {
    if (!buses_.empty()) [[likely]] {
      buses_[cluster]->write_for(client, transaction);
    } else {
      interconnects_[cluster]->write(transaction);
    }
  }
  template <class Client>
  void reply(std::uint32_t cluster, Client& client, std::uint32_t port) {
    if (!buses_.empty()) [[likely]] {
      buses_[cluster]->reply_for(client, port);
    } else {
      interconnects_[cluster]->reply(port);
    }
  }

 private:
  std::vector<memory::Interconnect*> interconnects_;
  std::vector<memory::Bus*> buses_;  // the interconnects, if they are of this class; else empty
};

}  // namespace marti::processors::node
