// What a node does for a packet: the work log, step by step, as operations that take time.
#pragma once

#include <cstdint>
#include <vector>

#include "memory/record_kind.h"
#include "processors/cost/accounting.h"
#include "processors/cost/step_time.h"
#include "processors/program/work_log.h"
#include "tests/validation/systemc/database.h"
#include "tests/validation/systemc/host.h"
#include "tests/validation/systemc/instant.h"

namespace marti::oracle {

struct Operation {
  enum class Kind : std::uint8_t { compute, read, write };
  Kind kind = Kind::compute;
  processors::cost::Activity activity = processors::cost::Activity::idle;  ///< compute
  Time duration = 0;                                                       ///< compute
  memory::RecordKind record = memory::RecordKind::node;                    ///< read
  Extent extent;                                                           ///< read and write
};

class Program {
 public:
  /// All must outlive it. What is done is counted in `steps`.
  Program(const processors::program::WorkLog& log, const Database& database,
          const processors::cost::StepTicks& ticks, processors::cost::StepCounts& steps)
      : log_(log), database_(database), ticks_(ticks), steps_(steps) {}

  void begin(const Rectangle& packet);
  /// The operations of the next step, a pixel's end counting as one; false when the packet is done.
  bool next_step(std::vector<Operation>& operations);

 private:
  void step(std::vector<Operation>& operations);
  void end_pixel(std::vector<Operation>& operations);
  void read_node(std::uint32_t number, std::vector<Operation>& operations);
  void visit_leaf(std::uint32_t number, std::uint32_t entries, const std::uint32_t* tested,
                  std::vector<Operation>& operations);
  void test(std::uint32_t primitive, std::vector<Operation>& operations);
  std::uint32_t next_word() { return log_.rows[y_].words[word_++]; }

  const processors::program::WorkLog& log_;
  const Database& database_;
  const processors::cost::StepTicks& ticks_;
  processors::cost::StepCounts& steps_;
  Rectangle packet_;
  std::uint32_t x_ = 0;
  std::uint32_t y_ = 0;
  std::size_t word_ = 0;  // the next one, in row y_
};

}  // namespace marti::oracle
