// The library marti_image_codec.so: the only place that includes OpenImageIO.
#include "studies/host/image_codec.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <mutex>

#include "sim/error.h"

namespace marti::studies::host {

namespace {

constexpr int most_pixels_a_side = 65536;
constexpr std::int64_t most_pixels = std::int64_t{1} << 28U;  // 1 GiB of RGBA

// A name whose extension leads OpenImageIO to the codec: the images inside a glTF file often have no name,
// and are PNG, JPEG or WebP by the format's rules.
std::string codec_name(std::span<const std::byte> file) {
  const std::string_view head(reinterpret_cast<const char*>(file.data()),
                              std::min<std::size_t>(file.size(), 12));
  return head.starts_with("\xff\xd8")                         ? "texture.jpg"
         : head.starts_with("RIFF") && head.ends_with("WEBP") ? "texture.webp"
                                                              : "texture.png";
}

// While one lives, what libpng writes to standard error is dropped: OpenImageIO leaves it no other place for
// its errors, which the caller's message has too, and for its warnings about images that it can read. What
// others write to standard error meanwhile comes after it. One at a time.
class WithoutLinesOfLibpng {
 public:
  WithoutLinesOfLibpng() : lock_(mutex()) {
    static_cast<void>(std::fflush(stderr));
    before_ = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 0);
    written_ = memfd_create("standard error", MFD_CLOEXEC);
    if (before_ >= 0 && written_ >= 0) {
      static_cast<void>(dup2(written_, STDERR_FILENO));
    }
  }
  WithoutLinesOfLibpng(const WithoutLinesOfLibpng&) = delete;
  WithoutLinesOfLibpng& operator=(const WithoutLinesOfLibpng&) = delete;
  ~WithoutLinesOfLibpng() {
    if (before_ >= 0 && written_ >= 0) {
      static_cast<void>(std::fflush(stderr));
      static_cast<void>(dup2(before_, STDERR_FILENO));
      pass_on();
    }
    static_cast<void>(close(before_));
    static_cast<void>(close(written_));
  }

 private:
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }

  void pass_on() const {
    std::string text(static_cast<std::size_t>(std::max<off_t>(0, lseek(written_, 0, SEEK_END))), '\0');
    const ssize_t size = pread(written_, text.data(), text.size(), 0);
    text.resize(static_cast<std::size_t>(std::max<ssize_t>(0, size)));
    for (std::size_t begin = 0; begin < text.size();) {
      const std::size_t end = std::min(text.find('\n', begin), text.size() - 1) + 1;
      const std::string_view line(text.data() + begin, end - begin);
      if (!line.starts_with("libpng ")) {
        static_cast<void>(std::fwrite(line.data(), 1, line.size(), stderr));
      }
      begin = end;
    }
  }

  std::lock_guard<std::mutex> lock_;
  int before_ = -1;
  int written_ = -1;
};

OIIO::ImageSpec spec_of(scenes::ImageSize size, std::size_t channels, const OIIO::TypeDesc& type) {
  return OIIO::ImageSpec(static_cast<int>(size.width), static_cast<int>(size.height),
                         static_cast<int>(channels), type);
}

// The bytes of an image file; the extension of `name` says of which format.
std::string encode(const std::string& name, const OIIO::ImageSpec& spec, const OIIO::TypeDesc& type,
                   const void* pixels) {
  // OpenEXR compresses in this thread: a pool of its own would be more threads than the system may give.
  static const bool no_pool = OIIO::attribute("exr_threads", -1);
  static_cast<void>(no_pool);
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(name, &memory);
  if (!out || !out->open(name, spec) || !out->write_image(type, pixels) || !out->close()) {
    throw sim::UserError("an image cannot be encoded: " + (out ? out->geterror() : OIIO::geterror()));
  }
  return {bytes.begin(), bytes.end()};
}

