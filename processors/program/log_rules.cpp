#include "processors/program/log_rules.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "accel/visitor.h"
#include "processors/program/render.h"

namespace marti::processors::program {

namespace {

constexpr std::uint32_t no_node = 0xffffffffU;
/// Texels of all textures together: no scene has as many, and sums of their bytes fit.
constexpr std::uint64_t most_texels = std::uint64_t{1} << 48U;

/// Keeps the first fault that it is told.
class Fault {
 public:
  void add_if(bool wrong, const char* what) {
    if (wrong && text_.empty()) {
      text_ = what;
    }
  }
  [[nodiscard]] bool none() const { return text_.empty(); }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// What a log says besides its rows.
void check_counts(const WorkLog& log, Fault& fault) {
  fault.add_if(log.width < 1 || log.height < 1 || log.width > max_image_side || log.height > max_image_side,
               "an image of no size that there is");
  fault.add_if(log.samples < 1 || log.samples > max_samples, "pixels without a sample, or with too many");
  fault.add_if(log.voxels > log.materials, "more averaged materials than materials");
  fault.add_if(log.rows.size() != log.height, "the number of rows is not the image's height");
  fault.add_if(log.quadrics.size() > log.primitives, "more curved primitives than primitives");
  fault.add_if(std::ranges::find(log.quadrics, accel::PrimitiveKind::triangle) != log.quadrics.end(),
               "a triangle among the curved primitives");
  fault.add_if(!std::ranges::is_sorted(log.texture_begin), "texture offsets decrease");
  fault.add_if(!log.texture_begin.empty() &&
                   (log.texture_begin.front() != 0 || log.texture_begin.back() > most_texels),
               "textures with more texels than there can be");
}

void check_tree(const WorkLog& log, Fault& fault) {
  const accel::Topology& tree = log.topology;
  const std::size_t nodes = tree.nodes.size();
  fault.add_if(nodes == 0, "a tree without a node");
  fault.add_if(nodes != 0 && tree.nodes.front().level != 1, "a root that is not on level 1");
  fault.add_if(!tree.work.empty() && tree.work.size() != nodes,
               "the work of splitting is not that of all nodes");
  std::vector<bool> has_parent(nodes);
  std::size_t children = 0;
  for (std::size_t n = 0; n < nodes && fault.none(); ++n) {
    const accel::TopologyNode& node = tree.nodes[n];
    const std::size_t end = std::size_t{node.first} + node.count;
    fault.add_if(end > (node.leaf ? tree.entries.size() : nodes), "a node that points outside the tree");
    fault.add_if(node.instance && (node.leaf || node.count != 1 || !accel::walks_bvh(log.traversal)),
                 "an instance that is not a node with one mesh below it");
    if (node.leaf || !fault.none()) {
      continue;
    }
    fault.add_if(node.count == 0, "a branch without children");
    fault.add_if(node.first <= n, "a branch above its parent");
    for (std::size_t child = node.first; child < end && fault.none(); ++child) {
      // The root of a mesh is below all of its instances, one level below the deepest.
      fault.add_if(has_parent[child] && !node.instance, "a node with two parents");
      fault.add_if(
          node.instance ? tree.nodes[child].level <= node.level : tree.nodes[child].level != node.level + 1,
          "a node that is not on the level below its parent's");
      children += has_parent[child] ? 0 : 1;
      has_parent[child] = true;
    }
  }
  fault.add_if(nodes != 0 && children + 1 != nodes, "a node without a parent");
  fault.add_if(
      std::ranges::any_of(tree.entries, [&](std::uint32_t entry) { return entry >= log.primitives; }),
      "a primitive that the database does not have");
}

/// Checks the operands of a pixel's steps.
class StepRules {
 public:
  explicit StepRules(const WorkLog& log) : log_(log) {}

