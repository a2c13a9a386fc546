// find_package(marti COMPONENTS marti) and target_link_libraries(frame_time marti::marti) build this.
#include <iostream>

#include "marti/marti.h"

int main(int count, char** words) {
  try {
    const marti::Result one = marti::run(count > 1 ? words[1] : "", {"image.width=64", "image.height=64"});
    std::cout << one.summary() << "on " << one.settings().at("machine.nodes") << " nodes "
              << std::get<std::int64_t>(one.figure("end")) << " ps\n";
    const marti::Sweep more =
        marti::sweep("", {"machine.nodes=1,4,16"}, {.settings = {"scene.source=tetra:3"}});
    std::cout << more.points().rows.size() << " machines\n" << more.summary();
  } catch (const marti::Error& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
