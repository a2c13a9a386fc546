#include "scenes/gltf_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <new>
#include <sstream>
#include <utility>

#include "scenes/gltf_draco.h"
#include "scenes/gltf_extensions.h"
#include "scenes/gltf_files.h"
#include "scenes/gltf_json.h"
#include "scenes/gltf_meshopt.h"
#include "scenes/gltf_placeholders.h"
#include "sim/error.h"
#include "sim/shown.h"

namespace marti::scenes::gltf {

namespace {

constexpr std::uint64_t max_json_bytes = std::uint64_t{1} << 30;
constexpr int max_json_depth = 128;  // tinygltf reads `extras` and `extensions` recursively

/// Keeps an image file's bytes undecoded. Bytes of buffer views are not touched: tinygltf has not checked
/// that they lie inside their buffer.
bool keep_image(tinygltf::Image* image, const int /*index*/, std::string* /*error*/, std::string* /*warning*/,
                int /*width*/, int /*height*/, const unsigned char* bytes, int size, void* /*user*/) {
  if (image->bufferView < 0 && size > 0) {
    image->image.assign(bytes, bytes + size);
  }
  image->as_is = true;
  return true;
}

/// The shape of a JSON text, found before it is parsed.
struct JsonShape {
  int depth = 0;
  std::uint64_t objects = 0;
  std::uint64_t values = 0;  ///< approximate number of members and elements

  /// Bytes of its parsed form, without the text: the strings, and tinygltf's own data for each object.
  [[nodiscard]] std::uint64_t bytes(std::uint64_t text) const {
    return 2 * text + 600 * objects + 48 * values;
  }
};

JsonShape shape_of(std::string_view json) {
  JsonShape shape;
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_string) {
      if (c == '\\') {
        ++i;
      } else if (c == '"') {
        in_string = false;
      }
    } else if (c == '"') {
      in_string = true;
    } else if (c == '{' || c == '[') {
      shape.depth = std::max(shape.depth, ++depth);
      shape.objects += c == '{' ? 1U : 0U;
      ++shape.values;
    } else if (c == '}' || c == ']') {
      --depth;
    } else if (c == ',') {
      ++shape.values;
    }
  }
  return shape;
}

/// The JSON text of either kind of file; for a broken .glb as much of it as there is.
std::string_view json_of(std::string_view file, bool binary) {
  if (!binary) {
    return file;
  }
  std::uint32_t length = 0;
  if (file.size() < 20) {
    return {};
  }
  std::memcpy(&length, file.data() + 12, sizeof length);
  return file.substr(20, length);
}

/// Joins lines: tinygltf ends its messages with line breaks; ours are one line.
std::string one_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) {
    text.pop_back();
  }
  std::replace(text.begin(), text.end(), '\n', ' ');
  return sim::shown(text);
}

/// tinygltf's complaints without those about things that glTF 2.0 allows: skins without inverse bind matrices
/// (section 3.7.3.1), and channels without a target node, which must be ignored (3.11) and are.
std::string true_faults(const std::string& error) {
  static constexpr std::array<std::string_view, 3> allowed = {
      "'inverseBindMatrices' property is missing in Skin.", "'node' property is missing.",
      "`node` field is missing in animation.channels.target"};
  std::istringstream lines(error);
  std::string faults;
  for (std::string line; std::getline(lines, line);) {
    if (std::find(allowed.begin(), allowed.end(), line) == allowed.end()) {
      faults += line + "\n";
    }
  }
  return faults;
}

bool is_component_type(int type) {
  return type == TINYGLTF_COMPONENT_TYPE_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
         type == TINYGLTF_COMPONENT_TYPE_SHORT || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
         type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT || type == TINYGLTF_COMPONENT_TYPE_FLOAT;
}

std::size_t component_size(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    default:
      return 4;
  }
}

/// Unaligned little-endian read; both the file and the machines we build for are little-endian.
template <typename T>
T load(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

std::uint32_t load_unsigned(const std::byte* from, int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return load<std::uint8_t>(from);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load<std::uint16_t>(from);
    default:
      return load<std::uint32_t>(from);
  }
}

