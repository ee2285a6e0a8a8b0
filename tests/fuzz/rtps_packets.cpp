// Damaged RTPS messages on their way to a lab of two: sent from a stranger's address none of them
// speaks for a participant of the lab, and what the lab itself sends afterwards passes as before.
// What passes is its sender's own announcement, or comes from one that was announced there.
#include "common/dds/guard/address_book.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"
#include "tests/support/packets/packets.hpp"

using namespace prehend;
using dds::PacketVerdict;
using test::Message;

namespace {

const dds::GuidPrefix glove = test::participant(1), mapping = test::participant(2),
                      newcomer = test::participant(3);
constexpr dds::Ipv4 at_glove{10, 0, 0, 1}, at_mapping{10, 0, 0, 2}, at_stranger{10, 0, 0, 66};
constexpr Time start = Time(std::chrono::hours(1));

std::string text(const Message& message) {
  return {message.bytes().begin(), message.bytes().end()};
}

}  // namespace

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  for (const auto& sender : {glove, mapping, newcomer})
    for (const bool little_endian : {true, false})
      for (const Message& message :
           {Message(sender, little_endian).timestamp().announcement(sender, {at_glove, at_mapping}),
            Message(sender, little_endian).departure(sender),
            Message(sender, little_endian).endpoint(sender).liveliness(sender),
            Message(sender, little_endian).source(sender).timestamp().sample(200),
            Message(sender, little_endian)
                .announcement(sender, {})
                .part(0x06, test::Bytes(24))
                .part(0x80, test::Bytes(56))})
        fuzzer.seeds.push_back(text(message));
  fuzzer.long_round = 1'000'000;
  fuzzer.mutate = [](Random& random, std::string bytes) {
    return fuzz::mutate_bytes(random, std::move(bytes));
  };
  fuzzer.target = [](const std::string& input) {
    dds::AddressBook book;
    const auto judge = [&](const Message& message, const dds::Ipv4& source) {
      return book.judge(message.bytes(), source, start);
    };
    judge(Message(glove).announcement(glove, {}), at_glove);
    judge(Message(mapping).announcement(mapping, {}), at_mapping);
    const test::Bytes bytes(input.begin(), input.end());
    const auto packet = dds::read_packet(bytes);
    if (book.judge(bytes, at_stranger, start) == PacketVerdict::pass)
      fuzz::require(packet && !packet->for_others && packet->sender != glove &&
                        packet->sender != mapping && !packet->announcements.empty(),
                    "a stranger speaks in another's name");
    for (const auto& [who, where] : {std::pair(glove, at_glove), std::pair(mapping, at_mapping)}) {
      fuzz::require(judge(Message(who).sample(), where) == PacketVerdict::pass,
                    "a member is not heard");
      fuzz::require(judge(Message(who).sample(), at_stranger) == PacketVerdict::elsewhere,
                    "a stranger is heard as a member");
    }
    return packet.has_value();
  };
  return fuzz::run(fuzzer, argc, argv);
}
