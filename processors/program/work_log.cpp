#include "processors/program/work_log.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <string>

#include "sim/error.h"

namespace marti::processors {

namespace {

using sim::ensure;

constexpr const char* no_average = "work log: a cut without its averaged material, or the reverse";

/// Walks one row's words; any fault is an InternalError that names what is out of bounds.
class RowChecker {
 public:
  RowChecker(const WorkLog& log, const LogRow& row) : log_(log), row_(row) {}

  void check() {
    ensure(row_.begin.size() == std::size_t{log_.width} + 1, "work log: a row lacks pixel offsets");
    ensure(row_.begin.front() == 0, "work log: a row does not begin at its first word");
    ensure(row_.begin.back() == row_.words.size(),
           "work log: a row's last pixel ends elsewhere than its words");
    for (std::size_t x = 0; x < log_.width; ++x) {
      ensure(row_.begin[x] <= row_.begin[x + 1], "work log: pixel offsets decrease");
      check_pixel(row_.begin[x], row_.begin[x + 1]);
    }
  }

 private:
  void check_pixel(std::size_t at, std::size_t end) {
    if (log_.samples != 1 && at != end) {
      ensure(row_.words[at] == camera_ray,
             "work log: a pixel of several samples begins without a camera ray");
    }
    std::uint32_t samples = 0;
    const bool empty = at == end;
    auto before = Step::ray;
    while (at < end) {
      const std::size_t visits_end = check_whole_visits(at, end);
      if (visits_end != at) {
        ensure(before != Step::cut, no_average);
        before = Step::branch;
        at = visits_end;
        continue;
      }
      const std::uint32_t* const word = row_.words.data() + at;
      const Step step = step_of(*word);
      const std::uint32_t operand = operand_of(*word);
      const bool long_step = step != Step::mailed_leaf || end - at >= 2;
      ensure(long_step && step_words(word) <= end - at, "work log: a pixel ends between the words of a step");
      ensure((before == Step::cut) == (step == Step::shade && averaged(operand)), no_average);
      ensure(before != Step::pass || step == Step::branch || step == Step::leaf ||
                 step == Step::partial_leaf || step == Step::mailed_leaf,
             "work log: a pass without its node");
      samples += *word == camera_ray ? 1 : 0;
      before = step;
      const std::size_t words = step_words(word);
      check_step(step, operand, words > 1 ? word[1] : 0);
      if (step == Step::mailed_leaf) {
        check_mask(word + 2, word[1]);
      }
      at += words;
    }
    ensure(before != Step::cut && before != Step::pass, "work log: a pixel ends in the middle of a voxel");
    ensure(log_.samples == 1 || empty || samples == log_.samples,
           "work log: a pixel has fewer or more camera rays than samples");
  }

  // Nearly all steps are whole visits, of unpredictable kinds: the loop has no branch on the kind.
  [[nodiscard]] std::size_t check_whole_visits(std::size_t at, std::size_t end) const {
    const std::span<const accel::TopologyNode> nodes(log_.topology.nodes);
    bool right = true;
    for (; at < end && whole_visit(row_.words[at]); ++at) {
      const std::size_t node = operand_of(row_.words[at]);
      if (node >= nodes.size()) [[unlikely]] {
        break;  // check_step reports the error
      }
      right &= nodes[node].leaf == (step_of(row_.words[at]) == Step::leaf);
    }
    ensure(right, "work log: a branch step on a leaf, or the reverse");
    return at;
  }

  /// Whether the database has such a material, and it is an averaged one.
  [[nodiscard]] bool averaged(std::uint32_t material) const {
    return material < log_.materials && material >= log_.materials - log_.voxels;
  }

  void check_mask(const std::uint32_t* mask, std::uint32_t entries) const {
    ensure(log_.mailboxes, "work log: tests left out by mailboxes without mailboxes");
    ensure(entries % 32 == 0 || mask[entries / 32] >> (entries % 32) == 0,
           "work log: a test beyond the entries that were looked up");
    ensure(tests_of_mask(mask, entries) < entries, "work log: mailboxes that left nothing out");
  }

  void check_step(Step step, std::uint32_t operand, std::uint32_t second) const {
    switch (step) {
      case Step::branch:
        ensure(operand < log_.topology.nodes.size(), "work log: a branch that the tree does not have");
        ensure(!log_.topology.nodes[operand].leaf, "work log: a branch step on a leaf");
        return;
      case Step::leaf:
      case Step::partial_leaf:
        ensure(operand < log_.topology.nodes.size(), "work log: a leaf that the tree does not have");
        ensure(log_.topology.nodes[operand].leaf, "work log: a leaf step on a branch");
        ensure(step == Step::leaf || second < log_.topology.nodes[operand].count,
               "work log: a partial leaf that tests all its entries or more");
        return;
      case Step::mailed_leaf:
        ensure(operand < log_.topology.nodes.size(), "work log: a leaf that the tree does not have");
        ensure(log_.topology.nodes[operand].leaf, "work log: a leaf step on a branch");
        ensure(second <= log_.topology.nodes[operand].count,
               "work log: more entries looked up than the leaf has");
        return;
      case Step::cut:
        ensure(operand < log_.topology.nodes.size(), "work log: a cut of a node that the tree does not have");
        ensure(log_.topology.nodes[operand].count != 0, "work log: a cut of an empty leaf");
        return;
      case Step::ray:
        return;  // every value of the low two bits is a RayKind
      case Step::pass:
        ensure(averaged(operand), "work log: an averaged material that the database does not have");
        return;
      case Step::shade:
        ensure(operand < log_.materials, "work log: a material that the database does not have");
        return;
      case Step::light:
        ensure(operand < log_.lights, "work log: a light that the database does not have");
        return;
      case Step::texel:
        ensure(operand + std::size_t{1} < log_.texture_begin.size(),
               "work log: a texture that the database does not have");
        ensure(second < log_.texture_begin[operand + 1] - log_.texture_begin[operand],
               "work log: a texel outside its texture");
        return;
    }
    throw sim::InternalError("work log: an unknown step " + std::to_string(static_cast<unsigned>(step)));
  }