/// Reads one component; normalised integers are mapped as in glTF 2.0, section 3.11.
double load_value(const std::byte* from, int type, bool normalized) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: {
      const double c = load<std::int8_t>(from);
      return normalized ? std::max(c / 127.0, -1.0) : c;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: {
      const double c = load<std::uint8_t>(from);
      return normalized ? c / 255.0 : c;
    }
    case TINYGLTF_COMPONENT_TYPE_SHORT: {
      const double c = load<std::int16_t>(from);
      return normalized ? std::max(c / 32767.0, -1.0) : c;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
      const double c = load<std::uint16_t>(from);
      return normalized ? c / 65535.0 : c;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return load<std::uint32_t>(from);
    default:
      return static_cast<double>(load<float>(from));
  }
}

}  // namespace

Model::Model(std::filesystem::path path, const FileOptions& options) : SourceFile(std::move(path), options) {
  try {
    parse();
  } catch (const sim::UserError&) {
    throw;
  } catch (const std::bad_alloc&) {
    fail("there is not enough memory to read it");
  } catch (const std::exception& error) {
    fail("it cannot be parsed: " + one_line(error.what()));
  }
}

void Model::parse() {
  replaced_.strict = options().strict;
  std::string file = read(2);  // tinygltf copies the part that is not JSON
  const bool binary = file.starts_with("glTF");
  if (std::string padded = binary ? with_padding(file) : std::string(); !padded.empty()) {
    replaced_.replace("binary glTF files whose chunks do not end on multiples of 4 bytes, by padded ones",
                      sim::shown(path().string()) +
                          ": it is no valid glTF 2.0: a chunk does not end on a multiple of 4 bytes");
    file = std::move(padded);
  }
  const std::string_view json = json_of(file, binary);
  if (json.size() > max_json_bytes || file.size() > 0xffffffffU) {
    fail("it is too large: at most 1 GiB of JSON and 4 GiB in all can be read");
  }
  const JsonShape shape = shape_of(json);
  if (shape.depth > max_json_depth) {
    fail("its JSON is nested deeper than " + std::to_string(max_json_depth) + " levels");
  }
  take_memory(shape.bytes(json.size()), "its JSON takes");
  if (const std::string fault = json_fault(json); !fault.empty()) {
    fail("it is no valid glTF 2.0: " + fault);
  }
  const sim::MemoryBudget before = memory();
  FileAccess access(path().parent_path(), options().max_file_bytes, memory(), "URI");
  std::string error;
  bool parsed = parse_with(file, access, error);
  if (!parsed && (error.find("] invalid bufferView") != std::string::npos ||
                  json.find("meshopt_compression") != std::string_view::npos)) {
    if (Placeholders given = with_placeholders(json); !given.json.empty()) {
      memory() = before;
      data_ = {};
      error.clear();
      parsed = parse_with(binary ? with_json(file, std::move(given.json)) : given.json, access, error);
      remove_placeholders(given, data_);
    }
  }
  if (!access.refusal().empty()) {
    fail(access.refusal());
  }
  // tinygltf reads the names of the extensions before it fails on data that need one of them.
  for (const std::string& extension : missing_requirements(data_)) {
    const std::string reason =
        "it requires the extension " + double_quoted(extension) + ", " + why_unsupported(extension);
    if (!is_appearance(extension)) {
      fail(reason);
    }
    replaced_.replace("required extensions " + extension + ", by what the file has without it",
                      sim::shown(path().string()) + ": " + reason);
  }
  // Some faults are only reported by a message: for example, a primitive that cannot be parsed is dropped.
  const std::string faults = true_faults(error);
  if (!parsed || !faults.empty()) {
    const std::string ignored = one_line(ignored_extensions(data_));
    fail("it is no valid glTF 2.0: " + (error.empty() ? "unknown fault" : one_line(parsed ? faults : error)) +
         (ignored.empty() ? "" : " (it uses extensions that are not supported: " + ignored + ")"));
  }
  read_ = std::vector<std::atomic<bool>>(data_.accessors.size());
  decompress_views(*this, data_);
  decompress_primitives(*this, data_);
}

void Model::fail_reference(const char* kind, int index, std::size_t size, const std::string& user) const {
  fail(user + " refers to " + kind + " " + std::to_string(index) + ", but the file has " +
       std::to_string(size));
}

