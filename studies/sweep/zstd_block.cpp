#include "studies/sweep/zstd_block.h"

#include <zstd.h>

#include <memory>

#include "sim/error.h"
#include "studies/sweep/byte_parts.h"

namespace marti::studies {

namespace {

// The fastest of the ordinary levels: a log is written and read often, and kept for a while only.
constexpr int level = 1;

struct FreeContext {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};

void succeed(std::size_t code) {
  if (ZSTD_isError(code) != 0U) {
    throw sim::InternalError(std::string("zstd: ") + ZSTD_getErrorName(code));
  }
}

}  // namespace

std::string compress_block(std::string_view raw) {
  const std::unique_ptr<ZSTD_CCtx, FreeContext> context(ZSTD_createCCtx());
  sim::ensure(context != nullptr, "zstd: no context");
  succeed(ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, level));
  succeed(ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1));
  std::string compressed(ZSTD_compressBound(raw.size()), '\0');
  const std::size_t size =
      ZSTD_compress2(context.get(), compressed.data(), compressed.size(), raw.data(), raw.size());
  succeed(size);
  compressed.resize(size);
  return compressed;
}

std::string decompress_block(std::string_view compressed, std::size_t raw_size) {
  if (ZSTD_findFrameCompressedSize(compressed.data(), compressed.size()) != compressed.size() ||
      ZSTD_getFrameContentSize(compressed.data(), compressed.size()) != raw_size) {
    throw DamagedBytes("a block is not of the size that it should be");
  }
  const std::unique_ptr<ZSTD_DCtx, FreeContext> context(ZSTD_createDCtx());
  sim::ensure(context != nullptr, "zstd: no context");
  std::string raw(raw_size, '\0');
  const std::size_t size =
      ZSTD_decompressDCtx(context.get(), raw.data(), raw.size(), compressed.data(), compressed.size());
  if (ZSTD_isError(size) != 0U) {
    throw DamagedBytes(std::string("a block is damaged: ") + ZSTD_getErrorName(size));
  }
  if (size != raw_size) {
    throw DamagedBytes("a block is not of the size that it should be");
  }
  return raw;
}

}  // namespace marti::studies
