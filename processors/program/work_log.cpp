#include "processors/program/work_log.h"

#include <algorithm>
#include <string>

#include "sim/error.h"

namespace marti::processors::program {

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

namespace {

// Rays by the number of their visits.
class VisitCounts {
 public:
  void visit(std::uint64_t visits) { of_ray_ += visits; }
  // The next ray begins, or a row ends: what a pixel does after its last ray are no visits.
  void end_ray() {
    if (open_) {
      if (of_ray_ >= rays_.size()) {
        rays_.resize(of_ray_ + 1);
      }
      ++rays_[of_ray_];
    }
    of_ray_ = 0;
    open_ = false;
  }
  void begin_ray() {
    end_ray();
    open_ = true;
  }
  void write(LogTotals& totals) const {
    constexpr std::uint64_t part = 19;  // 95 % are 19 of 20
    constexpr std::uint64_t whole = 20;
    std::uint64_t rays = 0;
    while (totals.visits_95 < rays_.size() &&
           whole * (rays += rays_[totals.visits_95]) < part * totals.all_rays()) {
      ++totals.visits_95;
    }
    totals.most_visits = rays_.empty() ? 0 : rays_.size() - 1;
  }

 private:
  std::vector<std::uint64_t> rays_;
  std::uint64_t of_ray_ = 0;
  bool open_ = false;
};

}  // namespace

LogTotals totals_of(const WorkLog& log, std::vector<std::uint64_t>* shades) {
  LogTotals totals;
  VisitCounts of_rays;
  if (shades != nullptr) {
    shades->assign(log.materials, 0);
  }
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
      of_rays.visit(visits);
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
          of_rays.visit(1);
          ++totals.leaves;
          totals.tests += row.words[at + 1];
          totals.lookups += log.mailboxes ? row.words[at + 1] : 0;
          break;
        case Step::mailed_leaf:
          of_rays.visit(1);
          ++totals.leaves;
          totals.tests += tests_of_mask(row.words.data() + at + 2, row.words[at + 1]);
          totals.lookups += row.words[at + 1];
          break;
        case Step::ray:
          of_rays.begin_ray();
          ++totals.rays[ray_number_of(operand_of(word))];
          break;
        case Step::shade:
          ++totals.shades;
          if (shades != nullptr) {
            ++(*shades)[operand_of(word)];
          }
          break;
        case Step::light:
          ++totals.lights;
          break;
        case Step::texel:
          ++totals.texels;
          break;
        case Step::cut:
          of_rays.visit(1);
          ++totals.cuts;
          break;
        case Step::transform:
          of_rays.visit(1);
          ++totals.transforms;
          break;
        case Step::pass:
          ++totals.passes;
          break;
        case Step::any_hit:
          ++totals.any_hits;
          break;
      }
    }
    of_rays.end_ray();
  }
  of_rays.write(totals);
  return totals;
}

}  // namespace marti::processors::program