std::span<const std::byte> Model::view_bytes(int view, const std::string& user) const {
  const tinygltf::BufferView& v = at(data_.bufferViews, view, "buffer view", user);
  const std::string name = "buffer view " + std::to_string(view);
  const tinygltf::Buffer& buffer = at(data_.buffers, v.buffer, "buffer", name);
  if (const std::string extension = compression_of_view(data_, view); !extension.empty()) {
    fail(name + " is compressed by the extension " + extension + ", " + why_unsupported(extension));
  }
  const std::uint64_t size = buffer.data.size();
  if (v.byteOffset > size || v.byteLength > size - v.byteOffset) {
    fail(name + " takes " + std::to_string(v.byteLength) + " bytes from byte " +
         std::to_string(v.byteOffset) + ", but its buffer is too short: " + std::to_string(size) + " bytes");
  }
  return std::as_bytes(std::span(buffer.data)).subspan(v.byteOffset, v.byteLength);
}

Model::Elements Model::elements(int view, std::uint64_t offset, std::uint64_t count, int component_type,
                                int components, const std::string& user) const {
  const std::span<const std::byte> bytes = view_bytes(view, user);
  const std::size_t element = component_size(component_type) * static_cast<std::size_t>(components);
  const std::size_t given = data_.bufferViews[static_cast<std::size_t>(view)].byteStride;
  const std::size_t stride = given == 0 ? element : given;
  if (stride < element || stride > 252 || stride % component_size(component_type) != 0) {
    fail("buffer view " + std::to_string(view) + ": a stride of " + std::to_string(stride) +
         " bytes does not fit the elements of " + user + ", " + std::to_string(element) + " bytes each");
  }
  // count <= bytes.size() <= 2^32 and stride <= 252: the product cannot overflow.
  if (count == 0 || count > bytes.size() || offset > bytes.size() ||
      stride * (count - 1) + element > bytes.size() - offset) {
    fail(user + ": " + std::to_string(count) + " elements from byte " + std::to_string(offset) +
         " do not fit into buffer view " + std::to_string(view) + " of " + std::to_string(bytes.size()) +
         " bytes");
  }
  return {bytes.subspan(offset), stride, static_cast<std::size_t>(count), component_type};
}

template <typename Store>
void Model::apply_sparse(const tinygltf::Accessor& accessor, int components, const std::string& user,
                         const Store& store) const {
  const auto& sparse = accessor.sparse;
  const int type = sparse.indices.componentType;
  if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
    fail(user + ": sparse indices of component type " + std::to_string(type));
  }
  if (sparse.count < 1 || static_cast<std::size_t>(sparse.count) > accessor.count ||
      sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0) {
    fail(user + ": " + std::to_string(sparse.count) + " sparse elements or a negative offset");
  }
  const auto count = static_cast<std::uint64_t>(sparse.count);
  const Elements where = elements(
      sparse.indices.bufferView, static_cast<std::uint64_t>(sparse.indices.byteOffset), count, type, 1, user);
  const Elements what =
      elements(sparse.values.bufferView, static_cast<std::uint64_t>(sparse.values.byteOffset), count,
               accessor.componentType, components, user);
  for (std::size_t i = 0; i < where.count; ++i) {
    const std::uint32_t index = load_unsigned(where.bytes.data() + i * where.stride, type);
    if (index >= accessor.count) {
      fail(user + ": sparse index " + std::to_string(index) + " is out of range");
    }
    store(index, what.bytes.data() + i * what.stride);
  }
}

bool Model::parse_with(const std::string& file, FileAccess& access, std::string& error) {
  const std::string directory = access.directory().substr(0, access.directory().size() - 1);
  tinygltf::TinyGLTF parser;
  parser.SetImageLoader(keep_image, nullptr);
  parser.SetFsCallbacks(callbacks_of(access));
  std::string warning;
  const auto size = static_cast<unsigned int>(file.size());
  return file.starts_with("glTF")
             ? parser.LoadBinaryFromMemory(&data_, &error, &warning,
                                           reinterpret_cast<const unsigned char*>(file.data()), size,
                                           directory)
             : parser.LoadASCIIFromString(&data_, &error, &warning, file.data(), size, directory);
}

void Model::refuse_many_zeros(const tinygltf::Accessor& accessor, const std::string& name) const {
  if (accessor.count > most_zeros) {
    fail(name + " has " + std::to_string(accessor.count) + " elements and no buffer view");
  }
}

