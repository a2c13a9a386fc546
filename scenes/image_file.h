// Internal to scenes/: encoded images of a scene's file as textures.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "scenes/scene_notes.h"
#include "scenes/source_file.h"
#include "scenes/texture.h"
#include "sim/error.h"

namespace marti::scenes {

struct ImageFile {
  std::string name;  ///< for messages
  std::span<const std::byte> bytes;
};

/// An image that is missing or empty or cannot be decoded.
class ImageError : public sim::UserError {
 public:
  using UserError::UserError;
};

/// The image decoded, which needs `decode`, or with its size and its bytes alone, as the file's options say;
/// takes its memory. Where only its size can be read, it becomes a white one, which `left_out` counts: so it
/// has the same place among the textures as where nobody decodes it. Throws ImageError, and UserError when
/// there is no decoder or not enough memory.
[[nodiscard]] Texture open_image(const SourceFile& file, const ImageFile& image, const ImageDecoder& decode,
                                 LeftOut& left_out);

/// Adds the image that open_image() gives to the scene's textures, which repeats unless `clamp`. Returns its
/// number, or no_texture, which is counted, where that throws ImageError.
[[nodiscard]] std::uint32_t add_image(const SourceFile& file, const ImageFile& image,
                                      const ImageDecoder& decode, bool clamp, Scene& scene,
                                      LeftOut& left_out);

/// The image decoded, to check it: takes no memory. Throws as open_image().
[[nodiscard]] Texture decode_image(const SourceFile& file, const ImageFile& image,
                                   const ImageDecoder& decode);

}  // namespace marti::scenes
