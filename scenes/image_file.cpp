#include "scenes/image_file.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/error.h"
#include "sim/shown.h"

namespace marti::scenes {

namespace {

constexpr std::uint64_t bytes_a_texel = sizeof(decltype(Texture::texels)::value_type);
constexpr const char* textures_take = "its textures take";

[[noreturn]] void fail_image(const SourceFile& file, const ImageFile& image, const std::string& what) {
  throw ImageError(sim::shown(file.path().string()) + ": image '" + sim::shown(image.name) + "'" + what);
}

void require_image(const SourceFile& file, const ImageFile& image, const ImageDecoder& decode) {
  if (image.bytes.empty()) {
    fail_image(file, image, " is missing, empty or cannot be read");
  }
  if (!decode) {
    file.fail("it needs the texture '" + sim::shown(image.name) + "', and no image decoder is at hand");
  }
}

/// Throws ImageError when `decode`, a decoder or a sizer, fails.
template <class Decode>
auto read_image(const SourceFile& file, const ImageFile& image, const Decode& decode) {
  try {
    return decode(image.bytes, image.name);
  } catch (const sim::UserError& error) {
    fail_image(file, image, std::string(": ") + error.what());
  }
}

/// By the sizer of the options, if there is one.
std::optional<ImageSize> size_of(const SourceFile& file, const ImageFile& image) {
  const ImageSizer& sizer = file.options().size_first ? file.options().size_first : file.options().size_only;
  return sizer ? std::optional(read_image(file, image, sizer)) : std::nullopt;
}

/// For both the samples from the decoder and the texels made of them.
void require_memory(const SourceFile& file, const std::optional<ImageSize>& size) {
  if (size) {
    file.require_memory(2 * bytes_a_texel * size->width * size->height, textures_take);
  }
}

Texture decoded(const SourceFile& file, const ImageFile& image, const ImageDecoder& decode) {
  Texture texture = read_image(file, image, decode);
  sim::ensure(texture.width > 0 && texture.height > 0 && texture.texels.size() == texture.size(),
              "an image decoder returned a texture whose size does not match its texels");
  texture.name = image.name;
  return texture;
}

Texture size_image(const SourceFile& file, const ImageFile& image) {
  const ImageSize size = read_image(file, image, file.options().size_only);
  sim::ensure(size.width > 0 && size.height > 0, "an image sizer returned an image of no size");
  Texture texture;
  texture.name = image.name;
  texture.width = size.width;
  texture.height = size.height;
  file.take_memory(image.bytes.size(), textures_take);
  texture.file = std::make_shared<const std::vector<std::byte>>(image.bytes.begin(), image.bytes.end());
  return texture;
}

}  // namespace

Texture decode_image(const SourceFile& file, const ImageFile& image, const ImageDecoder& decode) {
  require_image(file, image, decode);
  require_memory(file, size_of(file, image));
  return decoded(file, image, decode);
}

Texture open_image(const SourceFile& file, const ImageFile& image, const ImageDecoder& decode,
                   LeftOut& left_out) {
  require_image(file, image, decode);
  if (file.options().size_only) {
    return size_image(file, image);
  }
  const std::optional<ImageSize> size = size_of(file, image);
  require_memory(file, size);
  Texture texture;
  try {
    texture = decoded(file, image, decode);
  } catch (const ImageError& error) {
    if (!size) {
      throw;
    }
    left_out.replace(std::string(undecoded_textures), error.what());
    texture.width = size->width;
    texture.height = size->height;
    texture.texels.assign(texture.size(), {255, 255, 255, 255});
    texture.name = image.name;
  }
  file.take_memory(texture.size() * bytes_a_texel, textures_take);
  return texture;
}

std::uint32_t add_image(const SourceFile& file, const ImageFile& image, const ImageDecoder& decode,
                        bool clamp, Scene& scene, LeftOut& left_out) {
  try {
    Texture texture = open_image(file, image, decode, left_out);
    texture.repeat_u = !clamp;
    texture.repeat_v = !clamp;
    scene.textures.push_back(std::move(texture));
    return static_cast<std::uint32_t>(scene.textures.size() - 1);
  } catch (const ImageError& error) {
    left_out.replace("textures that cannot be decoded, by none", error.what());
    return no_texture;
  }
}

}  // namespace marti::scenes