  void check(std::span<const std::uint32_t> words, Fault& fault) const {
    fault.add_if(log_.samples != 1 && !words.empty() && words[0] != camera_ray,
                 "a pixel of several samples begins without a camera ray");
    std::uint32_t samples = 0;
    auto before = Step::ray;
    bool asked = false;  // the step before asks whether a hit counts, or is the texel for that
    for (std::size_t at = 0; at < words.size() && fault.none();) {
      const Step step = step_of(words[at]);
      const std::uint32_t operand = operand_of(words[at]);
      const bool cut_short =
          (step == Step::mailed_leaf && words.size() - at < 2) || step_words(&words[at]) > words.size() - at;
      fault.add_if(cut_short, "a pixel ends between the words of a step");
      fault.add_if((before == Step::cut) != (step == Step::shade && averaged(operand)),
                   "a cut without its averaged material, or the reverse");
      fault.add_if(before == Step::pass && (!visits_node(step) || step == Step::cut),
                   "a pass without its node");
      fault.add_if(step == Step::any_hit && !(is_leaf(before) || (asked && before == last_of_any_hit())),
                   "a hit that is asked about without its leaf");
      fault.add_if(before == Step::any_hit && !of_gaussians() && step != Step::texel,
                   "a hit that is asked about without its texel");
      fault.add_if(step == Step::texel && of_gaussians(), "a texel of Gaussians");
      asked = step == Step::any_hit || (before == Step::any_hit && step == Step::texel);
      if (fault.none()) {
        check_step(step, operand, &words[at], fault);
        samples += words[at] == camera_ray ? 1 : 0;
        before = step;
        at += step_words(&words[at]);
      }
    }
    fault.add_if(before == Step::cut || before == Step::pass, "a pixel ends in the middle of a voxel");
    fault.add_if(before == Step::any_hit && !of_gaussians(), "a hit that is asked about without its texel");
    fault.add_if(log_.samples != 1 && !words.empty() && samples != log_.samples,
                 "a pixel has fewer or more camera rays than samples");
  }

 private:
  [[nodiscard]] bool of_gaussians() const { return log_.integrator == Integrator::gaussians; }
  [[nodiscard]] Step last_of_any_hit() const { return of_gaussians() ? Step::any_hit : Step::texel; }
  static bool is_leaf(Step step) {
    return step == Step::leaf || step == Step::partial_leaf || step == Step::mailed_leaf;
  }
  [[nodiscard]] bool averaged(std::uint32_t material) const {
    return material < log_.materials && material >= log_.materials - log_.voxels;
  }

  void check_step(Step step, std::uint32_t operand, const std::uint32_t* word, Fault& fault) const {
    if (visits_node(step)) {
      fault.add_if(operand >= log_.topology.nodes.size(), "a node that the tree does not have");
      if (fault.none()) {
        check_visit(step, log_.topology.nodes[operand], word, fault);
      }
    }
    fault.add_if(step == Step::ray && ray_number_of(operand) >= ray_kinds, "a ray of an unknown kind");
    fault.add_if(step == Step::pass && !averaged(operand),
                 "an averaged material that the database does not have");
    fault.add_if((step == Step::shade || step == Step::any_hit) && operand >= log_.materials,
                 "a material that the database does not have");
    fault.add_if(step == Step::light && operand >= log_.lights, "a light that the database does not have");
    if (step == Step::texel) {
      fault.add_if(operand + std::size_t{1} >= log_.texture_begin.size() ||
                       word[1] >= log_.texture_begin[operand + 1] - log_.texture_begin[operand],
                   "a texel that the database does not have");
    }
    fault.add_if(step > Step::transform, "an unknown step");
  }

  void check_visit(Step step, const accel::TopologyNode& node, const std::uint32_t* word,
                   Fault& fault) const {
    fault.add_if(step == Step::cut ? node.count == 0 || node.instance
                                   : node.leaf != is_leaf(step) || node.instance != (step == Step::transform),
                 "a step on a node of another kind");
    fault.add_if(step == Step::partial_leaf && word[1] >= node.count,
                 "a partial leaf that tests all its entries");
    if (step == Step::mailed_leaf) {
      const std::uint32_t entries = word[1];
      fault.add_if(!log_.mailboxes || entries > node.count, "entries that no mailbox was looked up for");
      fault.add_if(entries % 32 != 0 && word[2 + entries / 32] >> (entries % 32) != 0,
                   "a test beyond the entries that were looked up");
      fault.add_if(tests_of_mask(word + 2, entries) >= entries, "mailboxes that left nothing out");
    }
  }

