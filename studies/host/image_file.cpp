#include "studies/host/image_file.h"

#include <dlfcn.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

#include "scenes/texture.h"
#include "sim/error.h"
#include "studies/host/image_codec.h"
#include "studies/host/image_libraries.h"

namespace marti::studies::host {

namespace {

// Each name that a library needs is looked for in all libraries that are loaded with it. Loaded one by one,
// those that are needed before those that need them, they take half as long as all at once. What cannot be
// loaded alone is loaded with the library that needs it.
void load_one_by_one() {
  // Where the address space is limited, some find no room for what they do when they are loaded, and write
  // about it. All at once, they are refused before any does something.
  rlimit space{};
  if (getrlimit(RLIMIT_AS, &space) != 0 || space.rlim_cur != RLIM_INFINITY) {
    return;
  }
  for (const char* const name : image_libraries) {
    static_cast<void>(dlopen(name, RTLD_LAZY));
  }
}

// The codec's library, loaded by a thread of its own, which others need not wait for.
//
// Some of the libraries that it needs start threads while they are loaded and throw when they get none; to
// unwind their half-made pool of threads would wait for ever. The thread has no catch, so nothing is unwound,
// and the program ends with the message of studies/cli/last_words.cpp.
class CodecLibrary {
 public:
  CodecLibrary() = default;
  CodecLibrary(const CodecLibrary&) = delete;
  CodecLibrary& operator=(const CodecLibrary&) = delete;
  ~CodecLibrary() {
    if (loading_.joinable()) {
      loading_.join();
    }
  }

  /// Has it loaded, if that is not done yet; after a failure again.
  void begin() {
    const std::lock_guard lock(mutex_);
    begin_locked();
  }

  /// Waits until it is loaded.
  const ImageCodec& codec() {
    const std::lock_guard lock(mutex_);
    begin_locked();
    if (loading_.joinable()) {
      loading_.join();
    }
    if (codec_ == nullptr) {
      throw sim::UserError(
          "image files can be neither read nor written, because a library cannot be loaded: " + why_);
    }
    return *codec_;
  }

 private:
  void begin_locked() {
    if (codec_ == nullptr && !loading_.joinable()) {
      loading_ = std::thread([this] { load(); });
    }
  }

  void load() {
    load_one_by_one();
    // Found as the libraries are that the program is linked to: by the loader's settings, then its RUNPATH
    // (studies/CMakeLists.txt). It stays loaded, because OpenImageIO keeps threads.
    void* const library = dlopen("marti_image_codec.so", RTLD_LAZY);
    void* const function = library == nullptr ? nullptr : dlsym(library, "marti_image_codec");
    if (function == nullptr) {
      const char* const reason = dlerror();
      why_ = reason == nullptr ? "marti_image_codec.so" : reason;
    } else {
      codec_ = reinterpret_cast<decltype(&marti_image_codec)>(function)();
    }
  }

  std::mutex mutex_;
  std::thread loading_;  // what it writes is read only after it has been joined
  const ImageCodec* codec_ = nullptr;
  std::string why_;
};

CodecLibrary& codec_library() {
  static CodecLibrary library;
  return library;
}

const ImageCodec& codec() { return codec_library().codec(); }

// IEC 61966-2-1, to the nearest byte.
std::uint8_t srgb_byte(float linear) {
  const double value =
      std::isfinite(linear) ? std::clamp(static_cast<double>(linear), 0.0, 1.0) : (linear > 0.0F ? 1.0 : 0.0);
  const double encoded = value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1.0 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(encoded * 255.0));
}

}  // namespace

void begin_to_load_image_library() { codec_library().begin(); }

void load_image_library() { static_cast<void>(codec()); }

std::string note_of_infinities(const processors::program::Image& image) {
  const auto count = std::ranges::count_if(image.pixels, [](const glm::vec3& pixel) {
    return !std::isfinite(pixel.x) || !std::isfinite(pixel.y) || !std::isfinite(pixel.z);
  });
  return count == 0 ? ""
                    : std::to_string(count) + " of " + std::to_string(image.pixels.size()) +
                          " pixels are infinite or no number: light or a material of the scene is brighter "
                          "than 32-bit floats can hold; image.png has them white or black.";
}

std::string exr_file(const processors::program::Image& image) {
  const std::array<std::string, 3> names = {"R", "G", "B"};
  static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
  const std::span samples(reinterpret_cast<const float*>(image.pixels.data()),
                          image.pixels.size() * names.size());
  return codec().encode_exr({image.width, image.height}, names, samples);
}

processors::program::Image read_exr(const std::filesystem::path& file) {
  scenes::ImageSize size;
  const std::vector<float> samples = codec().read_exr(file.string(), size);
  processors::program::Image image{size.width, size.height, {}};
  image.pixels.resize(samples.size() / 3);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = {samples[3 * i], samples[3 * i + 1], samples[3 * i + 2]};
  }
  return image;
}

std::string exr_file(std::uint32_t width, std::uint32_t height, std::span<const std::string> names,
                     std::span<const std::vector<float>> channels) {
  std::vector<float> samples;
  samples.reserve(std::size_t{width} * height * channels.size());
  for (std::size_t pixel = 0; pixel < std::size_t{width} * height; ++pixel) {
    for (const std::vector<float>& channel : channels) {
      samples.push_back(channel[pixel]);
    }
  }
  return codec().encode_exr({width, height}, names, samples);
}

std::string png_file(const processors::program::Image& image) {
  std::vector<std::uint8_t> samples;
  samples.reserve(image.pixels.size() * 3);
  for (const glm::vec3& pixel : image.pixels) {
    for (int channel = 0; channel < 3; ++channel) {
      samples.push_back(srgb_byte(pixel[channel]));
    }
  }
  return codec().encode_png({image.width, image.height}, 3, samples);
}

scenes::Texture decode_image(std::span<const std::byte> file, std::string_view name) {
  const DecodedImage image = codec().decode(file, name);
  return scenes::texture_from_samples(name, image.size.width, image.size.height, image.channels,
                                      image.samples);
}

scenes::ImageSize size_of_image(std::span<const std::byte> file, std::string_view name) {
  return codec().size_of(file, name);
}

std::vector<std::byte> encode_png(const scenes::Texture& texture) {
  const std::span samples(reinterpret_cast<const std::uint8_t*>(texture.texels.data()),
                          4 * texture.texels.size());
  const std::string file = codec().encode_png({texture.width, texture.height}, 4, samples);
  const auto* const bytes = reinterpret_cast<const std::byte*>(file.data());
  return {bytes, bytes + file.size()};
}

}  // namespace marti::studies::host
