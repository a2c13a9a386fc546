#include "scenes/gltf_meshopt.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "scenes/gltf_extensions.h"
#include "scenes/gltf_material.h"
#include "sim/shown.h"

#ifdef MARTI_MESHOPT
#include <meshoptimizer.h>
#endif

namespace marti::scenes::gltf {

#ifdef MARTI_MESHOPT

namespace {

/// The largest stride of a compressed view, by the extension.
constexpr std::uint64_t largest_stride = 256;

/// What the extension says of one view.
struct Compressed {
  std::uint64_t buffer = 0;
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
  std::uint64_t stride = 0;
  std::uint64_t count = 0;
  std::string mode;
  std::string filter;
};

class ViewDecompressor {
 public:
  ViewDecompressor(const SourceFile& source, tinygltf::Model& file, std::size_t view)
      : source_(source),
        file_(file),
        view_(file.bufferViews[view]),
        name_("buffer view " + std::to_string(view)) {}

  void run(const tinygltf::Value& extension) {
    const Compressed from = read(extension);
    check(from);
    const std::uint64_t size = from.count * from.stride;
    source_.take_memory(size, "its decompressed data take");
    tinygltf::Buffer to;
    to.data.resize(size);
    decode(from, to.data);
    view_.buffer = static_cast<int>(file_.buffers.size());
    view_.byteOffset = 0;
    view_.byteLength = size;
    file_.buffers.push_back(std::move(to));
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    source_.fail(name_ + ": its compressed data " + what);
  }

  [[nodiscard]] std::uint64_t whole_number(const tinygltf::Value& extension, const char* key,
                                           std::optional<double> otherwise) const {
    const std::optional<double> given = number_in(extension, key);
    const double value = given ? *given : otherwise.value_or(-1.0);
    if (extension.Has(key) && !given) {
      fail("have a " + std::string(key) + " that is no number");
    }
    if (!(value >= 0.0)) {  // json_fault() has seen to it that it is whole and fits
      fail("need a whole number as " + std::string(key));
    }
    return static_cast<std::uint64_t>(value);
  }

  [[nodiscard]] std::string text(const tinygltf::Value& extension, const char* key,
                                 const char* otherwise) const {
    if (!extension.Has(key)) {
      return otherwise;
    }
    if (!extension.Get(key).IsString()) {
      fail("have a " + std::string(key) + " that is no text");
    }
    return extension.Get(key).Get<std::string>();
  }

  [[nodiscard]] Compressed read(const tinygltf::Value& extension) const {
    Compressed from;
    from.buffer = whole_number(extension, "buffer", {});
    from.offset = whole_number(extension, "byteOffset", 0.0);
    from.length = whole_number(extension, "byteLength", {});
    from.stride = whole_number(extension, "byteStride", {});
    from.count = whole_number(extension, "count", {});
    from.mode = text(extension, "mode", "");
    from.filter = text(extension, "filter", "NONE");
    return from;
  }

  void check(const Compressed& from) const {
    if (from.buffer >= file_.buffers.size()) {
      fail("are in buffer " + std::to_string(from.buffer) + ", but the file has " +
           std::to_string(file_.buffers.size()));
    }
    const std::uint64_t size = file_.buffers[from.buffer].data.size();
    if (from.offset > size || from.length > size - from.offset) {
      fail("take " + std::to_string(from.length) + " bytes from byte " + std::to_string(from.offset) +
           ", but their buffer is too short: " + std::to_string(size) + " bytes");
    }
    const bool vertices = from.mode == "ATTRIBUTES";
    if (!vertices && from.mode != "TRIANGLES" && from.mode != "INDICES") {
      fail("are of the mode '" + sim::shown(from.mode) + "'; known are ATTRIBUTES, TRIANGLES and INDICES");
    }
    const bool stride_fits = vertices
                                 ? from.stride % 4 == 0 && from.stride > 0 && from.stride <= largest_stride
                                 : from.stride == 2 || from.stride == 4;
    if (!stride_fits || (from.mode == "TRIANGLES" && from.count % 3 != 0)) {
      fail("are " + std::to_string(from.count) + " elements of " + std::to_string(from.stride) +
           " bytes, which the mode " + from.mode + " does not allow");
    }
    if (from.count == 0 || from.count > 3 * source_.options().max_triangles) {
      fail("are " + std::to_string(from.count) + " elements; 1 to " +
           std::to_string(3 * source_.options().max_triangles) + " are accepted");
    }
    if (from.count * from.stride != view_.byteLength) {
      fail("are " + std::to_string(from.count * from.stride) + " bytes when decompressed, but the view has " +
           std::to_string(view_.byteLength));
    }
    const bool filter_fits =
        from.filter == "NONE" ||
        (vertices && ((from.filter == "OCTAHEDRAL" && (from.stride == 4 || from.stride == 8)) ||
                      (from.filter == "QUATERNION" && from.stride == 8) || from.filter == "EXPONENTIAL"));
    if (!filter_fits) {
      fail("have the filter '" + sim::shown(from.filter) + "', which is not known for elements of " +
           std::to_string(from.stride) + " bytes in the mode " + from.mode);
    }
  }

  void decode(const Compressed& from, std::vector<unsigned char>& to) const {
    const unsigned char* const bytes = file_.buffers[from.buffer].data.data() + from.offset;
    const int error =
        from.mode == "ATTRIBUTES"
            ? meshopt_decodeVertexBuffer(to.data(), from.count, from.stride, bytes, from.length)
        : from.mode == "TRIANGLES"
            ? meshopt_decodeIndexBuffer(to.data(), from.count, from.stride, bytes, from.length)
            : meshopt_decodeIndexSequence(to.data(), from.count, from.stride, bytes, from.length);
    if (error != 0) {
      fail("are damaged, or of a newer version than the library meshoptimizer reads");
    }
    if (from.filter == "OCTAHEDRAL") {
      meshopt_decodeFilterOct(to.data(), from.count, from.stride);
    } else if (from.filter == "QUATERNION") {
      meshopt_decodeFilterQuat(to.data(), from.count, from.stride);
    } else if (from.filter == "EXPONENTIAL") {
      meshopt_decodeFilterExp(to.data(), from.count, from.stride);
    }
  }

  const SourceFile& source_;
  tinygltf::Model& file_;
  tinygltf::BufferView& view_;
  std::string name_;
};

}  // namespace

bool has_meshopt() { return true; }

void decompress_views(const SourceFile& source, tinygltf::Model& file) {
  for (std::size_t i = 0; i < file.bufferViews.size(); ++i) {
    const int buffer = file.bufferViews[i].buffer;
    if (buffer < 0 || static_cast<std::size_t>(buffer) >= file.buffers.size() ||
        compression_of_view(file, static_cast<int>(i)).empty()) {
      continue;
    }
    const std::string name = meshopt_among(file.bufferViews[i].extensions);
    if (name.empty()) {
      continue;  // refused when something uses it
    }
    const tinygltf::Value extension = file.bufferViews[i].extensions.at(name);
    ViewDecompressor(source, file, i).run(extension);
  }
}

#else

bool has_meshopt() { return false; }

void decompress_views(const SourceFile& /*source*/, tinygltf::Model& /*file*/) {}

#endif

}  // namespace marti::scenes::gltf
