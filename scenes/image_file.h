// Internal to scenes/: encoded images of a scene's file as textures.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "scenes/source_file.h"
#include "scenes/texture.h"

namespace marti::scenes {

struct ImageFile {
  std::string name;  ///< for messages
  std::span<const std::byte> bytes;
};

/// The image decoded, which needs `decode`, or with its size and its bytes alone, as the file's options say;
/// takes its memory. Throws UserError.
[[nodiscard]] Texture open_image(const SourceFile& file, const ImageFile& image, const ImageDecoder& decode);

/// The image decoded, to check it: takes no memory.
[[nodiscard]] Texture decode_image(const SourceFile& file, const ImageFile& image,
                                   const ImageDecoder& decode);

}  // namespace marti::scenes
