// What it costs to judge a packet before the middleware gets it, beside what the plain transport
// costs: one datagram of the same bytes through a socket on loopback, sent and received by the same
// thread, so that no thread has to be woken. One thread.
#include <arpa/inet.h>
#include <benchmark/benchmark.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>

#include "common/base/clock.hpp"
#include "common/dds/guard/guarded_transport.hpp"
#include "tests/support/packets/packets.hpp"

using namespace prehend;
using test::Message;

namespace {

constexpr dds::Ipv4 somewhere{10, 0, 0, 1};

/// A sample of so many bytes, as Fast DDS sends it; 0: an announcement.
Message packet(std::int64_t size) {
  Message message(test::participant(1));
  message.timestamp();
  if (size == 0)
    message.announcement(test::participant(1), {somewhere, {10, 0, 1, 1}});
  else
    message.sample(static_cast<std::size_t>(size)).part(0x07, test::Bytes(28));
  return message;
}

void plain_transport(benchmark::State& state) {
  const test::Bytes bytes = packet(state.range(0));
  const int in = ::socket(AF_INET, SOCK_DGRAM, 0), out = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof address;
  if (::bind(in, reinterpret_cast<sockaddr*>(&address), length) != 0) std::abort();
  ::getsockname(in, reinterpret_cast<sockaddr*>(&address), &length);
  test::Bytes buffer(65536);
  for (auto _ : state) {
    if (::sendto(out, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&address),
                 length) < 0 ||
        ::recv(in, buffer.data(), buffer.size(), 0) != static_cast<ssize_t>(bytes.size()))
      std::abort();
  }
  ::close(in);
  ::close(out);
}

/// participants: that the lab has.
void guard(benchmark::State& state) {
  dds::PacketGuard judge(false);
  for (int n = 0; n < state.range(1); ++n) {
    auto prefix = test::participant(1);
    prefix[4] = static_cast<std::uint8_t>(n);
    judge.accepts(Message(prefix).announcement(prefix, {somewhere}).bytes(), somewhere);
  }
  judge.accepts(packet(0).bytes(), somewhere);
  const test::Bytes bytes = packet(state.range(0));
  for (auto _ : state)
    if (!judge.accepts(bytes, somewhere)) std::abort();
}

BENCHMARK(plain_transport)->ArgName("bytes")->Arg(0)->Arg(500)->Arg(60'000);
BENCHMARK(guard)
    ->ArgNames({"bytes", "participants"})
    ->Args({0, 10})
    ->Args({500, 10})
    ->Args({500, 100})
    ->Args({60'000, 10});

}  // namespace

BENCHMARK_MAIN();
