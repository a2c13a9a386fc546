#include "scenes/gltf_files.h"

#include <string>
#include <vector>

namespace marti::scenes::gltf {

namespace {

FileAccess& access_of(void* user) { return *static_cast<FileAccess*>(user); }

}  // namespace

tinygltf::FsCallbacks callbacks_of(FileAccess& access) {
  return {[](const std::string& name, void* user) { return access_of(user).may_read(name); },
          [](const std::string& name, void* /*user*/) { return name; },
          [](std::vector<unsigned char>* bytes, std::string* error, const std::string& name, void* user) {
            std::string text;
            const bool read = access_of(user).read(name, text, *error);
            bytes->assign(text.begin(), text.end());
            return read;
          },
          [](std::string* error, const std::string& /*name*/, const std::vector<unsigned char>& /*data*/,
             void* /*user*/) {
            *error += "reading only";
            return false;
          },
          &access};
}

}  // namespace marti::scenes::gltf
