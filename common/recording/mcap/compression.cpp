#include "common/recording/mcap/compression.hpp"

#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <memory>
#include <string>

#include "common/base/named_values.hpp"

namespace prehend::recording::mcap {
namespace {

// No chunk of a sane file is larger; a claim beyond it is damage.
constexpr std::uint64_t max_chunk = std::uint64_t{1} << 31;
constexpr int zstd_level = 1;

/// Room for the next piece of output, between what is there and the claimed size.
std::size_t grow(Bytes& out, std::size_t filled, std::uint64_t size) {
  if (filled == out.size())
    out.resize(std::min<std::uint64_t>(size, std::max<std::uint64_t>(2 * filled, 64 * 1024)));
  return out.size() - filled;
}

tl::unexpected<Error> damaged(const std::string& why) {
  return fail("a chunk does not decompress: " + why);
}

/// Puts what comes out into `out`, also before a failure.
Expected<void> decompress_zstd(View bytes, std::uint64_t size, Bytes& out) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(),
                                                                     &ZSTD_freeDCtx);
  std::size_t filled = 0;
  ZSTD_inBuffer input{bytes.data(), bytes.size(), 0};
  std::size_t left = 1;  // 0: the frame is complete
  Expected<void> done;
  while (left != 0 && done) {
    const std::size_t room = grow(out, filled, size);
    std::uint8_t none = 0;
    ZSTD_outBuffer output{room == 0 ? &none : out.data() + filled, room, 0};
    const std::size_t before = input.pos;
    left = ZSTD_decompressStream(context.get(), &output, &input);
    if (ZSTD_isError(left)) {
      done = damaged(ZSTD_getErrorName(left));
      continue;
    }
    filled += output.pos;
    if (left != 0 && output.pos == 0 && input.pos == before)
      done = damaged(room == 0 ? "it is larger than it says" : "it is cut short");
  }
  out.resize(filled);
  if (done && filled != size) return damaged("it is smaller than it says");
  return done;
}

Expected<void> decompress_lz4(View bytes, std::uint64_t size, Bytes& out) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION)))
    return damaged("no memory");
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(
      raw, &LZ4F_freeDecompressionContext);
  std::size_t filled = 0, left = 1;
  Expected<void> done;
  while (left != 0 && done) {
    const std::size_t room = grow(out, filled, size);
    std::uint8_t none = 0;
    std::size_t written = room, read = bytes.size();
    left = LZ4F_decompress(context.get(), room == 0 ? &none : out.data() + filled, &written,
                           bytes.data(), &read, nullptr);
    if (LZ4F_isError(left)) {
      done = damaged(LZ4F_getErrorName(left));
      continue;
    }
    filled += written;
    bytes = bytes.subspan(read);
    if (left != 0 && written == 0 && read == 0)
      done = damaged(room == 0 ? "it is larger than it says" : "it is cut short");
  }
  out.resize(filled);
  if (done && filled != size) return damaged("it is smaller than it says");
  return done;
}

Expected<void> decompress_into(Compression compression, View bytes, std::uint64_t size,
                               Bytes& out) {
  if (size > max_chunk) return damaged("it says that it is larger than 2 GiB");
  switch (compression) {
    case Compression::zstd:
      return decompress_zstd(bytes, size, out);
    case Compression::lz4:
      return decompress_lz4(bytes, size, out);
    case Compression::none:
      break;
  }
  out.assign(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(
                                                std::min<std::uint64_t>(size, bytes.size())));
  if (bytes.size() != size) return damaged("its size is not what it says");
  return {};
}

/// As in the file, where none is an empty text.
constexpr auto compression_names = named_values<Compression>(
    {{Compression::none, ""}, {Compression::lz4, "lz4"}, {Compression::zstd, "zstd"}});

}  // namespace

std::string_view name(Compression compression) {
  return compression_names.name(compression);
}

Expected<Compression> compression_named(std::string_view wanted) {
  if (const auto known = compression_names.value(wanted)) return *known;
  return fail("compression «" + std::string(wanted) + "» is not known", {}, "none, lz4 or zstd");
}

Expected<void> compress(Compression compression, View bytes, Bytes& out) {
  const std::size_t at = out.size();
  switch (compression) {
    case Compression::none:
      append(out, bytes);
      return {};
    case Compression::zstd: {
      out.resize(at + ZSTD_compressBound(bytes.size()));
      const std::size_t size =
          ZSTD_compress(out.data() + at, out.size() - at, bytes.data(), bytes.size(), zstd_level);
      if (ZSTD_isError(size)) return fail(std::string("zstd: ") + ZSTD_getErrorName(size));
      out.resize(at + size);
      return {};
    }
    case Compression::lz4: {
      out.resize(at + LZ4F_compressFrameBound(bytes.size(), nullptr));
      const std::size_t size =
          LZ4F_compressFrame(out.data() + at, out.size() - at, bytes.data(), bytes.size(), nullptr);
      if (LZ4F_isError(size)) return fail(std::string("lz4: ") + LZ4F_getErrorName(size));
      out.resize(at + size);
      return {};
    }
  }
  return fail("compression of no known kind");
}

Expected<Bytes> decompress(Compression compression, View bytes, std::uint64_t size) {
  Bytes out;
  if (auto done = decompress_into(compression, bytes, size, out); !done)
    return tl::unexpected(done.error());
  return out;
}

Bytes decompress_front(Compression compression, View bytes, std::uint64_t size) {
  Bytes out;
  (void)decompress_into(compression, bytes, size, out);  // it fails, for the end is missing
  return out;
}

}  // namespace prehend::recording::mcap
