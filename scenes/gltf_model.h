// Internal to scenes/: a parsed glTF file with the checks that every part of the loader needs. tinygltf
// accepts indices out of range, recursive nodes and short buffers, so the model's data must only be accessed
// through these checks.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tiny_gltf.h>

#include "scenes/scene_notes.h"
#include "scenes/source_file.h"

namespace marti::scenes {

class FileAccess;

}  // namespace marti::scenes

namespace marti::scenes::gltf {

/// The most zeros that an accessor without a buffer view may stand for.
inline constexpr std::size_t most_zeros = std::size_t{1} << 22U;

class Model : public SourceFile {
 public:
  /// Reads and parses the file and the files that it refers to. Throws UserError.
  Model(std::filesystem::path path, const FileOptions& options);

  [[nodiscard]] const tinygltf::Model& data() const { return data_; }

  /// `list[index]`; a UserError that names the `user` of the missing `kind` if there is no such element.
  template <typename T>
  [[nodiscard]] const T& at(const std::vector<T>& list, int index, const char* kind,
                            const std::string& user) const {
    if (index < 0 || static_cast<std::size_t>(index) >= list.size()) {
      fail_reference(kind, index, list.size(), user);
    }
    return list[static_cast<std::size_t>(index)];
  }

  /// What was replaced when the file was parsed.
  [[nodiscard]] const LeftOut& replaced() const { return replaced_; }

  /// The bytes of a buffer view; its range is checked against its buffer.
  [[nodiscard]] std::span<const std::byte> view_bytes(int view, const std::string& user) const;

  /// An accessor of `components` floating-point or integer values an element, with sparse replacements
  /// applied and normalised integers mapped to 0..1 or -1..1: count * components values.
  [[nodiscard]] std::vector<double> read_values(int accessor, int components, const std::string& user) const;

  /// The first `count` matrices of an accessor of 4 x 4 float matrices, 16 values each, column by column.
  [[nodiscard]] std::vector<double> read_matrices(int accessor, std::size_t count,
                                                  const std::string& user) const;

  /// An accessor of unsigned scalars, for vertex indices.
  [[nodiscard]] std::vector<std::uint32_t> read_indices(int accessor, const std::string& user) const;

  /// Whether the accessor has been read so far. It must be one of the file's.
  [[nodiscard]] bool was_read(std::size_t accessor) const { return read_[accessor]; }

 private:
  struct Elements {
    std::span<const std::byte> bytes;
    std::size_t stride;
    std::size_t count;
    int component_type;
  };
  [[noreturn]] void fail_reference(const char* kind, int index, std::size_t size,
                                   const std::string& user) const;
  [[nodiscard]] Elements elements(int view, std::uint64_t offset, std::uint64_t count, int component_type,
                                  int components, const std::string& user) const;
  /// Passes each replacement to `store`: its element and its bytes.
  template <typename Store>
  void apply_sparse(const tinygltf::Accessor& accessor, int components, const std::string& user,
                    const Store& store) const;
  void refuse_many_zeros(const tinygltf::Accessor& accessor, const std::string& name) const;
  void parse();
  bool parse_with(const std::string& file, FileAccess& access, std::string& error);

  tinygltf::Model data_;
  LeftOut replaced_;
  mutable std::vector<std::atomic<bool>> read_;  // for each accessor; animations are read by many threads
};

/// `value` as a finite number in `lowest`..`highest`, else UserError naming `what`.
double checked_number(const Model& model, double value, double lowest, double highest,
                      const std::string& what);

}  // namespace marti::scenes::gltf
