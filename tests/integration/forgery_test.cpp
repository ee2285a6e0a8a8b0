// What a stranger on the same host says in plain text in the name of others, who are alive: one
// packet severed two services with keys for good (Fast DDS 2.9.1). Samples go on whatever it says;
// without keys they come again. Waits are for events.
#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <iostream>
#include <thread>

#include "common/dds/guard/guarded_transport.hpp"
#include "services/cli/tools/keys/keystore.hpp"
#include "tests/integration/rig.hpp"
#include "tests/support/packets/packets.hpp"

namespace prehend::integration {
namespace {

using cli::Keystore;
using dds::GuidPrefix;
using test::Bytes;
using test::Message;

/// Sends to all of a domain, as their own announcements come.
class Stranger {
 public:
  explicit Stranger(int domain) : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    to_.sin_family = AF_INET;
    to_.sin_port = htons(static_cast<std::uint16_t>(7400 + 250 * domain));
    ::inet_pton(AF_INET, "239.255.0.1", &to_.sin_addr);
    in_addr loopback{};
    loopback.s_addr = htonl(INADDR_LOOPBACK);
    ::setsockopt(socket_, IPPROTO_IP, IP_MULTICAST_IF, &loopback, sizeof loopback);
  }
  ~Stranger() { ::close(socket_); }
  void send(const Bytes& bytes) const {
    ASSERT_EQ(::sendto(socket_, bytes.data(), bytes.size(), 0,
                       reinterpret_cast<const sockaddr*>(&to_), sizeof to_),
              static_cast<ssize_t>(bytes.size()));
  }
  /// An announcement of this participant, as all hear it.
  std::optional<Bytes> hear_announcement(const GuidPrefix& of) const {
    const int in = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    const int on = 1;
    ::setsockopt(in, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    sockaddr_in any = to_;
    any.sin_addr.s_addr = htonl(INADDR_ANY);
    ip_mreq group{to_.sin_addr, {htonl(INADDR_LOOPBACK)}};
    const timeval patience{0, 100'000};
    ::setsockopt(in, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    std::optional<Bytes> heard;
    if (::bind(in, reinterpret_cast<const sockaddr*>(&any), sizeof any) == 0 &&
        ::setsockopt(in, IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof group) == 0)
      eventually(20, [&] {
        Bytes bytes(65536);
        const ssize_t size = ::recv(in, bytes.data(), bytes.size(), 0);
        bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
        const auto packet = dds::read_packet(bytes);
        if (packet && packet->sender == of && !packet->announcements.empty()) heard = bytes;
        return heard.has_value();
      });
    ::close(in);
    return heard;
  }

 private:
  int socket_;
  sockaddr_in to_{};
};

using Attacks = std::vector<std::pair<std::string, Message>>;
constexpr std::uint32_t high = 1'000'000;  // above the numbers of the real ones

/// Departures, and announcements that change things.
void say_departures(Attacks& all, const GuidPrefix& of, const Message& in) {
  const Bytes ends = in.list({{0x0070, test::guid(of)}, {0x0071, {0, 0, 0, 3}}});
  Bytes key = in.list_head();
  for (const std::uint8_t byte : in.list({{0x0050, test::guid(of)}})) key.push_back(byte);
  all.emplace_back("departure",
                   Message(in).data({.sequence = high, .parameters = ends, .content_flag = 0}));
  all.emplace_back(
      "departure with key",
      Message(in).data(
          {.sequence = high + 1, .parameters = ends, .content = key, .content_flag = 8}));
  all.emplace_back("departure with data",
                   Message(in).data({.sequence = high + 2, .parameters = ends, .content = key}));
  all.emplace_back("departure with a bare key",
                   Message(in).data({.sequence = high + 3,
                                     .parameters = in.list({{0x0071, {0, 0, 0, 3}}}),
                                     .content = test::guid(of),
                                     .content_flag = 8}));
  all.emplace_back("departure in a fragment", Message(in).data({.sequence = high + 4,
                                                                .parameters = ends,
                                                                .content = key,
                                                                .content_flag = 8,
                                                                .fragment = true}));
  for (const Duration lease : {Duration::zero(), Duration(1'000'000)}) {
    Bytes content = in.list_head();
    for (const std::uint8_t byte : in.list({{0x0015, {2, 3, 0, 0}},
                                            {0x0016, {1, 15, 0, 0}},
                                            {0x0050, test::guid(of)},
                                            {0x0031, in.locator({127, 9, 9, 9})},
                                            {0x0032, in.locator({127, 9, 9, 9})},
                                            {0x0058, {0x3f, 0x0c, 0, 0}},
                                            {0x0002, in.lease(lease)}}))
      content.push_back(byte);
    all.emplace_back("lease", Message(in).data({.sequence = high + 5, .content = content}));
  }
}

/// Endings of endpoints, and samples given up.
void say_endings(Attacks& all, const GuidPrefix& of, const Message& in) {
  for (const std::uint32_t writer : {0x000003c2u, 0x000004c2u, 0xff0003c2u, 0xff0004c2u})
    for (std::uint32_t n = 1; n < 4; ++n)
      for (std::uint32_t entity = 1; entity < 5; ++entity)
        for (const std::uint32_t kind : {2u, 3u, 4u, 7u})
          all.emplace_back(
              "end of an endpoint",
              Message(in).data({.writer = writer,
                                .sequence = n,
                                .parameters = in.list({{0x0070, test::guid(of, entity << 8 | kind)},
                                                       {0x0071, {0, 0, 0, 3}}}),
                                .content_flag = 0}));
  for (std::uint32_t entity = 1; entity < 5; ++entity)
    for (const std::uint32_t kind : {2u, 3u}) {
      all.emplace_back("gap", Message(in).samples(8, entity << 8 | kind, 1, high));
      all.emplace_back("heartbeat", Message(in).samples(7, entity << 8 | kind, high, high + 9));
    }
  for (const std::uint32_t writer :
       {0x000100c2u, 0xff0003c2u, 0xff0004c2u, 0xff0200c2u, 0xff0202c3u, 0x000201c3u}) {
    all.emplace_back("gap", Message(in).samples(8, writer, 1, high));
    all.emplace_back("heartbeat", Message(in).samples(7, writer, high, high + 9));
  }
}

/// All that could end something, in both orders of bytes.
Attacks attacks(const GuidPrefix& of) {
  Attacks all;
  for (const bool little_endian : {true, false}) {
    const Message in(of, little_endian);
    say_departures(all, of, in);
    say_endings(all, of, in);
  }
  return all;
}

/// As Fast DDS 2.9.1 believed it.
Message departure(const GuidPrefix& of) {
  const Message in(of);
  return Message(in).data(
      {.sequence = 1'000'000,
       .parameters = in.list({{0x0070, test::guid(of)}, {0x0071, {0, 0, 0, 3}}}),
       .content_flag = 0});
}

std::uint64_t dropped(dds::PacketVerdict reason) {
  for (const dds::Dropped& one : dds::dropped_packets())
    if (one.reason == reason) return one.count;
  return 0;
}

class Forgery : public Rig {
 protected:
  Forgery() : stranger_(domain_) {}
  void make_keys() {
    auto made = Keystore::init(folder_ / "keys", std::chrono::days(30), from_ns(now_ns()),
                               {name_, domain_});
    if (!made) throw std::runtime_error(made.error().message());
    keys_ = made->folder().string();
  }
  dds::Participant member(const std::string& name) {
    auto made = dds::Participant::create(
        {.name = name, .domain = domain_, .rig = name_, .network = {.keys = keys_}});
    if (!made) throw std::runtime_error(made.error().message());
    return std::move(*made);
  }
  template <class T>
  static int matched(dds::Reader<T>& reader) {
    eprosima::fastdds::dds::SubscriptionMatchedStatus status;
    reader.raw().get_subscription_matched_status(status);
    return status.current_count;
  }

  Stranger stranger_;
  std::string keys_;
};

/// A writer of detections and a reader, in participants of their own.
struct Pair {
  dds::Participant recognition, mapping;
  dds::Writer<v1::ObjectDetection> writer = *recognition.writer(dds::object_detection);
  dds::Reader<v1::ObjectDetection> reader = *mapping.reader(dds::object_detection);
  /// So many more samples come within the limit.
  bool goes_on(int samples, double limit_s) {
    int heard = 0;
    return eventually(limit_s, [&] {
      v1::ObjectDetection message;
      message.stamp_ns(now_ns());
      writer.write(message);
      heard += static_cast<int>(reader.take().size());
      return heard >= samples;
    });
  }
};

TEST_F(Forgery, WithKeysNoPlainPacketEndsAnything) {
  make_keys();
  Pair pair{member("recognition"), member("mapping")};
  ASSERT_TRUE(pair.goes_on(20, 20));
  for (const auto& of : {pair.recognition.identity(), pair.mapping.identity()})
    for (const auto& [name, message] : attacks(of)) {
      stranger_.send(message);
      if (name == "end of an endpoint" || name == "gap" || name == "heartbeat") continue;
      ASSERT_TRUE(pair.goes_on(20, 15)) << name;
    }
  // Also what was noticed only now, by the next announcements.
  EXPECT_TRUE(eventually(30, [&] {
    EXPECT_TRUE(pair.goes_on(20, 15));
    EXPECT_EQ(matched(pair.reader), 1);
    return dropped(dds::PacketVerdict::forged_departure) >= 20;
  })) << dropped(dds::PacketVerdict::forged_departure);
  EXPECT_TRUE(pair.goes_on(500, 15));
  EXPECT_GT(dropped(dds::PacketVerdict::contradicts), 0u);
  EXPECT_GT(dropped(dds::PacketVerdict::not_encrypted), 0u);
  EXPECT_FALSE(dds::anybody_stranded());
}

// Members are met again by who joins now, whatever was said of them.
TEST_F(Forgery, WithKeysOneWhoLeavesIsNoticedAtOnce) {
  make_keys();
  auto mapping = member("mapping");
  auto reader = *mapping.reader(dds::object_detection);
  for (int round = 0; round < 3; ++round) {
    std::optional<dds::Participant> recognition(member("recognition"));
    std::optional writer(*recognition->writer(dds::object_detection));
    ASSERT_TRUE(eventually(10, [&] { return matched(reader) == 1; })) << round;
    writer.reset();
    recognition.reset();
    EXPECT_TRUE(eventually(15, [&] { return matched(reader) == 0; })) << "the lease is 20 s";
  }
}

/// The same announcement in the name of nobody.
Bytes invented(Bytes announcement, const GuidPrefix& of, std::uint32_t number) {
  GuidPrefix other = of;
  for (std::size_t i = 0; i < 4; ++i) other[8 + i] = static_cast<std::uint8_t>(number >> 8 * i);
  for (auto at = announcement.begin();
       (at = std::search(at, announcement.end(), of.begin(), of.end())) != announcement.end();)
    at = std::copy(other.begin(), other.end(), at);
  return announcement;
}

// 4,300 of them kept a process that joined then from finding anybody for 12 s.
TEST_F(Forgery, WithKeysAFloodOfNewcomersDoesNotKeepOutOneWhoJoins) {
  make_keys();
  auto recognition = member("recognition");
  auto writer = *recognition.writer(dds::object_detection);
  const GuidPrefix known = recognition.identity();
  const auto announcement = stranger_.hear_announcement(known);
  ASSERT_TRUE(announcement);
  std::atomic<std::uint32_t> sent = 0;
  std::jthread flood([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      for (int i = 0; i < 100; ++i)
        stranger_.send(invented(*announcement, known, 1'000'000 + ++sent));
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  });
  ASSERT_TRUE(eventually(10, [&] { return sent > 5000; }));
  const std::int64_t begin = now_ns();
  auto mapping = member("mapping");
  std::cout << "joined after " << 1e-9 * static_cast<double>(now_ns() - begin) << " s\n";
  auto reader = *mapping.reader(dds::object_detection);
  const bool found = eventually(10, [&] {
    v1::ObjectDetection message;
    message.stamp_ns(now_ns());
    writer.write(message);
    return !reader.take().empty();
  });
  std::cout << "met after " << 1e-9 * static_cast<double>(now_ns() - begin) << " s\n";
  EXPECT_TRUE(found);
  EXPECT_TRUE(eventually(30, [&] { return sent > 100'000; }));
  flood = {};
  EXPECT_GT(dropped(dds::PacketVerdict::too_many), 10'000u);
}

class ForgeryOfServices : public Forgery {
 protected:
  /// Until the service says that it has seen a forged departure.
  static bool is_counted(dds::Reader<v1::ServiceStatus>& statuses) {
    return hear<v1::ServiceStatus>(statuses, 15,
                                   [](const v1::ServiceStatus& status) {
                                     for (const auto& drop : status.drops())
                                       if (drop.reason().to_string() ==
                                           "departure of a participant that is still there")
                                         return true;
                                     return false;
                                   })
        .has_value();
  }
};

TEST_F(ForgeryOfServices, ASecuredServiceGoesOnAndSaysWhatWasTried) {
  make_keys();
  auto simulation = start("simulation", {"lab.keys=" + keys_});
  network_.keys = keys_;
  participant_.reset();
  participant_ = member("viewer");
  auto states = reader(dds::robot_state);
  auto statuses = reader(dds::service_status);
  const auto any = [](const auto&) { return true; };
  ASSERT_TRUE(hear<v1::HandState>(states, 20, any));
  stranger_.send(departure(participant_->identity()));
  EXPECT_TRUE(is_counted(statuses));
  EXPECT_EQ(matched(states), 1);
  EXPECT_TRUE(hear<v1::HandState>(states, 15, any));
  EXPECT_FALSE(simulation.exit());
}

// One is lost by its lease of 20 s and comes back: they were strangers until somebody started one
// of them anew.
TEST_F(ForgeryOfServices, WithKeysOneThatWasLostIsMetAgain) {
  make_keys();
  const Strings sets{"lab.keys=" + keys_, "lab.scene=" + scene(1)};
  auto simulation = start("simulation", sets), mapping = start("mapping", sets),
       glove = start("glove", sets);
  participant_.reset();
  participant_ = member("viewer");
  auto gates = reader(dds::robot_gate);
  std::uint64_t obeyed = 0;
  const auto is_obeyed = [&](const v1::GateState& gate) {
    const bool more = gate.obeyed() > obeyed;
    obeyed = gate.obeyed();
    return more;
  };
  ASSERT_TRUE(hear<v1::GateState>(gates, 40, is_obeyed));
  mapping.signal(SIGSTOP);
  EXPECT_FALSE(eventually(23, [] { return false; })) << "longer than the lease";
  for (const auto& sample : gates.take()) obeyed = std::max(obeyed, sample.data.obeyed());
  mapping.signal(SIGCONT);
  const std::int64_t begin = now_ns();
  EXPECT_TRUE(hear<v1::GateState>(gates, 20, is_obeyed));
  std::cout << "met again after " << 1e-9 * static_cast<double>(now_ns() - begin) << " s\n";
  EXPECT_FALSE(mapping.exit() || simulation.exit() || glove.exit());
}

TEST_F(ForgeryOfServices, WithoutKeysItHealsAndIsCounted) {
  auto simulation = start("simulation");
  auto states = reader(dds::robot_state);
  auto statuses = reader(dds::service_status);
  const auto any = [](const auto&) { return true; };
  ASSERT_TRUE(hear<v1::HandState>(states, 20, any));
  stranger_.send(departure(participant_->identity()));
  const std::int64_t sent = now_ns();
  EXPECT_TRUE(hear<v1::HandState>(
      states, 5, [&](const auto& state) { return state.stamp_ns() > sent + 600'000'000; }));
  EXPECT_TRUE(is_counted(statuses));
}

}  // namespace
}  // namespace prehend::integration