  const WorkLog& log_;
};

/// Checks the order of a pixel's steps. An object is for one thread, which checks pixels of one log.
class OrderRules {
 public:
  explicit OrderRules(const WorkLog& log) : log_(log), reached_(log.topology.nodes.size()) {}

  void check(std::uint32_t x, std::uint32_t y, Fault& fault) {
    entered_ = log_.has_entered() ? log_.entered(x, y) : std::span<const std::uint32_t>();
    const std::span<const std::uint32_t> words = log_.pixel(x, y);
    bool tracing = false;
    auto before = Step::ray;
    std::size_t rays = 0;
    for (std::size_t at = 0; at < words.size() && fault.none(); at += step_words(&words[at])) {
      const Step step = step_of(words[at]);
      if (step == Step::ray) {
        fault.add_if(bounce_of(operand_of(words[at])) >
                         (log_.integrator == Integrator::gaussians ? most_rounds : max_ray_depth),
                     "a ray of more bounces than it can have");
        begin_ray();
        tracing = true;
        ++rays;
      } else if (visits_node(step)) {
        fault.add_if(!tracing, "a visit that belongs to no ray");
        visit(step, operand_of(words[at]), fault);
      } else {
        fault.add_if(rays == 0, "a step before the first ray");
        tracing = tracing && (step == Step::pass || step == Step::any_hit ||
                              (before == Step::any_hit && step == Step::texel));
      }
      before = step;
    }
    fault.add_if(!entered_.empty(), "more entered children than branches visited");
    fault.add_if(log_.has_ray_words() && log_.ray_words(x, y).size() != rays,
                 "words of rays that are not there, or rays without one");
    if (log_.has_meets() && fault.none()) {
      check_meets(log_.meets(x, y), rays, fault);
    }
  }

 private:
  void begin_ray() {
    if (++ray_ == 0) {  // the number has been used before
      std::ranges::fill(reached_, 0U);
      ray_ = 1;
    }
    waiting_.assign(1, 0);
  }

  void visit(Step step, std::uint32_t number, Fault& fault) {
    const accel::TopologyNode& node = log_.topology.nodes[number];
    fault.add_if(number != 0 && reached_[number] != ray_, "a visit before that to the branch above");
    if ((step == Step::branch || step == Step::transform) && fault.none()) {
      std::fill_n(reached_.begin() + node.first, node.count, ray_);
    }
    if (log_.has_entered() && fault.none()) {
      take(number, fault);
      if (!node.leaf && fault.none()) {
        enter(node, fault);
      }
    }
  }

  // The ray takes a node that waits; those entered after it were dropped.
  void take(std::uint32_t number, Fault& fault) {
    while (!waiting_.empty() && waiting_.back() != number) {
      waiting_.pop_back();
    }
    fault.add_if(waiting_.empty(), "a visit to a node that the ray has not entered");
    if (fault.none()) {
      waiting_.pop_back();
    }
  }

  void enter(const accel::TopologyNode& branch, Fault& fault) {
    fault.add_if(entered_.empty(), "a branch without its entered children");
    if (!fault.none()) {
      return;
    }
    const accel::EnteredChildren children(entered_.front());
    entered_ = entered_.subspan(1);
    fault.add_if(children.count() > accel::EnteredChildren::most, "more entered children than a branch has");
    unsigned seen = 0;
    for (std::uint32_t place = fault.none() ? children.count() : 0; place-- > 0;) {
      fault.add_if(children[place] >= branch.count || (seen >> children[place] & 1U) != 0,
                   "an entered child that the branch does not have, or twice");
      seen |= 1U << children[place];
      waiting_.push_back(branch.first + children[place]);
    }
  }

