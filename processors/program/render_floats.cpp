// The tracer in floats, in a file of its own because it compiles every structure and recorder once more.
#include "processors/program/render_rows.h"

namespace marti::processors::program {

void render_in_floats(const scenes::Scene& scene, const accel::Structure& structure, const Emitters& emitters,
                      const RenderOptions& options, unsigned threads, std::vector<LogRow>& rows,
                      Frame& frame) {
  accel::visit_structure(structure, [&](const auto& concrete) {
    render_with<float>(scene, concrete, emitters, options, threads, rows, frame);
  });
}

}  // namespace marti::processors::program
