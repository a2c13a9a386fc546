// Parts of a long piece of work that are done, kept in a file until all are: work that was ended in the
// middle finds them again when it begins anew.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "sim/descriptor.h"
#include "sim/input_files.h"
#include "sim/work_meter.h"

namespace marti::sim {

/// Thread-safe. A part is bytes as the program has them in memory, so only the program that has written it
/// can read it.
class FinishedParts {
 public:
  /// Takes up what `file` keeps of the same `work`, a text that tells all that decides the parts: the
  /// program, the configuration. The parts of other work are dropped. UserError when it cannot be written, is
  /// in use by another process, or is another program's.
  FinishedParts(std::filesystem::path file, const std::string& work);
  /// Removes the file: all is done, or has failed. What ends the program by a signal leaves it there.
  ~FinishedParts();
  FinishedParts(const FinishedParts&) = delete;
  FinishedParts& operator=(const FinishedParts&) = delete;

  /// How many parts it had when it was opened.
  [[nodiscard]] std::size_t taken_up() const { return taken_up_; }
  /// The bytes kept under this name.
  [[nodiscard]] std::optional<std::string> find(const std::string& name) const;
  /// UserError when they cannot be written.
  void keep(const std::string& name, const std::string& bytes);

 private:
  void write(std::string_view bytes);
  /// Returns the length of what is whole.
  std::size_t read(std::string_view content);

  std::filesystem::path file_;
  Descriptor open_;
  mutable std::mutex mutex_;  // of the two below
  std::map<std::string, std::string> parts_;
  std::size_t taken_up_ = 0;
};

/// Adds a value to `bytes`: one that is copied by its bytes, or a list or text of such.
template <class T>
void pack(std::string& bytes, const T& value) {
  if constexpr (std::is_trivially_copyable_v<T>) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  } else {
    static_assert(std::is_trivially_copyable_v<typename T::value_type>);
    pack(bytes, std::uint64_t{value.size()});
    bytes.append(reinterpret_cast<const char*>(value.data()), value.size() * sizeof(typename T::value_type));
  }
}

/// Takes a value from the beginning of `bytes`; false if it is not there.
template <class T>
[[nodiscard]] bool unpack(std::string_view& bytes, T& value) {
  const auto take = [&](void* to, std::size_t size) {
    if (size > bytes.size()) {
      return false;
    }
    if (size > 0) {
      std::memcpy(to, bytes.data(), size);
    }
    bytes.remove_prefix(size);
    return true;
  };
  if constexpr (std::is_trivially_copyable_v<T>) {
    return take(static_cast<void*>(&value), sizeof value);
  } else {
    std::uint64_t size = 0;
    if (!unpack(bytes, size) || size > bytes.size() / sizeof(typename T::value_type)) {
      return false;
    }
    value.resize(size);
    return take(static_cast<void*>(value.data()), size * sizeof(typename T::value_type));
  }
}

/// Does `work`, which sets all of `values`, unless the meter's finished parts have them: then they are taken
/// from there. Counts a part of this kind as finished. `name` tells the part from all others of the kind; the
/// files read so far (sim/input_files.h) must be those of the call that finished it. A null `meter` has none.
template <class Work, class... Values>
void once(WorkMeter* meter, const std::string& kind, const std::string& name, const Work& work,
          Values&... values) {
  if (meter == nullptr) {
    work();
    return;
  }
  FinishedParts* const parts = meter->parts();
  const std::string full_name = parts == nullptr ? "" : kind + "\n" + name + "\n" + inputs_digest();
  if (const auto kept = parts == nullptr ? std::nullopt : parts->find(full_name)) {
    std::string_view bytes = *kept;
    if ((unpack(bytes, values) && ...) && bytes.empty()) {
      meter->finish(kind, false);
      return;
    }
  }
  work();
  if (parts != nullptr) {
    std::string bytes;
    (pack(bytes, values), ...);
    parts->keep(full_name, bytes);
  }
  meter->finish(kind, true);
}

}  // namespace marti::sim