  // What each ray meets (accel/bvh_meets.h): the words of a node, those of the first node entered from it,
  // and so on, without a gap.
  void check_meets(std::span<const std::uint32_t> words, std::size_t rays, Fault& fault) const {
    for (; rays > 0 && fault.none(); --rays) {
      fault.add_if(words.empty() || words[0] == 0 || words[0] > words.size(),
                   "a ray that meets no number of words");
      if (fault.none()) {
        const std::span<const std::uint32_t> ray = words.first(words[0]);
        const std::size_t end = ray.size() == 1 ? 1 : check_met(ray, 1, 0, fault);
        fault.add_if(end != ray.size(), "a ray that meets more or less than its words say");
        words = words.subspan(ray.size());
      }
    }
    fault.add_if(!words.empty(), "more rays that meet something than there are");
  }

  // Returns where the words of the node, which begin at `at`, and of all nodes below it end.
  std::size_t check_met(std::span<const std::uint32_t> ray, std::size_t at, std::uint32_t number,
                        Fault& fault) const {
    const accel::TopologyNode& node = log_.topology.nodes[number];
    const accel::EnteredChildren children(at < ray.size() ? ray[at] : 0);
    const std::size_t pairs = at >= ray.size() ? 0 : node.leaf ? ray[at] : children.count();
    fault.add_if(at >= ray.size() || pairs > (ray.size() - at - 1) / 2 || pairs > node.count ||
                     (!node.leaf && pairs > accel::EnteredChildren::most),
                 "a ray that meets more than there is");
    std::size_t end = at + 1 + 2 * pairs;
    unsigned seen = 0;
    for (std::uint32_t i = 0; i < pairs && fault.none(); ++i) {
      const std::uint32_t* const pair = &ray[at + 1 + std::size_t{2} * i];
      fault.add_if(pair[node.leaf ? 1 : 0] >= ray.size(), "a rank of something that a ray does not meet");
      if (node.leaf) {
        fault.add_if(pair[0] >= node.count || (i > 0 && pair[0] <= pair[-2]),
                     "a hit of a primitive that the leaf does not have");
        continue;
      }
      const std::uint32_t child = children[i];
      fault.add_if(child >= node.count || (seen >> child & 1U) != 0 || pair[1] != end,
                   "a ray that meets a child which the branch does not have, or in another place");
      seen |= 1U << child;
      if (fault.none()) {
        end = check_met(ray, end, node.first + child, fault);
      }
    }
    return end;
  }

