// A long text file, written piece by piece.
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "sim/pending_file.h"

namespace marti::studies::run {

/// Written under a temporary name; commit() gives the file its own. A UserError says why it cannot be written
/// (no such directory, disk full, ...); without commit() nothing is left behind.
class TextStream {
 public:
  explicit TextStream(const std::filesystem::path& file);

  void write(std::string_view text);
  /// Completes the file, which keeps its temporary name.
  void close();
  /// The file's name until commit().
  [[nodiscard]] const std::filesystem::path& temporary() const { return pending_.temporary(); }
  /// Gives the file its own name. Call it after close().
  void commit() { pending_.commit(); }

 private:
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  [[noreturn]] void fail() const;

  std::filesystem::path file_;
  sim::PendingFile pending_;
  std::unique_ptr<std::FILE, Closer> stream_;
};

}  // namespace marti::studies::run
