#include "studies/host/image_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>

#include "scenes/texture.h"
#include "sim/error.h"

namespace marti::studies {

namespace {

constexpr int most_pixels_a_side = 65536;
constexpr std::int64_t most_pixels = std::int64_t{1} << 28U;  // 1 GiB of RGBA

// A name whose extension leads OpenImageIO to the codec: the images inside a glTF file often have no name,
// and are PNG or JPEG by the format's rules.
std::string codec_name(std::span<const std::byte> file) {
  const bool jpeg = file.size() > 2 && file[0] == std::byte{0xff} && file[1] == std::byte{0xd8};
  return jpeg ? "texture.jpg" : "texture.png";
}

void write(const std::filesystem::path& file, const OIIO::ImageSpec& spec, const OIIO::TypeDesc& type,
           const void* pixels) {
  // OpenEXR compresses in this thread: a pool of its own would be more threads than the system may give.
  static const bool no_pool = OIIO::attribute("exr_threads", -1);
  static_cast<void>(no_pool);
  const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(file.string());
  if (!out) {
    throw sim::UserError(file.string() + ": " + OIIO::geterror());
  }
  if (!out->open(file.string(), spec) || !out->write_image(type, pixels) || !out->close()) {
    throw sim::UserError(file.string() + ": cannot be written: " + out->geterror());
  }
}

// IEC 61966-2-1, to the nearest byte.
std::uint8_t srgb_byte(float linear) {
  const double value =
      std::isfinite(linear) ? std::clamp(static_cast<double>(linear), 0.0, 1.0) : (linear > 0.0F ? 1.0 : 0.0);
  const double encoded = value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1.0 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(encoded * 255.0));
}

}  // namespace

std::string note_of_infinities(const processors::Image& image) {
  const auto count = std::count_if(image.pixels.begin(), image.pixels.end(), [](const glm::vec3& pixel) {
    return !std::isfinite(pixel.x) || !std::isfinite(pixel.y) || !std::isfinite(pixel.z);
  });
  return count == 0 ? ""
                    : std::to_string(count) + " of " + std::to_string(image.pixels.size()) +
                          " pixels are infinite or no number: light or a material of the scene is brighter "
                          "than 32-bit floats can hold; image.png has them white or black.";
}

void write_exr(const processors::Image& image, const std::filesystem::path& file) {
  OIIO::ImageSpec spec(static_cast<int>(image.width), static_cast<int>(image.height), 3,
                       OIIO::TypeDesc::FLOAT);
  spec.attribute("compression", "zip");
  // Without a date the library writes that of today, and equal images would be different files.
  spec.attribute("DateTime", "1970:01:01 00:00:00");
  write(file, spec, OIIO::TypeDesc::FLOAT, image.pixels.data());
}

void write_channels(std::uint32_t width, std::uint32_t height, std::span<const std::string> names,
                    std::span<const std::vector<float>> channels, const std::filesystem::path& file) {
  OIIO::ImageSpec spec(static_cast<int>(width), static_cast<int>(height), static_cast<int>(channels.size()),
                       OIIO::TypeDesc::FLOAT);
  spec.channelnames.assign(names.begin(), names.end());
  spec.attribute("compression", "zip");
  spec.attribute("DateTime", "1970:01:01 00:00:00");
  std::vector<float> pixels;
  pixels.reserve(std::size_t{width} * height * channels.size());
  for (std::size_t pixel = 0; pixel < std::size_t{width} * height; ++pixel) {
    for (const std::vector<float>& channel : channels) {
      pixels.push_back(channel[pixel]);
    }
  }
  write(file, spec, OIIO::TypeDesc::FLOAT, pixels.data());
}

void write_png(const processors::Image& image, const std::filesystem::path& file) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(image.pixels.size() * 3);
  for (const glm::vec3& pixel : image.pixels) {
    for (int channel = 0; channel < 3; ++channel) {
      bytes.push_back(srgb_byte(pixel[channel]));
    }
  }
  OIIO::ImageSpec spec(static_cast<int>(image.width), static_cast<int>(image.height), 3,
                       OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  write(file, spec, OIIO::TypeDesc::UINT8, bytes.data());
}

namespace {

// An image file in memory, opened; its header has been read and is that of a possible texture.
struct OpenImage {
  OpenImage(std::span<const std::byte> file, std::string_view name)
      : memory(file.data(), file.size()), label(name) {
    in = OIIO::ImageInput::open(codec_name(file), nullptr, &memory);
    if (!in) {
      throw sim::UserError(label + ": not an image that can be read: " + OIIO::geterror());
    }
    const OIIO::ImageSpec& spec = in->spec();
    if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.nchannels < 1 || spec.nchannels > 16 ||
        spec.width > most_pixels_a_side || spec.height > most_pixels_a_side ||
        std::int64_t{spec.width} * spec.height > most_pixels) {
      throw sim::UserError(label + ": an image of " + std::to_string(spec.width) + " x " +
                           std::to_string(spec.height) + " pixels and " + std::to_string(spec.nchannels) +
                           " channels cannot be a texture");
    }
    size = {static_cast<std::uint32_t>(spec.width), static_cast<std::uint32_t>(spec.height)};
  }

  OIIO::Filesystem::IOMemReader memory;
  std::string label;
  std::unique_ptr<OIIO::ImageInput> in;
  scenes::ImageSize size;
};

}  // namespace

scenes::Texture decode_image(std::span<const std::byte> file, std::string_view name) {
  const OpenImage image(file, name);
  const int channels = image.in->spec().nchannels;
  std::vector<std::uint8_t> samples(std::size_t{image.size.width} * image.size.height *
                                    static_cast<std::size_t>(channels));
  if (!image.in->read_image(0, 0, 0, channels, OIIO::TypeDesc::UINT8, samples.data())) {
    throw sim::UserError(image.label + ": cannot be decoded: " + image.in->geterror());
  }
  return scenes::texture_from_samples(name, image.size.width, image.size.height,
                                      static_cast<std::uint32_t>(channels), samples);
}

scenes::ImageSize size_of_image(std::span<const std::byte> file, std::string_view name) {
  return OpenImage(file, name).size;
}

std::vector<std::byte> encode_png(const scenes::Texture& texture) {
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create("texture.png", &memory);
  const OIIO::ImageSpec spec(static_cast<int>(texture.width), static_cast<int>(texture.height), 4,
                             OIIO::TypeDesc::UINT8);
  if (!out || !out->open("texture.png", spec) ||
      !out->write_image(OIIO::TypeDesc::UINT8, texture.texels.data()) || !out->close()) {
    throw sim::UserError("the texture " + texture.name + " cannot be encoded as PNG");
  }
  std::vector<std::byte> result(bytes.size());
  std::transform(bytes.begin(), bytes.end(), result.begin(), [](unsigned char b) { return std::byte{b}; });
  return result;
}

}  // namespace marti::studies
