// Logs written and read back: nothing is lost, and nothing wrong is taken for a log.
#include "studies/sweep/log_file.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <sys/stat.h>
#include <tbb/global_control.h>

#include <array>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "accel/structure.h"
#include "kept_logs.h"
#include "processors/program/render.h"
#include "processors/replay.h"
#include "scenes/procedural.h"
#include "studies/sweep/zstd_block.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"

namespace marti::studies {
namespace {

using marti::test::pick;
using marti::test::Random;
using marti::test::user_error_of;
using test::bytes_of;
using test::expect_equal;
using test::key_of;
using test::log_of;

constexpr std::size_t start_bytes = 16;  // magic, byte order, format
constexpr std::size_t head_bytes = 24;

void expect_refused(const std::string& bytes, std::string_view reason) {
  const std::string message = user_error_of([&] { static_cast<void>(log_of(bytes)); });
  EXPECT_TRUE(message.starts_with("these bytes: is not a whole work log of this program: ")) << message;
  EXPECT_NE(message.find(reason), std::string::npos) << message;
}

/// A floor with a texture, a mirror on it and spheres above.
scenes::Scene textured_scene() {
  scenes::Scene scene = scenes::make_procedural("balls:1");
  scenes::Texture& texture = scene.textures.emplace_back();
  texture.width = 3;
  texture.height = 2;
  texture.texels.resize(6, {200, 100, 50, 255});
  for (scenes::Material& material : scene.materials) {
    material.texture = 0;
  }
  scene.uvs.resize(scene.positions.size());
  for (std::size_t i = 0; i < scene.uvs.size(); ++i) {
    scene.uvs[i] = {static_cast<double>(i % 3), static_cast<double>(i % 2)};
  }
  return scene;
}

processors::WorkLog real_log(Random& random) {
  const std::array<const char*, 4> names = {"teapot:2", "lattice:1", "jacks:1", "shells:1"};
  const std::size_t choice = random() % (names.size() + 1);
  const scenes::Scene scene =
      choice == names.size() ? textured_scene() : scenes::make_procedural(names[choice]);
  const auto triangles = std::make_shared<const accel::TriangleSet>(scene);
  const std::string_view kind = accel::structure_kinds()[random() % accel::structure_kinds().size()];
  const auto structure = accel::make_structure(kind, triangles);
  processors::RenderOptions options;
  options.width = static_cast<std::uint32_t>(pick(random, 1, 16));
  options.height = static_cast<std::uint32_t>(pick(random, 1, 16));
  options.max_depth = static_cast<std::uint32_t>(pick(random, 1, 3));
  options.mailboxes = random() % 2 == 0;
  options.samples = static_cast<std::uint32_t>(pick(random, 1, 3));
  options.voxel_cut = kind == "octree" && scene.quadrics.empty() && random() % 2 == 0 ? 8.0 : 0.0;
  options.record = true;
  return *processors::render(scene, *triangles, *structure, options).log;
}

RC_GTEST_PROP(LogFile, RealLogsComeBackAndReplayTheSame, (std::uint64_t seed)) {
  Random random(seed);
  const FrameLog frame = test::frame_of(real_log(random));
  const FrameLog back = log_of(bytes_of(frame));
  expect_equal(frame, back);
  RC_ASSERT(!::testing::Test::HasFatalFailure());
  RC_ASSERT(bytes_of(back) == bytes_of(frame));
  RC_ASSERT(back.log->samples == frame.log->samples);
  const processors::MachineConfig machine = marti::test::random_machine(random);
  const processors::MachineResult before = processors::replay(*frame.log, machine);
  const processors::MachineResult after = processors::replay(*back.log, machine);
  RC_ASSERT(before.end == after.end);
  RC_ASSERT(before.events == after.events);
  for (std::size_t n = 0; n < before.nodes.size(); ++n) {
    RC_ASSERT(before.nodes[n].time == after.nodes[n].time);
    RC_ASSERT(before.nodes[n].references.misses == after.nodes[n].references.misses);
  }
}

RC_GTEST_PROP(LogFile, AnyLogComesBack, (std::uint64_t seed)) {
  Random random(seed);
  const FrameLog frame = test::random_frame(random, static_cast<std::uint32_t>(pick(random, 0, 20)),
                                            static_cast<std::uint32_t>(pick(random, 0, 20)));
  const std::string bytes = bytes_of(frame);
  RC_ASSERT(bytes == bytes_of(frame));
  expect_equal(frame, log_of(bytes));
  RC_ASSERT(!::testing::Test::HasFatalFailure());
}

/// Large enough for several blocks of nodes, entries and rows.
FrameLog large_frame() {
  Random random(7);
  processors::WorkLog log = marti::test::random_log(random, 200, 150);
  log.topology = marti::test::random_topology(random, 20'000, log.primitives, 4);
  marti::test::add_random_work(random, log.topology);
  for (processors::LogRow& row : log.rows) {
    for (std::uint32_t& word : row.words) {  // the tree is another
      word = processors::make_word(processors::Step::ray, word & 3U);
    }
  }
  return test::frame_of(std::move(log));
}

TEST(LogFile, ManyBlocksAreTheSameOnOneThread) {
  const FrameLog frame = large_frame();
  ASSERT_GT(frame.log->topology.nodes.size(), 2U << 16U);
  const std::string bytes = bytes_of(frame);
  expect_equal(frame, log_of(bytes));
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(bytes_of(frame), bytes);
  expect_equal(frame, log_of(bytes));
}

TEST(LogFile, AFileHoldsTheSameBytes) {
  const marti::test::TemporaryDirectory directory;
  const FrameLog frame = large_frame();
  const std::filesystem::path file = directory.path() / "log";
  write_log_file(file, frame, key_of(5), "1");
  expect_equal(frame, read_log(*log_file_source(file), key_of(5), "1", memory_of(*frame.log)));
  EXPECT_EQ(std::filesystem::file_size(file), bytes_of(frame, key_of(5), "1").size());
  EXPECT_LE(stated_memory(*log_file_source(file), key_of(5), "1"), memory_of(*frame.log));
  EXPECT_NE(user_error_of([&] { write_log_file(file, frame, key_of(5), "1"); }), "no UserError") << "exists";
}

TEST(LogFile, WhatIsNoFileIsRefused) {
  const marti::test::TemporaryDirectory directory;
  EXPECT_NE(user_error_of([&] {
              static_cast<void>(log_file_source(directory.path() / "none"));
            }).find("cannot be read: No such"),
            std::string::npos);
  EXPECT_NE(
      user_error_of([&] { static_cast<void>(log_file_source(directory.path())); }).find("not a regular file"),
      std::string::npos);
  const std::filesystem::path pipe = directory.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_NE(user_error_of([&] { static_cast<void>(log_file_source(pipe)); }).find("not a regular file"),
            std::string::npos);
  const FrameLog frame = large_frame();
  EXPECT_NE(user_error_of([&] {
              write_log_file(directory.path() / "no" / "log", frame, key_of(1), "1");
            }).find("cannot be written: No such"),
            std::string::npos);
}

TEST(LogFile, OtherLogsAreRefused) {
  Random random(3);
  const FrameLog frame = test::random_frame(random, 9, 9);
  expect_refused(bytes_of(frame, key_of(2)), "the log of another frame");
  expect_refused(bytes_of(frame, key_of(1), "1.2.4"), "written by 1.2.4, and this is 1.2.3");
  std::string bytes = bytes_of(frame);
  const std::string message = user_error_of([&] { log_of(bytes, key_of(1), "1.2.3", 1000); });
  EXPECT_NE(message.find("more than 1000 B"), std::string::npos) << message;
  ++bytes[12];
  expect_refused(bytes, "it has format 3, and this program's is 2");
  std::swap(bytes[8], bytes[11]);
  expect_refused(bytes, "another byte order");
  bytes[0] = 'M';
  expect_refused(bytes, "does not begin as one");
  expect_refused("", "ends too early");
}

TEST(LogFile, WrongOperandsAreRefused) {
  Random random(4);
  processors::WorkLog log = marti::test::random_log(random, 4, 4);
  log.lights = 5;
  log.rows[2].words[0] = processors::make_word(processors::Step::shade, 5);
  expect_refused(bytes_of(test::frame_of(log)), "a material that");
}

RC_GTEST_PROP(LogFile, ChangedBytesAreRefusedOrMeanTheSame, (std::uint64_t seed)) {
  Random random(seed);
  const FrameLog frame = test::random_frame(random, 6, 6);
  const std::string bytes = bytes_of(frame);
  for (int i = 0; i < 20; ++i) {
    std::string changed = bytes;
    switch (random() % 4) {
      case 0:
        changed.resize(random() % bytes.size());
        break;
      case 1:
        changed += bytes.substr(random() % bytes.size());
        break;
      case 2:
        changed.replace(random() % bytes.size(), random() % 40, bytes, random() % bytes.size(),
                        random() % 40);
        break;
      default:
        changed[random() % bytes.size()] ^= static_cast<char>(1U << (random() % 8));
    }
    try {
      expect_equal(frame, log_of(changed));
      RC_ASSERT(!::testing::Test::HasFatalFailure());
      // Zstandard leaves a bit of each block's head without meaning.
      RC_ASSERT(changed.size() == bytes.size());
    } catch (const sim::UserError&) {
    }
  }
}

/// A file's blocks: their items and raw bytes.
struct Block {
  std::uint64_t items = 0;
  std::string raw;
};

std::vector<Block> blocks_in(const std::string& bytes) {
  std::vector<Block> blocks;
  for (std::size_t at = start_bytes; at < bytes.size();) {
    std::array<std::uint64_t, 3> head{};
    std::memcpy(head.data(), bytes.data() + at, head_bytes);
    blocks.push_back({head[2], decompress_block(bytes.substr(at + head_bytes, head[0]), head[1])});
    at += head_bytes + head[0];
  }
  return blocks;
}

std::string file_of(const std::string& start, const std::vector<Block>& blocks) {
  std::string bytes = start.substr(0, start_bytes);
  for (const Block& block : blocks) {
    const std::string compressed = compress_block(block.raw);
    const std::array<std::uint64_t, 3> head = {compressed.size(), block.raw.size(), block.items};
    bytes.append(std::string_view(reinterpret_cast<const char*>(head.data()), head_bytes));
    bytes += compressed;
  }
  return bytes;
}

// Whoever makes a file on purpose gives it right checksums.
RC_GTEST_PROP(LogFile, WhatIsReadIsAlwaysALog, (std::uint64_t seed)) {
  Random random(seed);
  const std::string bytes = bytes_of(test::random_frame(random, 6, 6));
  const std::vector<Block> blocks = blocks_in(bytes);
  RC_ASSERT(file_of(bytes, blocks) == bytes);
  for (int i = 0; i < 20; ++i) {
    std::vector<Block> changed = blocks;
    for (std::uint64_t left = 1 + random() % 3; left > 0; --left) {
      Block& block = changed[random() % changed.size()];
      switch (random() % 8) {
        case 0:
          block.raw.resize(random() % (block.raw.size() + 9));
          break;
        case 1:
          block.items = random() % 2 == 0 ? random() : random() % 9;
          break;
        case 2:
          std::swap(block, changed[random() % changed.size()]);
          break;
        default:
          if (!block.raw.empty()) {
            const std::size_t at = random() % block.raw.size();
            block.raw[at] = random() % 3 == 0 ? '\xff' : static_cast<char>(random());
          }
      }
    }
    constexpr std::uint64_t most = 1U << 20U;
    try {
      const FrameLog frame = log_of(file_of(bytes, changed), key_of(1), "1.2.3", most);
      RC_ASSERT(memory_of(*frame.log) <= most);
      processors::validate(*frame.log);
      RC_ASSERT(processors::totals_of(*frame.log).bytes <= most);
    } catch (const sim::UserError&) {
    }
  }
}

// Sizes that would not fit anywhere take no memory.
TEST(LogFile, HugeSizesAreRefused) {
  Random random(11);
  const std::string bytes = bytes_of(test::random_frame(random, 6, 6));
  const std::vector<Block> blocks = blocks_in(bytes);
  // The shape ends the header: six sizes and the number of words.
  for (std::size_t size = 0; size < 7; ++size) {
    for (const unsigned shift : {29U, 32U, 47U, 52U, 63U}) {
      std::vector<Block> changed = blocks;
      const std::uint64_t huge = std::uint64_t{1} << shift;
      std::string& header = changed[0].raw;
      std::memcpy(header.data() + header.size() - 8 * (7 - size), &huge, sizeof huge);
      EXPECT_THROW(static_cast<void>(log_of(file_of(bytes, changed))), sim::UserError)
          << size << " " << shift;
    }
  }
  // A block that states more than its compressed bytes can stand for.
  std::string changed = bytes;
  const std::uint64_t huge = std::uint64_t{1} << 40U;
  std::memcpy(changed.data() + start_bytes + 8, &huge, sizeof huge);
  expect_refused(changed, "a block is not of the size");
}

}  // namespace
}  // namespace marti::studies
