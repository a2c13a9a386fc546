// Makes and samples textures. Files are decoded by the caller: this library links no image codec but takes a
// callback.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "scenes/scene.h"

namespace marti::scenes {

/// Decodes an image file held in memory (PNG, JPEG, ...). `name` is for messages only. Throws UserError if
/// that fails; only the size and the texels of the result are used.
using ImageDecoder = std::function<Texture(std::span<const std::byte> file, std::string_view name)>;

/// The size of an image in texels.
struct ImageSize {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
};

/// Finds the size of an image file from its head alone. Throws UserError if that fails.
using ImageSizer = std::function<ImageSize(std::span<const std::byte> file, std::string_view name)>;

/// Decodes the texels of a texture that has a file and no texels, and frees the file. Throws UserError when
/// the decoder fails or when the image's size is not the texture's.
void decode_texels(Texture& texture, const ImageDecoder& decode);

/// Encodes a texture as a PNG file in memory, losslessly.
using ImageEncoder = std::function<std::vector<std::byte>(const Texture& texture)>;

/// A texture of 8-bit samples with any number of channels, interleaved, rows from the top: 1 is grey,
/// 2 grey and alpha, 3 colour, 4 colour and alpha; further channels are dropped, a missing alpha is 255.
/// Throws UserError when a size is 0 or above 65,536, or `samples` has the wrong length.
[[nodiscard]] Texture texture_from_samples(std::string_view name, std::uint32_t width, std::uint32_t height,
                                           std::uint32_t channels, std::span<const std::uint8_t> samples);

/// What a note counts when texels cannot be decoded though an image's size is known: such a texture is white.
inline constexpr std::string_view undecoded_textures =
    "textures that cannot be decoded, by white ones of their size";

struct TextureSample {
  glm::dvec3 color{0.0};    ///< linear, 0 to 1
  std::uint32_t texel = 0;  ///< the texel that was read: row * width + column
};

/// The texture coordinates at a point of a triangle, from its barycentric weights. Shading
/// and the test for holes both use it, so both read one texel. Real: the scalar of the arithmetic.
template <class Real>
[[nodiscard]] glm::dvec2 mixed_uv(const std::array<glm::dvec2, 3>& uv, const Real (&weight)[3]) {
  const auto mix = [&](int axis) {
    return static_cast<double>(weight[0] * Real(uv[0][axis]) + weight[1] * Real(uv[1][axis]) +
                               weight[2] * Real(uv[2][axis]));
  };
  return {mix(0), mix(1)};
}

/// The number of the texel nearest to `uv`, row * width + column; see sample_nearest().
[[nodiscard]] std::uint32_t nearest_texel(const Texture& texture, const glm::dvec2& uv);

/// The alpha of a texel, 0 to 1; without texels 1.
[[nodiscard]] double alpha_of(const Texture& texture, std::uint32_t texel);

/// The texel nearest to `uv`. (0, 0) is the upper left corner of the image, u goes to the right, v downwards;
/// outside 0..1 the texture repeats or its edge continues, as its wrap modes say. A uv that is not finite
/// counts as 0. The texture must have a size; without texels the sample is white. One sample reads one texel,
/// so the log has one reference for it.
[[nodiscard]] TextureSample sample_nearest(const Texture& texture, const glm::dvec2& uv);

/// The linear value of an sRGB-encoded byte (IEC 61966-2-1).
[[nodiscard]] double srgb_to_linear(std::uint8_t encoded);

}  // namespace marti::scenes