  const WorkLog& log_;
  const LogRow& row_;
};

void check_topology(const WorkLog& log) {
  ensure(log.quadrics.size() <= log.primitives, "work log: more curved primitives than primitives");
  for (const accel::PrimitiveKind kind : log.quadrics) {
    ensure(kind == accel::PrimitiveKind::sphere || kind == accel::PrimitiveKind::cone,
           "work log: a triangle among the curved primitives");
  }
  const std::size_t nodes = log.topology.nodes.size();
  std::vector<bool> has_parent(nodes);
  for (std::size_t n = 0; n < nodes; ++n) {
    const accel::TopologyNode& node = log.topology.nodes[n];
    const std::size_t end = std::size_t{node.first} + node.count;
    ensure(end <= (node.leaf ? log.topology.entries.size() : nodes),
           "work log: a node that points outside the tree");
    ensure(node.leaf || node.count == 0 || node.first > n, "work log: a branch above its parent");
    for (std::size_t child = node.first; !node.leaf && child < end; ++child) {
      ensure(!has_parent[child], "work log: a node with two parents");
      has_parent[child] = true;
    }
  }
  for (const std::uint32_t entry : log.topology.entries) {
    ensure(entry < log.primitives, "work log: a primitive that the database does not have");
  }
  for (std::size_t i = 1; i < log.texture_begin.size(); ++i) {
    ensure(log.texture_begin[i - 1] <= log.texture_begin[i], "work log: texture offsets decrease");
  }
}

}  // namespace

void check_log_capacity(std::size_t nodes, std::size_t materials, std::size_t lights, std::size_t textures) {
  const auto fits = [](const char* what, std::size_t count) {
    constexpr std::size_t most = std::size_t{max_operand} + 1;
    if (count > most) {
      throw sim::UserError("the work log numbers at most " + std::to_string(most) + " " + what +
                           ", and there are " + std::to_string(count) +
                           "; use a smaller scene or a coarser structure");
    }
  };
  fits("structure nodes", nodes);
  fits("materials", materials);
  fits("lights", lights);
  fits("textures", textures);
}

LogTotals totals_of(const WorkLog& log) {
  LogTotals totals;
  std::vector<std::uint32_t> tests(log.topology.nodes.size());  // of each leaf tested whole
  std::transform(log.topology.nodes.begin(), log.topology.nodes.end(), tests.begin(),
                 [](const accel::TopologyNode& node) { return node.leaf ? node.count : 0; });
  for (const LogRow& row : log.rows) {
    totals.bytes += (row.words.size() + row.begin.size()) * sizeof(std::uint32_t);
    const std::size_t size = row.words.size();
    for (std::size_t at = 0; at < size; at += step_words(row.words.data() + at)) {
      // Branches and leaves alternate unpredictably, so they are counted without a conditional branch.
      std::uint64_t visits = 0;
      std::uint64_t leaves = 0;
      std::uint64_t tested = 0;
      for (; at < size && whole_visit(row.words[at]); ++at) {
        ++visits;
        leaves += static_cast<std::uint32_t>(step_of(row.words[at]));
        tested += tests[operand_of(row.words[at])];
      }
      totals.branches += visits - leaves;
      totals.leaves += leaves;
      totals.tests += tested;
      totals.lookups += log.mailboxes ? tested : 0;
      if (at == size) {
        break;
      }
      const std::uint32_t word = row.words[at];
      switch (step_of(word)) {
        case Step::branch:
        case Step::leaf:
          break;
        case Step::partial_leaf:
          ++totals.leaves;
          totals.tests += row.words[at + 1];
          totals.lookups += log.mailboxes ? row.words[at + 1] : 0;
          break;
        case Step::mailed_leaf:
          ++totals.leaves;
          totals.tests += tests_of_mask(row.words.data() + at + 2, row.words[at + 1]);
          totals.lookups += row.words[at + 1];
          break;
        case Step::ray:
          ++totals.rays[operand_of(word) & 3U];
          break;
        case Step::shade:
          ++totals.shades;
          break;
        case Step::light:
          ++totals.lights;
          break;
        case Step::texel:
          ++totals.texels;
          break;
        case Step::cut:
          ++totals.cuts;
          break;
        case Step::pass:
          ++totals.passes;
          break;
      }
    }
  }
  return totals;
}

void validate(const WorkLog& log) {
  ensure(log.samples >= 1, "work log: pixels without a sample");
  ensure(log.voxels <= log.materials, "work log: more averaged materials than materials");
  ensure(log.rows.size() == log.height, "work log: the number of rows is not the image's height");
  check_topology(log);
  tbb::parallel_for(std::size_t{0}, log.rows.size(),
                    [&](std::size_t y) { RowChecker(log, log.rows[y]).check(); });
}

}  // namespace marti::processors
