// Where records lie, computed from the rules of docs/internals/model.md.
#pragma once

#include <cstdint>
#include <vector>

#include "accel/topology.h"
#include "memory/layout.h"
#include "memory/record_kind.h"
#include "processors/program/work_log.h"

namespace marti::oracle {

/// Bytes of one record.
struct Extent {
  std::uint64_t address = 0;
  std::uint64_t bytes = 0;
};

class Database {
 public:
  Database(const memory::LayoutConfig& config, const processors::program::WorkLog& log);

  /// Without bytes for a leaf that has no record; not for an instance.
  [[nodiscard]] Extent node(std::uint32_t number) const;
  [[nodiscard]] Extent transform(std::uint32_t instance) const;
  /// The first `count` entries of a leaf's list.
  [[nodiscard]] Extent list(const accel::TopologyNode& leaf, std::uint32_t count) const;
  [[nodiscard]] Extent primitive(std::uint32_t id) const;
  [[nodiscard]] Extent material(std::uint32_t number) const;
  [[nodiscard]] Extent texel(std::uint32_t texture, std::uint32_t texel) const;
  [[nodiscard]] Extent pixel(std::uint32_t x, std::uint32_t y) const;

 private:
  [[nodiscard]] bool has_record(std::uint32_t number) const;
  std::uint64_t place(std::uint32_t number);
  void place_children(std::uint32_t branch);
  void place_below(std::uint32_t branch);
  void place_treelet(std::uint32_t top, std::uint64_t most, std::uint64_t used);

  memory::LayoutConfig config_;
  const processors::program::WorkLog& log_;
  std::vector<std::uint32_t> record_of_;  // of each tree node
  std::vector<bool> placed_;              // of each tree node, whether it has been
  std::vector<bool> reached_;             // whether it is in a treelet's queue or was
  std::uint32_t records_ = 0;             // of tree nodes, placed so far
  std::uint32_t instances_ = 0;           // placed so far
  std::uint64_t transforms_ = 0;
  std::uint64_t lists_ = 0;
  std::uint64_t triangles_ = 0;
  std::uint64_t quadrics_ = 0;
  std::uint64_t materials_ = 0;
  std::uint64_t texels_ = 0;
  std::uint64_t pixels_ = 0;
};

}  // namespace marti::oracle
