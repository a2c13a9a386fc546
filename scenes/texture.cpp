#include "scenes/texture.h"

#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "sim/error.h"
#include "sim/shown.h"

namespace marti::scenes {

namespace {

constexpr std::uint32_t max_side = 65'536;

std::array<double, 256> make_srgb_table() {
  std::array<double, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double c = static_cast<double>(i) / 255.0;
    table[i] = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  }
  return table;
}

std::uint32_t texel_coordinate(double coordinate, std::uint32_t size, bool repeat) {
  if (!std::isfinite(coordinate)) {
    return 0;
  }
  const double wrapped = repeat ? coordinate - std::floor(coordinate) : coordinate;
  const double scaled = std::floor(wrapped * static_cast<double>(size));
  if (!(scaled > 0.0)) {
    return 0;
  }
  const double last = static_cast<double>(size - 1);
  return static_cast<std::uint32_t>(scaled < last ? scaled : last);
}

}  // namespace

Texture texture_from_samples(std::string_view name, std::uint32_t width, std::uint32_t height,
                             std::uint32_t channels, std::span<const std::uint8_t> samples) {
  const std::string where = "texture '" + sim::shown(name) + "': ";
  if (width == 0 || height == 0 || width > max_side || height > max_side) {
    throw sim::UserError(where + "a size of " + std::to_string(width) + " x " + std::to_string(height) +
                         " texels; each side must be 1 to " + std::to_string(max_side));
  }
  const std::uint64_t texels = std::uint64_t{width} * height;
  if (channels == 0 || channels > 1024 || samples.size() != texels * channels) {
    throw sim::UserError(where + std::to_string(width) + " x " + std::to_string(height) + " texels of " +
                         std::to_string(channels) + " channels do not fit " + std::to_string(samples.size()) +
                         " bytes");
  }
  Texture texture;
  texture.name = name;
  texture.width = width;
  texture.height = height;
  texture.texels.reserve(texels);
  for (std::size_t at = 0; at < samples.size(); at += channels) {
    const bool grey = channels <= 2;
    const std::uint8_t alpha = channels == 2 ? samples[at + 1] : channels >= 4 ? samples[at + 3] : 255;
    texture.texels.push_back({samples[at], samples[grey ? at : at + 1], samples[grey ? at : at + 2], alpha});
  }
  return texture;
}

void decode_texels(Texture& texture, const ImageDecoder& decode) {
  sim::ensure(texture.texels.empty() && texture.file != nullptr,
              "a texture without a file cannot be decoded");
  Texture decoded = decode(*texture.file, texture.name);
  if (decoded.width != texture.width || decoded.height != texture.height) {
    throw sim::UserError("texture '" + sim::shown(texture.name) + "': its image says that it has " +
                         std::to_string(texture.width) + " x " + std::to_string(texture.height) +
                         " texels, but it has " + std::to_string(decoded.width) + " x " +
                         std::to_string(decoded.height));
  }
  sim::ensure(decoded.texels.size() == decoded.size(),
              "an image decoder returned a texture whose size does not match its texels");
  texture.texels = std::move(decoded.texels);
  texture.file.reset();
}

double srgb_to_linear(std::uint8_t encoded) {
  static const std::array<double, 256> table = make_srgb_table();
  return table[encoded];
}

std::uint32_t nearest_texel(const Texture& texture, const glm::dvec2& uv) {
  const std::uint32_t column = texel_coordinate(uv.x, texture.width, texture.repeat_u);
  const std::uint32_t row = texel_coordinate(uv.y, texture.height, texture.repeat_v);
  return row * texture.width + column;
}

double alpha_of(const Texture& texture, std::uint32_t texel) {
  if (texture.texels.empty()) {
    return 1.0;
  }
  const std::array<std::uint8_t, 4>& samples = texture.texels[texel];
  return texture.grey_is_alpha ? (samples[0] + samples[1] + samples[2]) / (3.0 * 255.0) : samples[3] / 255.0;
}

TextureSample sample_nearest(const Texture& texture, const glm::dvec2& uv) {
  TextureSample sample;
  sample.texel = nearest_texel(texture, uv);
  if (texture.texels.empty()) {
    sample.color = glm::dvec3(1.0);
    return sample;
  }
  const std::array<std::uint8_t, 4>& texel = texture.texels[sample.texel];
  for (int channel = 0; channel < 3; ++channel) {
    const std::uint8_t value = texel[static_cast<std::size_t>(channel)];
    sample.color[channel] = texture.srgb ? srgb_to_linear(value) : static_cast<double>(value) / 255.0;
  }
  return sample;
}

}  // namespace marti::scenes
