// Logs to be written and read, and their comparison field by field.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "studies/sweep/log_file.h"
#include "tests/support/random_machine.h"

namespace marti::studies::test {

inline void expect_equal(const processors::WorkLog& a, const processors::WorkLog& b) {
  ASSERT_EQ(a.traversal, b.traversal);
  ASSERT_EQ(a.mailboxes, b.mailboxes);
  ASSERT_EQ(a.width, b.width);
  ASSERT_EQ(a.height, b.height);
  ASSERT_EQ(a.topology.nodes.size(), b.topology.nodes.size());
  for (std::size_t n = 0; n < a.topology.nodes.size(); ++n) {
    ASSERT_EQ(a.topology.nodes[n].first, b.topology.nodes[n].first);
    ASSERT_EQ(a.topology.nodes[n].count, b.topology.nodes[n].count);
    ASSERT_EQ(a.topology.nodes[n].level, b.topology.nodes[n].level);
    ASSERT_EQ(a.topology.nodes[n].leaf, b.topology.nodes[n].leaf);
  }
  ASSERT_EQ(a.topology.entries, b.topology.entries);
  ASSERT_EQ(a.topology.work.size(), b.topology.work.size());
  for (std::size_t n = 0; n < a.topology.work.size(); ++n) {
    ASSERT_EQ(a.topology.work[n].listed, b.topology.work[n].listed);
    ASSERT_EQ(a.topology.work[n].overlaps, b.topology.work[n].overlaps);
  }
  ASSERT_EQ(a.primitives, b.primitives);
  ASSERT_EQ(a.quadrics, b.quadrics);
  ASSERT_EQ(a.materials, b.materials);
  ASSERT_EQ(a.voxels, b.voxels);
  ASSERT_EQ(a.lights, b.lights);
  ASSERT_EQ(a.texture_begin, b.texture_begin);
  ASSERT_EQ(a.rows.size(), b.rows.size());
  for (std::size_t y = 0; y < a.rows.size(); ++y) {
    ASSERT_EQ(a.rows[y].words, b.rows[y].words);
    ASSERT_EQ(a.rows[y].begin, b.rows[y].begin);
  }
}

inline void expect_equal(const FrameLog& a, const FrameLog& b) {
  ASSERT_EQ(a.row, b.row);
  expect_equal(*a.log, *b.log);
}

/// A log with a row of which nothing is known.
inline FrameLog frame_of(processors::WorkLog log) {
  FrameLog frame{std::make_shared<const processors::WorkLog>(std::move(log)), {}};
  frame.row.counters.resize(frame_columns().size());
  return frame;
}

inline FrameLog random_frame(marti::test::Random& random, std::uint32_t width, std::uint32_t height) {
  processors::WorkLog log = marti::test::random_log(random, width, height);
  log.lights = 5;
  if (random() % 2 == 0) {
    marti::test::add_random_work(random, log.topology);
  }
  FrameLog frame{std::make_shared<const processors::WorkLog>(std::move(log)), {}};
  for (std::size_t column = 0; column < frame_columns().size(); ++column) {
    frame.row.counters.push_back(random() % 3 == 0 ? std::nullopt
                                                   : std::optional(static_cast<std::int64_t>(random())));
  }
  frame.row.scene = "caf\xe9 \"x\"";  // not UTF-8: a path may be any bytes
  frame.row.scene_hash = std::to_string(random());
  frame.row.image_hash = std::to_string(random());
  frame.row.hit_hash = std::to_string(random());
  frame.row.notes.resize(random() % 3, "a\nnote");
  return frame;
}

inline std::string key_of(std::uint64_t number) {
  std::string key(32, '0');
  for (std::size_t i = 32; number != 0; number /= 16) {
    key[--i] = "0123456789abcdef"[number % 16];
  }
  return key;
}

inline std::string bytes_of(const FrameLog& frame, const std::string& key = key_of(1),
                            std::string_view program = "1.2.3") {
  std::string bytes;
  write_log([&](std::string_view piece) { bytes += piece; }, frame, key, program);
  return bytes;
}

inline FrameLog log_of(const std::string& bytes, const std::string& key = key_of(1),
                       std::string_view program = "1.2.3",
                       std::uint64_t max_bytes = std::uint64_t{1} << 30U) {
  return read_log(*log_memory_source(bytes, "these bytes"), key, program, max_bytes);
}

}  // namespace marti::studies::test
