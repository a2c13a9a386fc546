// Image files. OpenImageIO, which reads and writes them, is loaded when it is first needed: image_codec.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "processors/program/image.h"
#include "scenes/scene.h"
#include "scenes/texture.h"

namespace marti::studies::host {

/// Begins to load OpenImageIO, which takes a tenth of a second or two, while the caller goes on.
void begin_to_load_image_library();

/// Returns when OpenImageIO is loaded, so that long work that will write images does not begin if it cannot
/// be loaded. Throws UserError.
void load_image_library();

/// The bytes of an OpenEXR file of 32-bit float linear RGB, without a date that means anything: equal images
/// are equal files.
[[nodiscard]] std::string exr_file(const processors::program::Image& image);

/// Reads a file that exr_file() has made. Throws UserError for a file that is not such an image.
[[nodiscard]] processors::program::Image read_exr(const std::filesystem::path& file);

/// "3 of 256 pixels ...": how many have a channel that is infinite or NaN, which an EXR file holds unchanged
/// and a PNG file as its brightest or darkest value; empty when no pixel has one.
[[nodiscard]] std::string note_of_infinities(const processors::program::Image& image);

/// Such a file of other channels, each with a name and width * height figures.
[[nodiscard]] std::string exr_file(std::uint32_t width, std::uint32_t height,
                                   std::span<const std::string> names,
                                   std::span<const std::vector<float>> channels);

/// The bytes of a PNG file of 8 bits a channel, sRGB-encoded; values are clamped to 0..1.
[[nodiscard]] std::string png_file(const processors::program::Image& image);

/// A scenes::ImageDecoder. Reads PNG and JPEG; refuses more than 65,536 pixels a side or 2^28 in all.
[[nodiscard]] scenes::Texture decode_image(std::span<const std::byte> file, std::string_view name);

/// A scenes::ImageSizer, with the same limits: reads the file's head and no pixel.
[[nodiscard]] scenes::ImageSize size_of_image(std::span<const std::byte> file, std::string_view name);

/// A scenes::ImageEncoder: PNG.
[[nodiscard]] std::vector<std::byte> encode_png(const scenes::Texture& texture);

}  // namespace marti::studies::host
