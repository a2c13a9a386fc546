// Plans and rows made up for tests of the store.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <random>
#include <string>

#include "studies/sweep/plan/sweep_plan.h"
#include "studies/sweep/plan/sweep_row.h"
#include "studies/sweep/store/sweep_store.h"
#include "tests/support/store_dump.h"

namespace marti::test {

/// A key as a plan has them: 32 hexadecimal digits.
inline std::string made_key(std::uint64_t number) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string key(32, '0');
  for (std::size_t i = 0; i < 16; ++i) {
    key[31 - i] = digits[number >> (4 * i) & 15U];
  }
  return key;
}

/// Machines on two frames, with as many settings as real ones have; the point of every machine but the first
/// is measured against the first.
inline studies::sweep::SweepPlan made_plan(std::size_t machines, std::size_t first = 0) {
  studies::sweep::SweepPlan plan;
  studies::sweep::SettingsPool pool;
  plan.axes = {"point", "machine.nodes", "cache.size", "bus.\"odd\"", "l2.on"};
  for (std::size_t frame = 0; frame < 2; ++frame) {
    studies::sweep::SweepFrame& made = plan.frames.emplace_back();
    made.key = made_key(1000000 + frame);
    made.settings = {{"scene.source", "\"teapot:" + std::to_string(frame) + "\"", true, ""},
                     {"image.width", "512", false, ""}};
  }
  for (std::size_t i = first; i < first + machines; ++i) {
    studies::sweep::SweepMachine& made = plan.machines.emplace_back();
    made.key = made_key(i);
    made.frame = i % 2;
    std::vector<sim::EffectiveValue> settings;
    for (const char* section : {"machine", "cache", "interconnect", "banks", "host", "packets", "costs",
                                "layout", "local", "database", "build", "l2"}) {
      for (int key = 0; key < 6; ++key) {
        settings.push_back({std::string(section) + ".key" + std::to_string(key), "\"16 KiB\"", false, ""});
      }
    }
    settings[0].value = std::to_string(i % 64);
    settings[6].value = "\"" + std::to_string(i / 64) + " KiB\"";
    made.settings = pool.share(std::move(settings));
    plan.points.push_back({{std::string("named"), static_cast<std::int64_t>(i % 64),
                            0.5 * static_cast<double>(i), std::string("it's \"quoted\"; --"), i % 2 == 0},
                           i - first,
                           0,
                           1.5 * static_cast<double>(i)});
  }
  plan.compare = 0;
  plan.filtered_out = 3;
  return plan;
}

using Random = std::mt19937_64;

/// Any row that a machine could have.
inline studies::sweep::SweepRow random_sweep_row(Random& random) {
  studies::sweep::SweepRow row;
  for (std::size_t i = 0; i < studies::figures::counted_figures().size(); ++i) {
    row.counters.emplace_back();
    if (random() % 3 != 0) {
      row.counters.back() = studies::figures::rounded(
          static_cast<studies::figures::Count>(random() >> (1 + random() % 63)) << random() % 32);
    }
  }
  row.counters[0] = 1 + static_cast<std::int64_t>(random() % 1000000);
  for (std::string& histogram : row.histograms) {
    std::int64_t lowest = 0;
    for (std::uint64_t left = random() % 5; left > 0; --left) {
      const auto highest = lowest + static_cast<std::int64_t>(random() % 1000);
      histogram +=
          fmt::format("{}[{},{},{}]", histogram.empty() ? '[' : ',', lowest, highest, 1 + random() % 99);
      lowest = highest + 1;
    }
    histogram += histogram.empty() ? "" : "]";
  }
  return row;
}

/// The row of a machine in every run of these tests.
inline studies::sweep::SweepRow made_row(std::size_t machine) {
  Random random(machine);
  return random_sweep_row(random);
}

/// One whose figures can be reported: times that are not 0, and sums that fit.
inline studies::sweep::SweepRow plain_row(std::size_t machine) {
  studies::sweep::SweepRow row = made_row(machine);
  for (std::optional<studies::figures::Count>& counter : row.counters) {
    counter = static_cast<std::int64_t>(1000 + 10 * machine);
  }
  return row;
}

inline studies::sweep::FrameRow made_frame_row(std::size_t frame) {
  studies::sweep::FrameRow row;
  row.counters.resize(studies::run::frame_figures().size());
  row.counters[frame] = static_cast<std::int64_t>(7 * frame);
  row.scene = "teapot's \"lid\"";
  row.scene_hash = row.image_hash = row.hit_hash = "0123456789abcdef";
  row.notes = {"first", "", "third"};
  return row;
}

/// Writes a store of the plan with the rows of its frames and of those machines that `row_of` gives one.
template <class RowOf, class FrameRowOf = studies::sweep::FrameRow (*)(std::size_t)>
void write_store(const std::filesystem::path& file, const studies::sweep::SweepPlan& plan,
                 const RowOf& row_of, const FrameRowOf& frame_row_of = made_frame_row) {
  std::filesystem::create_directories(file.parent_path());
  studies::sweep::SweepStore store(file, plan);
  for (std::size_t frame = 0; frame < plan.frames.size(); ++frame) {
    store.add_frame(frame, frame_row_of(frame), 1);
  }
  for (std::size_t machine = 0; machine < plan.machines.size(); ++machine) {
    const std::optional<studies::sweep::SweepRow> row = row_of(machine);
    if (row) {
      store.add_result(machine, *row, 1);
    }
  }
  store.close();
}

/// A store whose point i has seed i % 3 of the image and i / 3 + 1 nodes, and a frame of `ends`[i].
inline void write_store_of_seeds(const std::filesystem::path& file, const std::vector<std::int64_t>& ends) {
  studies::sweep::SweepPlan plan = made_plan(ends.size());
  plan.axes = {"image.seed", "machine.nodes"};
  for (std::size_t i = 0; i < ends.size(); ++i) {
    plan.points[i].values = {static_cast<std::int64_t>(i % 3), static_cast<std::int64_t>(i / 3 + 1)};
    plan.machines[i].frame = 0;
  }
  write_store(file, plan, [&](std::size_t machine) {
    studies::sweep::SweepRow row = plain_row(machine);
    row.counters[0] = ends[machine];
    return std::optional(row);
  });
}

}  // namespace marti::test
