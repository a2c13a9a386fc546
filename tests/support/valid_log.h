// The rules of a work log, checked word by word: every operand names something that exists.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "processors/program/work_log.h"

namespace marti::test {

class LogChecker {
 public:
  explicit LogChecker(const processors::program::WorkLog& log) : log_(log) {}

  /// What is wrong with the log; empty: nothing.
  std::string fault() {
    refuse_if(log_.samples < 1, "pixels without a sample");
    refuse_if(log_.voxels > log_.materials, "more averaged materials than materials");
    refuse_if(log_.rows.size() != log_.height, "the number of rows is not the image's height");
    refuse_if(log_.quadrics.size() > log_.primitives, "more curved primitives than primitives");
    for (const accel::PrimitiveKind kind : log_.quadrics) {
      refuse_if(kind == accel::PrimitiveKind::triangle, "a triangle among the curved primitives");
    }
    for (std::size_t i = 1; i < log_.texture_begin.size(); ++i) {
      refuse_if(log_.texture_begin[i - 1] > log_.texture_begin[i], "texture offsets decrease");
    }
    check_tree();
    for (const processors::program::LogRow& row : log_.rows) {
      if (fault_.empty()) {
        check_row(row);
      }
    }
    return fault_;
  }

 private:
  using Step = processors::program::Step;

  void refuse_if(bool wrong, const char* what) {
    if (wrong && fault_.empty()) {
      fault_ = what;
    }
  }

  void check_tree() {
    const std::size_t nodes = log_.topology.nodes.size();
    std::vector<bool> has_parent(nodes);
    for (std::size_t n = 0; n < nodes && fault_.empty(); ++n) {
      const accel::TopologyNode& node = log_.topology.nodes[n];
      const std::size_t end = std::size_t{node.first} + node.count;
      refuse_if(end > (node.leaf ? log_.topology.entries.size() : nodes),
                "a node that points outside the tree");
      refuse_if(!node.leaf && node.count != 0 && node.first <= n, "a branch above its parent");
      for (std::size_t child = node.first; !node.leaf && child < end && fault_.empty(); ++child) {
        refuse_if(has_parent[child], "a node with two parents");
        has_parent[child] = true;
      }
    }
    for (const std::uint32_t entry : log_.topology.entries) {
      refuse_if(entry >= log_.primitives, "a primitive that the database does not have");
    }
  }

  void check_row(const processors::program::LogRow& row) {
    if (row.begin.size() != std::size_t{log_.width} + 1) {
      fault_ = "a row lacks pixel offsets";
      return;
    }
    refuse_if(row.begin.front() != 0 || row.begin.back() != row.words.size(),
              "a row's pixels are not all of its words");
    for (std::size_t x = 0; x + 1 < row.begin.size() && fault_.empty(); ++x) {
      refuse_if(row.begin[x] > row.begin[x + 1] || row.begin[x + 1] > row.words.size(),
                "pixel offsets decrease");
      if (fault_.empty()) {
        check_pixel(std::span(row.words).subspan(row.begin[x], row.begin[x + 1] - row.begin[x]));
      }
    }
  }

  void check_pixel(std::span<const std::uint32_t> words) {
    refuse_if(log_.samples != 1 && !words.empty() && words[0] != processors::program::camera_ray,
              "a pixel of several samples begins without a camera ray");
    std::uint32_t samples = 0;
    auto before = Step::ray;
    for (std::size_t at = 0; at < words.size() && fault_.empty();) {
      const Step step = processors::program::step_of(words[at]);
      const std::uint32_t operand = processors::program::operand_of(words[at]);
      const bool cut_short = (step == Step::mailed_leaf && words.size() - at < 2) ||
                             processors::program::step_words(&words[at]) > words.size() - at;
      refuse_if(cut_short, "a pixel ends between the words of a step");
      refuse_if((before == Step::cut) != (step == Step::shade && averaged(operand)),
                "a cut without its averaged material, or the reverse");
      refuse_if(before == Step::pass && (!processors::program::visits_node(step) || step == Step::cut),
                "a pass without its node");
      if (fault_.empty()) {
        check_step(step, operand, &words[at]);
        samples += words[at] == processors::program::camera_ray ? 1 : 0;
        before = step;
        at += processors::program::step_words(&words[at]);
      }
    }
    refuse_if(before == Step::cut || before == Step::pass, "a pixel ends in the middle of a voxel");
    refuse_if(log_.samples != 1 && !words.empty() && samples != log_.samples,
              "a pixel has fewer or more camera rays than samples");
  }

  [[nodiscard]] bool averaged(std::uint32_t material) const {
    return material < log_.materials && material >= log_.materials - log_.voxels;
  }

  void check_step(Step step, std::uint32_t operand, const std::uint32_t* word) {
    if (processors::program::visits_node(step)) {
      refuse_if(operand >= log_.topology.nodes.size(), "a node that the tree does not have");
      if (fault_.empty()) {
        check_visit(step, log_.topology.nodes[operand], word);
      }
    }
    refuse_if(step == Step::pass && !averaged(operand),
              "an averaged material that the database does not have");
    refuse_if(step == Step::shade && operand >= log_.materials, "a material that the database does not have");
    refuse_if(step == Step::light && operand >= log_.lights, "a light that the database does not have");
    if (step == Step::texel) {
      refuse_if(operand + std::size_t{1} >= log_.texture_begin.size() ||
                    word[1] >= log_.texture_begin[operand + 1] - log_.texture_begin[operand],
                "a texel that the database does not have");
    }
    refuse_if(step > Step::mailed_leaf, "an unknown step");
  }

  void check_visit(Step step, const accel::TopologyNode& node, const std::uint32_t* word) {
    refuse_if(step == Step::cut ? node.count == 0 : node.leaf == (step == Step::branch),
              "a step on a node of another kind");
    refuse_if(step == Step::partial_leaf && word[1] >= node.count,
              "a partial leaf that tests all its entries");
    if (step == Step::mailed_leaf) {
      const std::uint32_t entries = word[1];
      refuse_if(!log_.mailboxes || entries > node.count, "entries that no mailbox was looked up for");
      refuse_if(entries % 32 != 0 && word[2 + entries / 32] >> (entries % 32) != 0,
                "a test beyond the entries that were looked up");
      refuse_if(processors::program::tests_of_mask(word + 2, entries) >= entries,
                "mailboxes that left nothing out");
    }
  }

  const processors::program::WorkLog& log_;
  std::string fault_;
};

/// What is wrong with the log; empty: nothing.
inline std::string fault_of(const processors::program::WorkLog& log) { return LogChecker(log).fault(); }

}  // namespace marti::test
