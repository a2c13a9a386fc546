// Configuration of the schemes in which rays move from node to node: pipeline and space.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace marti::processors::machine {

/// image: a node takes a packet of pixels and traces it whole. pipeline: nodes search, intersect or shade,
/// and rays go round between them (after LINKS-1). space: a node holds a part of space, and rays go to the
/// node whose part they enter.
enum class Scheme : std::uint8_t { image, pipeline, space };
inline constexpr std::array<std::string_view, 3> scheme_names = {"image", "pipeline", "space"};

/// Sizes and costs of messages. A ray message holds origin, direction, weight, pixel, kind, bounce, and the
/// ray's place in its walk; a contribution holds pixel and colour.
struct MessageConfig {
  std::uint32_t ray_bytes = 64;
  std::uint32_t contribution_bytes = 16;
  std::int64_t send_cycles = 0;     ///< of a node's clock, to compose and send one message
  std::int64_t receive_cycles = 0;  ///< of a node's clock, to take one message from the queue
};

/// How many of each cluster's nodes are stages of each kind: the first ones search, the next ones are for the
/// nearest hit, the last shade. The sum is MachineConfig::nodes; each is at least 1.
struct PipelineConfig {
  std::uint32_t search = 5;
  std::uint32_t nearest = 9;
  std::uint32_t shade = 2;
  std::uint32_t queue = 16;     ///< rays that wait before each node, at least 1
  std::uint32_t in_flight = 0;  ///< most rays admitted at a time; 0: the most that cannot deadlock
};

inline constexpr std::uint32_t pipeline_stages = 3;

/// Divides `nodes` (at least 3) among stages in the ratio of PipelineConfig's defaults, each at least 1.
[[nodiscard]] PipelineConfig default_stages(std::uint32_t nodes);

/// How many rays may be in flight at a time without a deadlock, in which a cycle of stages is full and each
/// waits for the next: one less than fill the queues and nodes of the search stage and of the smaller of the
/// other two stages. See docs/internals/pipeline.md.
[[nodiscard]] std::uint32_t most_in_flight(const PipelineConfig& pipeline);

/// How regions are dealt out. blocks: runs of neighbouring regions. scatter: region i to node i modulo nodes.
/// balanced: by the number of primitives in them. sampled: by the work of a pre-pass over few pixels.
enum class RegionPolicy : std::uint8_t { blocks, scatter, balanced, sampled };
inline constexpr std::array<std::string_view, 4> region_policy_names = {"blocks", "scatter", "balanced",
                                                                        "sampled"};

struct SpaceConfig {
  RegionPolicy policy = RegionPolicy::scatter;
  std::uint32_t level = 4;      ///< regions are the subtrees whose roots lie on this level (root: 1)
  std::uint32_t queue = 16;     ///< rays that wait in a node's message buffer, at least 1
  std::uint32_t in_flight = 0;  ///< most rays in flight at a time; 0: half of all message buffers, at least 1
  std::uint32_t sample_step = 8;  ///< sampled: pixels of the pre-pass are so many columns and rows apart
};

}  // namespace marti::processors::machine
