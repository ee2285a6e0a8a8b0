// Writing a recording against the plain write of the same bytes to the same disk, and `info` of a
// large one. One thread. With PREHEND_LONG the large file has 1 GB, else 100 MB.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "common/base/random.hpp"
#include "common/recording/mcap/reader.hpp"
#include "common/recording/mcap/writer.hpp"

using namespace prehend;

namespace {

std::filesystem::path scratch_file() {
  return std::filesystem::current_path() / ("benchmark-" + std::to_string(::getpid()) + ".mcap");
}

/// As joint angles and pictures are: the one compressible, the other not.
recording::mcap::Bytes payload(std::size_t size, bool picture) {
  Random random(1);
  recording::mcap::Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i)
    bytes[i] = picture || i % 8 < 3 ? static_cast<std::uint8_t>(random.bits()) : 0x3f;
  return bytes;
}

void write_recording(const std::filesystem::path& path, const recording::mcap::Bytes& data,
                     std::size_t count, recording::mcap::Compression compression) {
  auto writer = recording::mcap::Writer::create(path, {.compression = compression}).value();
  const auto channel = writer.add_channel(0, "t", "cdr").value();
  for (std::uint32_t i = 0; i < count; ++i)
    if (!writer.write(recording::mcap::Message{channel, i, i * 50'000ull, i, data})) std::abort();
  if (!writer.close()) std::abort();
}

void plain(benchmark::State& state) {
  const auto size = static_cast<std::size_t>(state.range(0));
  const std::size_t count = static_cast<std::size_t>(state.range(1));
  const recording::mcap::Bytes data = payload(size, size > 100'000);
  for (auto _ : state) {
    auto file = recording::mcap::File::create(scratch_file()).value();
    recording::mcap::Bytes block;
    for (std::size_t i = 0; i < count; ++i) {
      recording::mcap::append(block, recording::mcap::View(data));
      if (block.size() >= 1024 * 1024 || i + 1 == count) {
        if (!file.write(block)) std::abort();
        block.clear();
      }
    }
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(count));
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(count * size));
  std::filesystem::remove(scratch_file());
}

void recording(benchmark::State& state, recording::mcap::Compression compression) {
  const auto size = static_cast<std::size_t>(state.range(0));
  const std::size_t count = static_cast<std::size_t>(state.range(1));
  const recording::mcap::Bytes data = payload(size, size > 100'000);
  for (auto _ : state) write_recording(scratch_file(), data, count, compression);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(count));
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(count * size));
  std::filesystem::remove(scratch_file());
}

void info(benchmark::State& state) {
  const std::size_t count = std::getenv("PREHEND_LONG") ? 1000 : 100;
  write_recording(scratch_file(), payload(1'000'000, true), count,
                  recording::mcap::Compression::none);
  for (auto _ : state) {
    auto reader = recording::mcap::Reader::open(scratch_file()).value();
    if (reader.statistics().message_count != count) std::abort();
  }
  std::filesystem::remove(scratch_file());
}

void sizes(benchmark::internal::Benchmark* each) {
  each->Args({500, 100'000})->Args({1'000'000, 100})->Unit(benchmark::kMillisecond)->UseRealTime();
}

BENCHMARK(plain)->Apply(sizes);
BENCHMARK_CAPTURE(recording, none, recording::mcap::Compression::none)->Apply(sizes);
BENCHMARK_CAPTURE(recording, lz4, recording::mcap::Compression::lz4)->Apply(sizes);
BENCHMARK_CAPTURE(recording, zstd, recording::mcap::Compression::zstd)->Apply(sizes);
BENCHMARK(info)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