std::vector<double> Model::read_values(int accessor, int components, const std::string& user) const {
  const tinygltf::Accessor& a = at(data_.accessors, accessor, "accessor", user);
  read_[static_cast<std::size_t>(accessor)] = true;
  const std::string name = user + " (accessor " + std::to_string(accessor) + ")";
  if (tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(a.type)) != components ||
      a.type >= TINYGLTF_TYPE_MAT2) {
    if (!(components == 1 && a.type == TINYGLTF_TYPE_SCALAR)) {
      fail(name + " has the wrong type: " + std::to_string(components) + " components are needed");
    }
  }
  if (!is_component_type(a.componentType) || a.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
    fail(name + " has component type " + std::to_string(a.componentType) +
         ", which is not allowed for vertex attributes");
  }
  if (a.count == 0 || a.count > options().max_triangles) {
    fail(name + " has " + std::to_string(a.count) + " elements; 1 to " +
         std::to_string(options().max_triangles) + " are accepted");
  }
  const auto width = static_cast<std::size_t>(components);
  std::vector<double> values;
  if (a.bufferView < 0) {
    refuse_many_zeros(a, name);
    values.assign(a.count * width, 0.0);
  } else {
    const Elements e = elements(a.bufferView, a.byteOffset, a.count, a.componentType, components, name);
    const std::size_t step = component_size(a.componentType);
    values.reserve(a.count * width);
    for (std::size_t i = 0; i < e.count; ++i) {
      for (std::size_t c = 0; c < width; ++c) {
        values.push_back(load_value(e.bytes.data() + i * e.stride + c * step, a.componentType, a.normalized));
      }
    }
  }
  if (a.sparse.isSparse) {
    const std::size_t step = component_size(a.componentType);
    apply_sparse(a, components, name, [&](std::size_t i, const std::byte* from) {
      for (std::size_t c = 0; c < width; ++c) {
        values[i * width + c] = load_value(from + c * step, a.componentType, a.normalized);
      }
    });
  }
  return values;
}

std::vector<double> Model::read_matrices(int accessor, std::size_t count, const std::string& user) const {
  const tinygltf::Accessor& a = at(data_.accessors, accessor, "accessor", user);
  read_[static_cast<std::size_t>(accessor)] = true;
  const std::string name = user + " (accessor " + std::to_string(accessor) + ")";
  if (a.type != TINYGLTF_TYPE_MAT4 || a.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT) {
    fail(name + " has the wrong type: 4 x 4 matrices of floats are needed");
  }
  if (a.sparse.isSparse) {
    fail(name + ": sparse matrices are not supported");
  }
  if (a.count < count) {
    fail(name + " has " + std::to_string(a.count) + " matrices; " + std::to_string(count) + " are needed");
  }
  const Elements e = elements(a.bufferView, a.byteOffset, a.count, a.componentType, 16, name);
  std::vector<double> values;
  values.reserve(count * 16);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t c = 0; c < 16; ++c) {
      values.push_back(load_value(e.bytes.data() + i * e.stride + c * sizeof(float), a.componentType, false));
    }
  }
  return values;
}

std::vector<std::uint32_t> Model::read_indices(int accessor, const std::string& user) const {
  const tinygltf::Accessor& a = at(data_.accessors, accessor, "accessor", user);
  read_[static_cast<std::size_t>(accessor)] = true;
  const std::string name = user + " (accessor " + std::to_string(accessor) + ")";
  const int type = a.componentType;
  if (a.type != TINYGLTF_TYPE_SCALAR ||
      (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
       type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)) {
    fail(name + " has the wrong type: unsigned scalars are needed");
  }
  if (a.count > 3 * options().max_triangles) {
    fail(name + " has " + std::to_string(a.count) + " elements; at most " +
         std::to_string(3 * options().max_triangles) + " are accepted");
  }
  std::vector<std::uint32_t> indices;
  if (a.bufferView < 0 && a.sparse.isSparse) {
    refuse_many_zeros(a, name);
    indices.assign(a.count, 0);
  } else {
    const Elements e = elements(a.bufferView, a.byteOffset, a.count, type, 1, name);
    indices.reserve(e.count);
    for (std::size_t i = 0; i < e.count; ++i) {
      indices.push_back(load_unsigned(e.bytes.data() + i * e.stride, type));
    }
  }
  if (a.sparse.isSparse) {
    apply_sparse(a, 1, name,
                 [&](std::size_t i, const std::byte* from) { indices[i] = load_unsigned(from, type); });
  }
  return indices;
}

double checked_number(const Model& model, double value, double lowest, double highest,
                      const std::string& what) {
  if (!(value >= lowest && value <= highest)) {
    std::ostringstream text;
    text << what << " is " << value << "; it must lie in " << lowest << " to " << highest;
    model.fail(text.str());
  }
  return value;
}

}  // namespace marti::scenes::gltf
