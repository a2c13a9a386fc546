// The fields of a work log, and of what stands before it in its file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "processors/program/work_log.h"
#include "studies/log_file/fields.h"

namespace marti::studies::log_file {

inline constexpr std::size_t primitive_kinds = static_cast<std::size_t>(accel::PrimitiveKind::cone) + 1;

/// What a log was made with, as far as it decides whether a machine can be timed on it.
struct LogHead {
  struct Setting {
    std::string key;
    std::string value;  ///< as it stands in a TOML file
  };
  std::vector<Setting> settings;  ///< the frame's: scene, frames, image, structure
  std::string program;            ///< build of the program that made the log
  // Of RenderOptions:
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  bool entered = false;
  bool ray_words = false;
  bool meets = false;
  accel::WalkOrder order = accel::WalkOrder::depth_first;
  std::uint32_t treelet_records = 0;
};

template <class Stream, Described<LogHead> Head>
void describe(Fields<Stream>& fields, Head& head) {
  fields.each(head.settings, [&](auto& setting) { fields(setting.key, setting.value); });
  fields(head.program, head.width, head.height, head.entered, head.ray_words, head.meets,
         head.treelet_records);
  fields.choice(head.order, accel::walk_order_names.size());
}

template <class Stream, Described<processors::program::WorkLog> Log>
void describe(Fields<Stream>& fields, Log& log) {
  fields.choice(log.traversal, accel::traversals);
  fields.choice(log.integrator, processors::program::integrator_names.size());
  fields.choice(log.order, accel::walk_order_names.size());
  fields(log.treelet_records, log.mailboxes, log.width, log.height, log.samples);
  fields.each(log.topology.nodes,
              [&](auto& node) { fields(node.first, node.count, node.level, node.leaf, node.instance); });
  fields(log.topology.entries);
  fields.each(log.topology.work, [&](auto& work) { fields(work.listed, work.overlaps); });
  fields(log.primitives);
  fields.each(log.quadrics, [&](auto& kind) { fields.choice(kind, primitive_kinds); });
  fields(log.materials, log.voxels, log.lights, log.texture_begin);
  fields.each(log.rows, [&](auto& row) {
    fields(row.words, row.begin);
    for (auto* beside : {&row.entered, &row.rays, &row.meets}) {
      fields(beside->words, beside->begin);
    }
  });
}

}  // namespace marti::studies::log_file
