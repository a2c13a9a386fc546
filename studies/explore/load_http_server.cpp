#include <dlfcn.h>

#include <string>

#include "sim/error.h"
#include "studies/explore/http_server.h"

namespace marti::studies::explore {

std::unique_ptr<HttpServer> make_http_server() {
  // Found as marti_image_codec.so is (studies/host/image_file.cpp). It stays loaded.
  void* const library = dlopen("marti_http_server.so", RTLD_LAZY);
  void* const function = library == nullptr ? nullptr : dlsym(library, "marti_http_server");
  if (function == nullptr) {
    const char* const reason = dlerror();
    throw sim::UserError("explore: a library cannot be loaded: " +
                         std::string(reason == nullptr ? "marti_http_server.so" : reason));
  }
  return std::unique_ptr<HttpServer>(reinterpret_cast<decltype(&marti_http_server)>(function)());
}

}  // namespace marti::studies::explore
