// The targets without a fuzzer: every seed, and each seed damaged in some hundred ways that are the same each
// time. What a fuzzer once found lies in findings/ and is tried here too.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "target.h"

namespace marti::fuzz {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr int damages = 150;
constexpr std::size_t most_bytes = 1U << 16U;

std::vector<std::filesystem::path> files_in(const std::filesystem::path& directory,
                                            const std::vector<std::string>& endings) {
  std::vector<std::filesystem::path> files;
  if (std::filesystem::exists(directory)) {
    for (const auto& entry : std::filesystem::directory_iterator(directory)) {
      const std::string ending = entry.path().extension().string();
      if (std::find(endings.begin(), endings.end(), ending) != endings.end()) {
        files.push_back(entry.path());
      }
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

Bytes read(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// One of: a bit turned, bytes overwritten, cut off, taken out, doubled, or moved.
void damage(Bytes& bytes, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
  const std::size_t from = below(bytes.size());
  const std::size_t count = std::min(bytes.size() - from, 1 + below(12));
  const auto at = [&](std::size_t i) { return bytes.begin() + static_cast<std::ptrdiff_t>(i); };
  switch (below(5)) {
    case 0:
      bytes[from] ^= static_cast<std::uint8_t>(1U << below(8));
      break;
    case 1:
      std::generate(at(from), at(from + count), [&] { return static_cast<std::uint8_t>(random()); });
      break;
    case 2:
      bytes.erase(at(from), at(from + count));
      break;
    case 3: {
      const Bytes part(at(from), at(from + count));
      bytes.insert(at(below(bytes.size())), part.begin(), part.end());
      break;
    }
    default:
      bytes.resize(from);
  }
}

void try_seeds(const std::vector<std::filesystem::path>& seeds,
               const std::function<void(std::span<const std::uint8_t>)>& target) {
  ASSERT_FALSE(seeds.empty());
  std::mt19937 random(7);
  for (const std::filesystem::path& seed : seeds) {
    SCOPED_TRACE(seed.filename().string());
    const Bytes whole = read(seed);
    EXPECT_NO_THROW(target(whole));
    if (whole.empty() || whole.size() > most_bytes) {
      continue;
    }
    for (int i = 0; i < damages; ++i) {
      Bytes damaged = whole;
      for (std::size_t n = 1 + random() % 3; n > 0 && !damaged.empty(); --n) {
        damage(damaged, random);
      }
      EXPECT_NO_THROW(target(damaged)) << "damage " << i;
    }
  }
}

std::vector<std::filesystem::path> with_findings(std::vector<std::filesystem::path> seeds,
                                                 const char* target) {
  const auto found = files_in(std::filesystem::path(MARTI_SOURCE) / "tests/fuzz/findings" / target, {".txt"});
  seeds.insert(seeds.end(), found.begin(), found.end());
  return seeds;
}

TEST(FuzzSeeds, Configurations) {
  const std::filesystem::path configs = std::filesystem::path(MARTI_SOURCE) / "configs";
  try_seeds(with_findings(files_in(configs, {".toml"}), "config"), try_config);
}

TEST(FuzzSeeds, GltfFiles) {
  const std::filesystem::path source = MARTI_SOURCE;
  std::vector<std::filesystem::path> seeds = files_in(source / "configs/scenes", {".glb"});
  for (const char* folder : {"tests/fuzz/gltf", "tests/unit/scenes/compressed"}) {
    const auto more = files_in(source / folder, {".json", ".glb"});
    seeds.insert(seeds.end(), more.begin(), more.end());
  }
  try_seeds(with_findings(seeds, "gltf"), try_gltf);
}

TEST(FuzzSeeds, ObjFiles) {
  try_seeds(with_findings(files_in(MARTI_SOURCE "/tests/fuzz/obj", {".obj"}), "obj"), try_obj);
}

TEST(FuzzSeeds, PbrtFiles) {
  try_seeds(with_findings(files_in(MARTI_SOURCE "/tests/fuzz/pbrt", {".pbrt"}), "pbrt"), try_pbrt);
}

TEST(FuzzSeeds, ArraysOfRays) {
  try_seeds(with_findings(files_in(MARTI_SOURCE "/tests/fuzz/rays", {".npy"}), "rays"), try_rays);
}

TEST(FuzzSeeds, PlyFiles) {
  try_seeds(with_findings(files_in(MARTI_SOURCE "/tests/fuzz/ply", {".ply"}), "ply"), try_ply);
}

}  // namespace
}  // namespace marti::fuzz
