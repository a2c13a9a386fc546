#include "scenes/camera_file.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <string>

#include "scenes/source_file.h"
#include "scenes/text_lines.h"
#include "scenes/vertex_values.h"
#include "sim/shown.h"

namespace marti::scenes {

Camera read_camera_file(const std::filesystem::path& path, const FileOptions& options) {
  const SourceFile file(path, options);
  const std::string text = file.read(1);
  TextLines lines(text, sim::shown(path.string()), TextLines::Style::plain);
  std::array<double, 6> numbers{};
  std::size_t count = 0;
  while (lines.next()) {
    for (std::size_t word = 0; word < lines.words().size(); ++word) {
      const double number = lines.number(word);
      if (!(std::abs(number) <= largest_coordinate)) {
        lines.fail("a coordinate must be a number from -1e30 to 1e30, not " + in_quotes(lines.words()[word]));
      }
      if (count == numbers.size()) {
        lines.fail("a camera is six numbers, the eye and a point that it looks at; here is a seventh");
      }
      numbers.at(count++) = number;
    }
  }
  if (count < numbers.size()) {
    lines.fail("a camera is six numbers, the eye and a point that it looks at; the file ends after " +
               std::to_string(count));
  }
  Camera camera;
  camera.eye = {numbers[0], numbers[1], numbers[2]};
  camera.at = {numbers[3], numbers[4], numbers[5]};
  try {
    static_cast<void>(camera.image_plane(1, 1));
  } catch (const sim::UserError& error) {
    lines.fail(error.what());
  }
  return camera;
}

}  // namespace marti::scenes
