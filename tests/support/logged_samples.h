// Words of a log: that of a ray, the samples of a pixel, the branches and the tests, found the simple way.
#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <span>
#include <vector>

#include "processors/program/work_log.h"

namespace marti::test {

/// The word that begins a ray.
constexpr std::uint32_t ray_word(processors::program::RayKind kind, std::uint32_t bounce) {
  return processors::program::make_word(processors::program::Step::ray,
                                        processors::program::ray_operand(kind, bounce));
}

/// The words of each of a pixel's samples: a log with one has them together, others begin a sample with each
/// camera ray.
inline std::vector<std::span<const std::uint32_t>> samples_of_pixel(const processors::program::WorkLog& log,
                                                                    std::uint32_t x, std::uint32_t y) {
  const std::span<const std::uint32_t> words = log.pixel(x, y);
  std::vector<std::size_t> begins;
  for (std::size_t at = 0; at < words.size(); at += processors::program::step_words(words.data() + at)) {
    if (at == 0 ||
        (log.samples > 1 && words[at] == processors::program::make_word(processors::program::Step::ray, 0))) {
      begins.push_back(at);
    }
  }
  begins.push_back(words.size());
  std::vector<std::span<const std::uint32_t>> samples;
  for (std::size_t i = 1; i < begins.size() && !words.empty(); ++i) {
    samples.push_back(words.subspan(begins[i - 1], begins[i] - begins[i - 1]));
  }
  return samples;
}

/// The branches that rays visit.
inline std::set<std::uint32_t> visited_branches(const processors::program::WorkLog& log) {
  using namespace processors::program;
  std::set<std::uint32_t> branches;
  for (const LogRow& row : log.rows) {
    for (std::size_t at = 0; at < row.words.size(); at += step_words(row.words.data() + at)) {
      if (step_of(row.words[at]) == Step::branch) {
        branches.insert(operand_of(row.words[at]));
      }
    }
  }
  return branches;
}

/// Tests of each accel::PrimitiveKind, one by one.
inline std::array<std::int64_t, 3> tests_by_kind(const processors::program::WorkLog& log) {
  using processors::program::Step;
  std::array<std::int64_t, 3> tests{};
  for (const processors::program::LogRow& row : log.rows) {
    for (std::size_t i = 0; i < row.words.size();
         i += processors::program::step_words(row.words.data() + i)) {
      const Step step = processors::program::step_of(row.words[i]);
      if (step != Step::leaf && step != Step::partial_leaf && step != Step::mailed_leaf) {
        continue;
      }
      const accel::TopologyNode& node = log.topology.nodes[processors::program::operand_of(row.words[i])];
      const std::uint32_t read = step == Step::leaf ? node.count : row.words[i + 1];
      for (std::uint32_t t = 0; t < read; ++t) {
        if (step != Step::mailed_leaf || ((row.words[i + 2 + t / 32] >> (t % 32)) & 1U) != 0) {
          ++tests[static_cast<std::size_t>(log.kind_of(log.topology.entries[node.first + t]))];
        }
      }
    }
  }
  return tests;
}

}  // namespace marti::test
