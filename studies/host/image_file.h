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

/// Writes 32-bit float linear RGB as OpenEXR, without a date that means anything: equal images are equal
/// files. Throws UserError when the file cannot be written.
void write_exr(const processors::program::Image& image, const std::filesystem::path& file);

/// Reads what write_exr() has written. Throws UserError for a file that is not such an image.
[[nodiscard]] processors::program::Image read_exr(const std::filesystem::path& file);

/// "3 of 256 pixels ...": how many have a channel that is infinite or NaN, which an EXR file holds unchanged
/// and a PNG file as its brightest or darkest value; empty when no pixel has one.
[[nodiscard]] std::string note_of_infinities(const processors::program::Image& image);

/// Writes an OpenEXR of 32-bit float channels, each with a name and width * height figures.
void write_channels(std::uint32_t width, std::uint32_t height, std::span<const std::string> names,
                    std::span<const std::vector<float>> channels, const std::filesystem::path& file);

/// Writes 8-bit sRGB-encoded PNG; values are clamped to 0..1. Throws UserError when the file cannot be
/// written.
void write_png(const processors::program::Image& image, const std::filesystem::path& file);

/// A scenes::ImageDecoder. Reads PNG and JPEG; refuses more than 65,536 pixels a side or 2^28 in all.
[[nodiscard]] scenes::Texture decode_image(std::span<const std::byte> file, std::string_view name);

/// A scenes::ImageSizer, with the same limits: reads the file's head and no pixel.
[[nodiscard]] scenes::ImageSize size_of_image(std::span<const std::byte> file, std::string_view name);

/// A scenes::ImageEncoder: PNG.
[[nodiscard]] std::vector<std::byte> encode_png(const scenes::Texture& texture);

}  // namespace marti::studies::host
