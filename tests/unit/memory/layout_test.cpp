#include "memory/layout.h"

#include <gtest/gtest.h>

#include "sim/error.h"

namespace marti::memory {
namespace {

TEST(Layout, RecordsDoNotOverlapAndSectionsAreAligned) {
  LayoutConfig config;
  config.node_bytes = 10;
  config.record_alignment = 8;
  config.section_alignment = 256;
  config.transform_bytes = 21;
  const RecordCounts counts = {7, 6, 11, 5, 3, 2, 9};
  const Layout layout(config, counts);
  Address last_end = 0;
  for (std::size_t k = 0; k < record_kinds; ++k) {
    const auto kind = static_cast<RecordKind>(k);
    EXPECT_EQ(layout.base(kind) % 256, 0U);
    for (std::uint64_t i = 0; i < counts[k]; ++i) {
      EXPECT_GE(layout.address(kind, i), last_end);
      last_end = layout.address(kind, i) + layout.record_bytes(kind);
    }
  }
  EXPECT_EQ(layout.address(RecordKind::node, 3), 48U) << "10 bytes aligned to 8 are 16 apart";
  EXPECT_EQ(layout.end(), last_end);
  EXPECT_EQ(layout.database_bytes(), 7U * 16 + 6 * 24 + 11 * 4 + 5 * 48 + 3 * 64 + 2 * 4);
}

TEST(Layout, ASectionWithoutRecordsTakesNoRoom) {
  const Layout layout(LayoutConfig{}, {512, 0, 1, 1, 1, 0, 1});
  EXPECT_EQ(layout.base(RecordKind::list), 4096U);
  EXPECT_EQ(layout.kind_at(4096), RecordKind::list);
}

TEST(Layout, QuadricsFollowTheTrianglesWithTheirOwnSize) {
  LayoutConfig config;
  config.primitive_bytes = 45;
  config.quadric_bytes = 21;
  config.record_alignment = 4;
  const RecordCounts counts = {1, 0, 1, 5, 1, 0, 1};
  const Layout layout(config, counts, 2);
  const Address base = layout.base(RecordKind::primitive);
  for (std::uint64_t i = 0; i < 5; ++i) {
    EXPECT_EQ(layout.address(RecordKind::primitive, i), base + (i < 3 ? 48 * i : 144 + 24 * (i - 3)));
    EXPECT_EQ(layout.record_bytes(RecordKind::primitive, i), i < 3 ? 45U : 21U);
  }
  EXPECT_EQ(layout.section_bytes(RecordKind::primitive), 3U * 48 + 2 * 24);
  EXPECT_GE(layout.base(RecordKind::material), base + 3U * 48 + 2 * 24);
  EXPECT_EQ(layout.database_bytes(), 8U + 4 + 3 * 48 + 2 * 24 + 64);
  // All of them, or none.
  EXPECT_EQ(Layout(config, counts, 5).address(RecordKind::primitive, 4), base + 96);
  EXPECT_EQ(Layout(config, counts).address(RecordKind::primitive, 4), base + 192);
  EXPECT_THROW(Layout(config, counts, 6), sim::InternalError);
}

TEST(Layout, RefusesImpossibleSizes) {
  LayoutConfig config;
  config.node_bytes = 0;
  EXPECT_THROW(Layout(config, RecordCounts{}), sim::UserError);
  config = {};
  config.record_alignment = 3;
  EXPECT_THROW(Layout(config, RecordCounts{}), sim::UserError);
  EXPECT_THROW(Layout(LayoutConfig{}, RecordCounts{~std::uint64_t{0}, 0, 0, 0, 0, 0, 0}), sim::UserError);
}

}  // namespace
}  // namespace marti::memory
