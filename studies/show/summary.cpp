#include "studies/show/summary.h"

#include <fmt/format.h>

#include <iterator>
#include <optional>
#include <utility>

#include "scenes/open.h"
#include "sim/statistics.h"
#include "studies/figures/memory_names.h"
#include "studies/run/plan/plan_output.h"
#include "studies/show/result_parts.h"
#include "studies/show/text_columns.h"
#include "studies/tables/text_units.h"

namespace marti::studies::show {

namespace {

using Lines = std::back_insert_iterator<std::string>;

std::string ratio(std::optional<double> value, int digits) {
  return value ? fmt::format("{:.{}f}", *value, digits) : "-";
}

std::string percent(std::optional<double> share) { return share ? studies::tables::percent(*share) : "-"; }

std::string percent(std::uint64_t part, std::uint64_t whole) {
  return percent(sim::ratio(static_cast<std::int64_t>(part), static_cast<std::int64_t>(whole)));
}

void scene_lines(Lines out, const run::RunResult& r) {
  const scenes::SceneFacts& scene = r.functional.scene;
  fmt::format_to(out, "scene         {}: {}, {}", scenes::short_source(r.frame_config.scene),
                 tables::counted(scene.polygons, "polygon"), tables::counted(scene.triangles, "triangle"));
  for (const auto& [count, name] : {std::pair{scene.spheres, "sphere"},
                                    std::pair{scene.cylinders, "cylinder"}, std::pair{scene.cones, "cone"}}) {
    if (count > 0) {
      fmt::format_to(out, ", {}", tables::counted(count, name));
    }
  }
  fmt::format_to(out, ", {}, {}\n", tables::counted(scene.materials, "material"),
                 tables::counted(scene.lights, "light"));
  for (const std::string& note : r.functional.notes) {
    fmt::format_to(out, "  note        {}\n", note);
  }
  const processors::program::WorkLog& log = *r.functional.frame.log;
  fmt::format_to(out, "structure     {}: {}, {}", r.frame_config.structure,
                 tables::counted(log.topology.nodes.size(), "node"),
                 tables::counted(log.topology.entries.size(), "object reference"));
  if (!r.functional.levels.empty()) {
    fmt::format_to(out, ", {}", tables::counted(r.functional.levels.size(), "level"));
  }
  for (const std::string& note : r.functional.structure_notes) {
    fmt::format_to(out, "\n  note        {}", note);
  }
  fmt::format_to(out, "\n");
}

void image_lines(Lines out, const run::RunResult& r) {
  const processors::program::WorkLog& log = *r.functional.frame.log;
  const processors::program::LogTotals& totals = r.functional.totals;
  const double rays = static_cast<double>(totals.all_rays());
  if (log.integrator == processors::program::Integrator::rays) {
    fmt::format_to(out, "rays          {} (closest hit {}, any hit {}), in {} rows of {}\n",
                   tables::grouped(totals.all_rays()), tables::grouped(totals.rays[0]),
                   tables::grouped(totals.rays[1]), log.height, log.width);
  } else if (processors::program::sends_any_hit_rays(log.integrator)) {
    fmt::format_to(out, "image         {}, {}{} rays (camera {}, {} {})\n",
                   keys::size_text(r.frame_config.render),
                   log.samples == 1 ? std::string() : fmt::format("{} samples a pixel, ", log.samples),
                   tables::grouped(totals.all_rays()), tables::grouped(totals.rays[0]),
                   processors::program::integrator_names[static_cast<std::size_t>(log.integrator)],
                   tables::grouped(totals.rays[1]));
  } else if (log.integrator == processors::program::Integrator::gaussians) {
    fmt::format_to(out, "image         {}, {}{} rays (camera {}, further rounds {})\n",
                   keys::size_text(r.frame_config.render),
                   log.samples == 1 ? std::string() : fmt::format("{} samples a pixel, ", log.samples),
                   tables::grouped(totals.all_rays()), tables::grouped(totals.rays[0]),
                   tables::grouped(totals.rays[3]));
  } else {
    fmt::format_to(
        out, "image         {}, {}{} rays (camera {}, shadow {}, reflection {}, refraction {}{})\n",
        keys::size_text(r.frame_config.render),
        log.samples == 1 ? std::string() : fmt::format("{} samples a pixel, ", log.samples),
        tables::grouped(totals.all_rays()), tables::grouped(totals.rays[0]), tables::grouped(totals.rays[1]),
        tables::grouped(totals.rays[2]), tables::grouped(totals.rays[3]),
        log.integrator == processors::program::Integrator::path
            ? fmt::format(", diffuse {}", tables::grouped(totals.rays[4]))
            : std::string());
  }
  fmt::format_to(out, "work log      {}, {:.1f} bytes and {:.1f} steps a ray\n",
                 tables::bytes(static_cast<double>(totals.bytes)), static_cast<double>(totals.bytes) / rays,
                 static_cast<double>(totals.all_steps()) / rays);
}

void voxel_lines(Lines out, const run::RunResult& r) {
  if (!r.functional.voxel_cut) {
    return;
  }
  const run::VoxelReport& report = *r.functional.voxel_cut;
  const processors::program::Frame& frame = r.functional.frame;
  fmt::format_to(out, "voxel cut     below {:g} pixels: ", r.frame_config.render.voxel_cut);
  if (frame.voxels == 0) {
    fmt::format_to(out, "no cell of the tree is that small\n");
  } else {
    const std::uint64_t rays = frame.rays.all() - frame.rays.traced[1];
    const std::uint64_t taken = frame.rays.voxels[0] + frame.rays.voxels[2] + frame.rays.voxels[3];
    fmt::format_to(out, "{} voxels from level {} on; {} rays saw one ({} of all but shadow rays)\n",
                   tables::grouped(std::uint64_t{frame.voxels}), frame.first_voxel_level,
                   tables::grouped(taken), percent(taken, rays));
  }
  const auto use = [&](std::string_view name, const run::DatabaseUse& u,
                       const processors::program::LogTotals& totals) {
    const accel::Topology& topology = frame.log->topology;
    const memory::LayoutConfig& layout = r.machine.layout;
    const std::uint64_t needed = u.nodes * layout.node_bytes + u.entries * layout.entry_bytes +
                                 u.primitives * layout.primitive_bytes + u.voxels * layout.material_bytes;
    fmt::format_to(out, "  {:<12}reads {} nodes ({}), {} of the lists, {} of the primitives, {} voxels: {}\n",
                   name, tables::grouped(u.nodes), percent(u.nodes, topology.nodes.size()),
                   percent(u.entries, topology.entries.size()), percent(u.primitives, frame.log->primitives),
                   tables::grouped(u.voxels), tables::bytes(static_cast<double>(needed)));
    fmt::format_to(out, "  {:<12}{} steps, {:.1f} a ray\n", "", tables::grouped(totals.all_steps()),
                   static_cast<double>(totals.all_steps()) / static_cast<double>(totals.all_rays()));
  };
  use("cut", report.use, r.functional.totals);
  if (report.exact) {
    const run::ImageError& error = report.exact->error;
    const std::size_t pixels = frame.image.pixels.size();
    use("exact", report.exact->use, report.exact->totals);
    fmt::format_to(
        out, "  {:<12}RMSE {:.5f}, largest {:.3f}, {} of the pixels changed, {} by more than 1/255\n",
        "error", error.rmse, error.largest, percent(error.changed, pixels), percent(error.visible, pixels));
  }
}

void machine_lines(Lines out, const run::RunResult& r) {
  const processors::machine::MachineConfig& machine = r.machine;
  fmt::format_to(out, "machine       {} of {}, {} scheme, {} of {} x {}\n",
                 tables::counted(machine.clusters, "cluster"), tables::counted(machine.nodes, "node"),
                 processors::machine::scheme_names[static_cast<std::size_t>(machine.scheme)],
                 tables::counted(r.timed.packets, "packet"), machine.packets.width, machine.packets.height);
  out = std::ranges::copy(note_lines(r), out).out;
  const bool spread = machine.placement == processors::machine::Placement::distributed;
  fmt::format_to(
      out, "database      {}, {} cop{}: {} in all{}\n",
      tables::bytes(static_cast<double>(r.timed.database_bytes)), tables::grouped(r.timed.copies),
      r.timed.copies == 1 ? "y" : "ies",
      tables::bytes(static_cast<double>(r.timed.database_bytes) * static_cast<double>(r.timed.copies)),
      spread ? fmt::format(", spread over {} in units of {}", tables::counted(machine.nodes, "node"),
                           tables::bytes(machine.distribution.interleave))
             : "");
  fmt::format_to(out, "\nframe time    {} = {} node cycles\n", tables::seconds(r.timed.end),
                 tables::grouped(r.timed.end / machine.clock.period()));
  fmt::format_to(out, "speed-up      {} on {}, efficiency {}, serial fraction (Karp-Flatt) {}\n",
                 ratio(r.figure("speed_up"), 2), tables::counted(r.machine.all_nodes(), "node"),
                 ratio(r.figure("efficiency"), 3), ratio(r.figure("serial_fraction"), 4));
  fmt::format_to(out, "one node      {}\n", tables::seconds(r.one_node.end));
}

void time_lines(Lines out, const run::RunResult& r) {
  fmt::format_to(out, "\nwhere the nodes' time goes\n");
  for (const std::string_view activity : processors::cost::activity_names) {
    const std::string name(activity);
    if (figures::count_of(r.counts, "time_" + name) != 0) {
      fmt::format_to(out, "  {:<20}{:>9}\n", name, percent(r.figure("share_" + name)));
    }
  }
}

// "mean wait 0.1 us, ..." at a queue, "bank" for example.
std::string waiting(const run::RunResult& r, const std::string& queue) {
  const std::optional<double> mean = r.figure("mean_" + queue + "_wait");
  if (!mean) {
    return "no transactions";
  }
  return fmt::format("mean wait {}, 95 % below {}, longest {}", tables::computed_seconds(*mean),
                     tables::seconds(r.count(queue + "_wait_p95")),
                     tables::seconds(r.count(queue + "_wait_max")));
}

void distribution_lines(Lines out, const run::RunResult& r) {
  const std::int64_t remote = r.count("distributed_remote_reads") + r.count("distributed_remote_writes");
  const std::int64_t all = remote + r.count("distributed_local_reads") + r.count("distributed_local_writes");
  fmt::format_to(out,
                 "\n{:<14}{} messages, {} with their headers, {:.1f} hops each; {} of the accesses remote\n",
                 "network", tables::grouped(r.count("network_messages")),
                 tables::bytes(static_cast<double>(r.count("network_bytes"))),
                 r.figure("hops_a_message").value_or(0.0), percent(sim::ratio(remote, all)));
  if (const std::optional<double> used = r.figure("interconnect_utilisation")) {
    fmt::format_to(out, "  {:<12}{} of its links busy, {}\n",
                   memory::network_kind_names[static_cast<std::size_t>(r.machine.network.kind)],
                   tables::rough_percent(*used), waiting(r, "network"));
    fmt::format_to(out, "{}", network_bandwidth_line(r));
  }
}

void dram_lines(Lines out, const run::RunResult& r) {
  const auto share = [&](std::string_view figure) { return percent(r.figure(std::string(figure))); };
  fmt::format_to(out, "  {:<12}{} of the bursts hit, {} conflict; {:.2f} accesses in a queue\n", "rows",
                 share("dram_row_hit_ratio"), share("dram_row_conflict_ratio"),
                 r.figure("dram_queue_length").value_or(0.0));
  fmt::format_to(out, "{}", dram_bandwidth_line(r));
}

void memory_lines(Lines out, const run::RunResult& r) {
  const TextColumns table = {14, {15, 16, 11, 16}};
  fmt::format_to(out, "\n{}", table.row("references", {"lines", "misses", "hit ratio", "per 1000 steps"}));
  const auto line = [&](std::string_view name, const std::string& prefix, const std::string& kind) {
    const std::int64_t misses = r.count(prefix + "misses");
    if (const std::int64_t lines = r.count(prefix + "hits") + misses; lines > 0) {
      fmt::format_to(
          out, "{}",
          table.row(fmt::format("  {}", name),
                    {tables::grouped(lines), tables::grouped(misses), percent(r.figure("hit_ratio" + kind)),
                     ratio(r.figure("misses_a_thousand_steps" + kind), 2)}));
    }
  };
  for (const std::string_view kind : memory::record_kind_names) {
    line(kind, std::string(kind) + "_", "_" + std::string(kind));
  }
  line("all", "", "");
  fmt::format_to(out, "{}", second_level_line(r));
  if (r.machine.scheme == processors::machine::Scheme::space) {
    return;  // nodes share no memory
  }

  const double moved = static_cast<double>(r.count("interconnect_bytes"));
  const bool distributed = r.machine.placement == processors::machine::Placement::distributed;
  const bool ideal = r.machine.interconnect.kind == memory::InterconnectKind::ideal;
  if (ideal && !distributed) {
    fmt::format_to(out, "\ninterconnect  ideal, {} moved\n", tables::bytes(moved));
    return;
  }
  if (distributed) {
    distribution_lines(out, r);
  } else {
    fmt::format_to(out, "\n{:<14}{} busy, {}, {} moved\n", figures::interconnect_name(r.machine),
                   tables::rough_percent(r.figure("interconnect_utilisation").value_or(0.0)),
                   waiting(r, "interconnect"), tables::bytes(moved));
    fmt::format_to(out, "{}", interconnect_bandwidth_line(r));
  }
  const bool dram = r.machine.banks.dram.has_value() && !distributed;
  fmt::format_to(out, "{:<14}{} busy (the busiest {}), {}\n",
                 distributed ? "memories"
                 : dram      ? "DRAM channels"
                             : "banks",
                 tables::rough_percent(r.figure("mean_bank_utilisation").value_or(0.0)),
                 tables::rough_percent(r.figure("bank_utilisation").value_or(0.0)), waiting(r, "bank"));
  if (dram) {
    dram_lines(out, r);
  }
}

}  // namespace

std::string scene_summary_of(const run::RunResult& r) {
  std::string text;
  scene_lines(std::back_inserter(text), r);
  return text;
}

std::string summary_of(const run::RunResult& r) {
  std::string text = fmt::format("answer        {} a frame{}\n\n", tables::seconds(r.timed.end),
                                 r.helps && r.helps->measured ? "; " + r.helps->sentence : std::string());
  text += scene_summary_of(r);
  const Lines out = std::back_inserter(text);
  image_lines(out, r);
  voxel_lines(out, r);
  text += run::plan_lines(r.plan);
  machine_lines(out, r);
  text += loss_lines(r);
  time_lines(out, r);
  memory_lines(out, r);
  for (const auto& lines : {energy_lines, counts_lines, working_set_lines, critical_path_lines, context_lines,
                            simt_lines, build_lines, flow_lines, bound_lines, record_lines, helps_lines}) {
    text += lines(r);
  }
  return text;
}

}  // namespace marti::studies::show