  const WorkLog& log_;
  std::vector<std::uint32_t> reached_;  // of each node: the ray that was at a branch above it last
  std::uint32_t ray_ = 0;
  std::vector<std::uint32_t> waiting_;  // nodes that the ray has entered; the next one last
  std::span<const std::uint32_t> entered_;
};

// Whether the words are divided among the pixels.
bool are_of_pixels(const WorkLog& log, const RowWords& row) {
  return row.begin.size() == std::size_t{log.width} + 1 && row.begin.front() == 0 &&
         row.begin.back() == row.words.size() && std::ranges::is_sorted(row.begin);
}

void check_row(const WorkLog& log, const LogRow& row, Fault& fault) {
  fault.add_if(!are_of_pixels(log, row), "a row's pixels are not all of its words");
  for (RowWords LogRow::*const beside : {&LogRow::entered, &LogRow::rays, &LogRow::meets}) {
    const RowWords& words = row.*beside;
    fault.add_if(log.has(beside) ? !are_of_pixels(log, words) : !words.begin.empty() || !words.words.empty(),
                 "a row's pixels are not all of what stands beside its steps");
  }
}

// The first fault in the order of the rows. `row_rules()` makes what checks the pixels of a row.
template <class MakeRules, class Check>
std::string fault_of_rows(const WorkLog& log, const MakeRules& make_rules, const Check& check) {
  std::atomic<std::uint32_t> faulty = std::numeric_limits<std::uint32_t>::max();  // the first such row
  std::vector<std::string> faults(log.height);
  tbb::enumerable_thread_specific<decltype(make_rules())> rules(make_rules);
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, log.height), [&](const auto& range) {
    for (std::uint32_t y = range.begin(); y != range.end() && y <= faulty; ++y) {
      Fault fault;
      std::uint32_t x = 0;
      check_row(log, log.rows[y], fault);
      const bool whole = fault.none();
      for (; x < log.width && fault.none(); ++x) {
        check(rules.local(), x, y, fault);
      }
      if (fault.none()) {
        continue;
      }
      faults[y] = "row " + std::to_string(y) + (whole ? ", pixel " + std::to_string(x - 1) : "") + ": " +
                  fault.text();
      std::uint32_t first = faulty;
      while (y < first && !faulty.compare_exchange_weak(first, y)) {
      }
    }
  });
  return faulty < log.height ? faults[faulty] : "";
}

std::vector<std::uint32_t> parents_of(const accel::Topology& tree) {
  std::vector<std::uint32_t> parent(tree.nodes.size(), no_node);
  for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {
    const accel::TopologyNode& node = tree.nodes[n];
    for (std::uint32_t child = 0; !node.leaf && child < node.count; ++child) {
      parent[node.first + child] = n;
    }
  }
  return parent;
}

// Whether each branch lists at least the different primitives of the leaves below it, none twice, and tests
// each at most once against each child.
bool can_be_split(const accel::Topology& tree, std::uint32_t primitives,
                  const std::vector<std::uint32_t>& parent) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> places;  // primitive, leaf
  places.reserve(tree.entries.size());
  for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {
    const accel::TopologyNode& node = tree.nodes[n];
    for (std::uint32_t entry = 0; node.leaf && entry < node.count; ++entry) {
      places.emplace_back(tree.entries[node.first + entry], n);
    }
  }
  std::ranges::sort(places);
  std::vector<std::uint32_t> last(tree.nodes.size(), no_node);  // the primitive counted last
  std::vector<std::uint32_t> below(tree.nodes.size());
  for (const auto& [primitive, leaf] : places) {
    for (std::uint32_t n = leaf; n != no_node && last[n] != primitive; n = parent[n]) {
      last[n] = primitive;
      ++below[n];
    }
  }
  for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
    const accel::SplitWork& work = tree.work[n];
    if (!tree.nodes[n].leaf && (work.listed < below[n] || work.listed > primitives ||
                                work.overlaps > std::uint64_t{work.listed} * tree.nodes[n].count)) {
      return false;
    }
  }
  return true;
}

}  // namespace

std::string fault_of(const WorkLog& log) {
  Fault fault;
  check_counts(log, fault);
  check_tree(log, fault);
  if (!fault.none()) {
    return fault.text();
  }
  return fault_of_rows(
      log, [&] { return StepRules(log); },
      [&](const StepRules& rules, std::uint32_t x, std::uint32_t y, Fault& of) {
        rules.check(log.pixel(x, y), of);
      });
}

std::string fault_of_order(const WorkLog& log) {
  const std::vector<std::uint32_t> parent = parents_of(log.topology);
  if (log.has_entered() &&
      (!accel::walks_bvh(log.traversal) || log.order != accel::WalkOrder::depth_first || log.mailboxes)) {
    return "entered children that no walk of this kind records";
  }
  if (log.has_meets() && (!accel::walks_bvh(log.traversal) || log.mailboxes)) {
    return "what rays meet in a structure of another kind";
  }
  if (!log.topology.work.empty() && !can_be_split(log.topology, log.primitives, parent)) {
    return "the work of splitting a branch that cannot be";
  }
  return fault_of_rows(
      log, [&] { return OrderRules(log); },
      [](OrderRules& rules, std::uint32_t x, std::uint32_t y, Fault& of) { rules.check(x, y, of); });
}

}  // namespace marti::processors::program
