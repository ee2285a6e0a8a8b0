// Damaged RTPS messages in plain text in the name of a member of a lab with keys, from its own
// host: nothing that passes says that it leaves, or changes what it announced, and the member is
// heard afterwards as before.
#include <algorithm>

#include "common/dds/guard/members.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"
#include "tests/support/packets/packets.hpp"

using namespace prehend;
using test::Message;
using Verdict = dds::Members::Verdict;

namespace {

constexpr Time start = Time(std::chrono::hours(1));

dds::GuidPrefix with_keys() {
  dds::GuidPrefix prefix = test::participant(1);
  prefix[0] |= 0x80;
  return prefix;
}
const dds::GuidPrefix glove = with_keys();

Message announcement(bool little_endian = true) {
  return Message(glove, little_endian).timestamp().announcement(glove, {{10, 0, 0, 1}});
}
std::string text(const Message& message) {
  return {message.bytes().begin(), message.bytes().end()};
}

}  // namespace

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  for (const bool little_endian : {true, false}) {
    const Message in(glove, little_endian);
    const test::Bytes ends = in.list({{0x0070, test::guid(glove)}, {0x0071, {0, 0, 0, 3}}});
    for (const Message& message :
         {announcement(little_endian), Message(in).departure(glove),
          Message(in).data({.parameters = ends, .content_flag = 0}),
          Message(in).data({.parameters = ends, .content = test::guid(glove), .content_flag = 8}),
          Message(in).data({.parameters = ends, .content = in.list_head(), .fragment = true}),
          Message(in).endpoint(glove).liveliness(glove), Message(in).samples(8, 0x103, 1, 100),
          Message(in).data({.writer = 0x000201c3, .content = test::Bytes(64)}),
          Message(in).part(0x31, test::Bytes(20)).part(0x30, test::Bytes(80))})
      fuzzer.seeds.push_back(text(message));
  }
  fuzzer.long_round = 1'000'000;
  fuzzer.mutate = [](Random& random, std::string bytes) {
    return fuzz::mutate_bytes(random, std::move(bytes));
  };
  fuzzer.target = [](const std::string& input) {
    dds::Members members(true);
    members.judge(glove, announcement().bytes(), start);
    members.let_in(glove);
    const test::Bytes bytes(input.begin(), input.end());
    // Whatever is not sound has been dropped before.
    const auto packet = dds::read_packet(bytes);
    if (packet && members.judge(glove, bytes, start) == Verdict::pass && packet->sender == glove &&
        !packet->for_others)
      for (const auto& said : packet->announcements)
        fuzz::require(!said.leaves && said.lease == std::chrono::seconds(20) &&
                          said.addresses == std::vector<dds::Ipv4>{{10, 0, 0, 1}},
                      "a member is said to leave, or to be elsewhere");
    fuzz::require(members.judge(glove, announcement().bytes(), start) == Verdict::pass,
                  "a member is not heard");
    fuzz::require(!members.is_stranded(start + seconds(60.0)), "a member is given up");
    return packet.has_value();
  };
  return fuzz::run(fuzzer, argc, argv);
}
