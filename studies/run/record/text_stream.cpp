#include "studies/run/record/text_stream.h"

#include <cerrno>
#include <system_error>

#include "sim/error.h"

namespace marti::studies::run {

TextStream::TextStream(const std::filesystem::path& file) : file_(file), pending_(file) {
  sim::Descriptor descriptor = pending_.open();
  stream_.reset(::fdopen(descriptor.get(), "wb"));
  if (!stream_) {
    fail();
  }
  (void)descriptor.release();  // the stream closes it
}

void TextStream::write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stream_.get()) != text.size()) {
    fail();
  }
}

void TextStream::close() {
  if (std::fclose(stream_.release()) != 0) {
    fail();
  }
}

void TextStream::fail() const {
  throw sim::UserError(file_.string() + ": cannot be written: " + std::generic_category().message(errno));
}

}  // namespace marti::studies::run
