// What the program asks of OpenImageIO. The functions are in a shared library of their own,
// marti_image_codec.so, which image_file.cpp loads when the first image is read or written: OpenImageIO
// brings more than two hundred libraries, and most commands touch no image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/texture.h"

namespace marti::studies::host {

/// The pixels of an image file: 8-bit samples, interleaved, rows from the top.
struct DecodedImage {
  scenes::ImageSize size;
  std::uint32_t channels = 0;
  std::vector<std::uint8_t> samples;
};

/// Every function throws UserError with a complete message when the image cannot be read or encoded. None
/// writes a file: who does says why that failed, and under which name.
class ImageCodec {
 public:
  ImageCodec() = default;
  virtual ~ImageCodec() = default;
  ImageCodec(const ImageCodec&) = delete;
  ImageCodec& operator=(const ImageCodec&) = delete;

  /// The bytes of an OpenEXR file of 32-bit floats, one for each channel of each pixel.
  [[nodiscard]] virtual std::string encode_exr(scenes::ImageSize size, std::span<const std::string> channels,
                                               std::span<const float> samples) const = 0;

  /// The red, green and blue floats of each pixel of a file that encode_exr() has made.
  [[nodiscard]] virtual std::vector<float> read_exr(const std::string& file,
                                                    scenes::ImageSize& size) const = 0;

  /// The bytes of a PNG file of 8-bit samples, so many a pixel: 3 are red, green and blue, 4 also alpha.
  [[nodiscard]] virtual std::string encode_png(scenes::ImageSize size, std::size_t channels,
                                               std::span<const std::uint8_t> samples) const = 0;

  /// A PNG, JPEG or WebP file in memory; `name` is for messages.
  [[nodiscard]] virtual DecodedImage decode(std::span<const std::byte> file, std::string_view name) const = 0;

  /// The size of such a file in memory, from its head alone.
  [[nodiscard]] virtual scenes::ImageSize size_of(std::span<const std::byte> file,
                                                  std::string_view name) const = 0;
};

}  // namespace marti::studies::host

/// The one function that marti_image_codec.so exports.
extern "C" const marti::studies::host::ImageCodec* marti_image_codec();