// The size of an image that can be a texture, or the result of a run.
scenes::ImageSize checked_size(const OIIO::ImageSpec& spec, const std::string& label, const char* use) {
  if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.nchannels < 1 || spec.nchannels > 16 ||
      spec.width > most_pixels_a_side || spec.height > most_pixels_a_side ||
      std::int64_t{spec.width} * spec.height > most_pixels) {
    throw sim::UserError(label + ": an image of " + std::to_string(spec.width) + " x " +
                         std::to_string(spec.height) + " pixels and " + std::to_string(spec.nchannels) +
                         " channels cannot be " + use);
  }
  return {static_cast<std::uint32_t>(spec.width), static_cast<std::uint32_t>(spec.height)};
}

// An image file in memory, opened; its header has been read and is that of a possible texture.
struct OpenImage {
  OpenImage(std::span<const std::byte> file, std::string_view name)
      : memory(file.data(), file.size()), label(name) {
    in = OIIO::ImageInput::open(codec_name(file), nullptr, &memory);
    if (!in) {
      throw sim::UserError(label + ": not an image that can be read: " + OIIO::geterror());
    }
    size = checked_size(in->spec(), label, "a texture");
  }

  WithoutLinesOfLibpng quiet;  // until `in` is gone
  OIIO::Filesystem::IOMemReader memory;
  std::string label;
  std::unique_ptr<OIIO::ImageInput> in;
  scenes::ImageSize size;
};

class OpenImageIO final : public ImageCodec {
 public:
  [[nodiscard]] std::string encode_exr(scenes::ImageSize size, std::span<const std::string> channels,
                                       std::span<const float> samples) const override {
    OIIO::ImageSpec spec = spec_of(size, channels.size(), OIIO::TypeDesc::FLOAT);
    spec.channelnames.assign(channels.begin(), channels.end());
    spec.attribute("compression", "zip");
    // Without a date the library writes that of today, and equal images would be different files.
    spec.attribute("DateTime", "1970:01:01 00:00:00");
    return encode("image.exr", spec, OIIO::TypeDesc::FLOAT, samples.data());
  }

  [[nodiscard]] std::vector<float> read_exr(const std::string& file, scenes::ImageSize& size) const override {
    const std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::open(file);
    if (!in) {
      throw sim::UserError(file + ": not an image that can be read: " + OIIO::geterror());
    }
    size = checked_size(in->spec(), file, "that of a run");
    std::vector<float> samples(std::size_t{3} * size.width * size.height);
    if (in->spec().nchannels != 3 || !in->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, samples.data())) {
      throw sim::UserError(file + ": is not the image of a run: " + in->geterror());
    }
    return samples;
  }

  [[nodiscard]] std::string encode_png(scenes::ImageSize size, std::size_t channels,
                                       std::span<const std::uint8_t> samples) const override {
    OIIO::ImageSpec spec = spec_of(size, channels, OIIO::TypeDesc::UINT8);
    if (channels == 3) {  // of a texture, its file or material says what its bytes mean
      spec.attribute("oiio:ColorSpace", "sRGB");
    }
    return encode("image.png", spec, OIIO::TypeDesc::UINT8, samples.data());
  }

  [[nodiscard]] DecodedImage decode(std::span<const std::byte> file, std::string_view name) const override {
    const OpenImage image(file, name);
    const int channels = image.in->spec().nchannels;
    DecodedImage decoded{image.size, static_cast<std::uint32_t>(channels), {}};
    decoded.samples.resize(std::size_t{image.size.width} * image.size.height * decoded.channels);
    if (!image.in->read_image(0, 0, 0, channels, OIIO::TypeDesc::UINT8, decoded.samples.data())) {
      throw sim::UserError(image.label + ": cannot be decoded: " + image.in->geterror());
    }
    return decoded;
  }

  [[nodiscard]] scenes::ImageSize size_of(std::span<const std::byte> file,
                                          std::string_view name) const override {
    return OpenImage(file, name).size;
  }
};

}  // namespace

}  // namespace marti::studies::host

const marti::studies::host::ImageCodec* marti_image_codec() {
  static const marti::studies::host::OpenImageIO codec;
  return &codec;
}
