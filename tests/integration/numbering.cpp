// prehend-numbering DOMAIN samples|orders FIFO
// Writes each number that comes by the FIFO: as samples of all reliable topics, or as an order.
// Says «met» once all are read. Leaves when nobody has the FIFO open any more. Participants of one
// process hand samples over by pointers: what is to go over a cable needs two.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <optional>
#include <thread>

#include "common/base/clock.hpp"
#include "common/dds/topics.hpp"
#include "tests/integration/numbered.hpp"

namespace prehend::integration {
namespace {

template <class Writer>
bool is_met(Writer& writer) {
  eprosima::fastdds::dds::PublicationMatchedStatus matched;
  writer.raw().get_publication_matched_status(matched);
  return matched.current_count > 0;
}

struct End {
  std::optional<dds::Participant> participant;
  std::vector<dds::RawWriter> samples;
  std::optional<dds::Writer<v1::OperatorCommand>> orders;

  bool open(int domain, bool gives_orders) {
    auto made = dds::Participant::create(
        {.name = "far", .domain = domain, .rig = "newest", .network = {.profile = "lan"}});
    if (!made) return false;
    participant.emplace(std::move(*made));
    if (gives_orders) {
      auto writer = participant->writer(dds::operator_command);
      if (writer) orders.emplace(std::move(*writer));
      return orders.has_value();
    }
    for (const dds::RawTopic& topic : numbered_topics()) {
      auto writer = dds::RawWriter::create(*participant, topic);
      if (!writer) return false;
      samples.push_back(std::move(*writer));
    }
    return true;
  }
  bool met() {
    return orders ? is_met(*orders)
                  : std::all_of(samples.begin(), samples.end(), is_met<dds::RawWriter>);
  }
  void write(std::uint64_t number) {
    if (orders) {
      v1::OperatorCommand order;
      order.id(std::to_string(number));
      (void)orders->write(order);
    }
    for (dds::RawWriter& writer : samples)
      for (std::uint8_t i = 0; i < instances; ++i) writer.write(numbered(i, number), process_now());
  }
};

}  // namespace
}  // namespace prehend::integration

int main(int count, char** arguments) {
  using namespace prehend;
  if (count != 4) return 2;
  integration::End end;
  if (!end.open(std::stoi(arguments[1]), std::string(arguments[2]) == "orders")) return 1;
  while (!end.met()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  std::puts("met");
  std::fflush(stdout);
  std::ifstream fifo(arguments[3]);
  for (std::uint64_t number = 0; fifo >> number;) end.write(number);
  return 0;
}
