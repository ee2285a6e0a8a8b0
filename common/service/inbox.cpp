#include "common/service/inbox.hpp"

#include <algorithm>
#include <utility>

namespace prehend::service {

void Input::add(Arrival arrival) {
  Writer& writer = writers.try_emplace(arrival.writer, Writer{arrival.instance, 0}).first->second;
  arrival.index = writer.received++;
  waiting.push_back(std::move(arrival));
}

std::uint64_t Input::received_from(const dds::GuidPrefix& writer) const {
  const auto known = writers.find(writer);
  return known == writers.end() ? 0 : known->second.received;
}

void Input::sort(std::vector<Arrival>& arrivals) const {
  if (writers.size() < 2) return;
  std::ranges::stable_sort(arrivals, {}, [this](const Arrival& arrival) {
    return writers.find(arrival.writer)->second.first;
  });
}

Input& Inbox::add(std::string_view topic) {
  const auto place = std::find_if(inputs_.begin(), inputs_.end(),
                                  [&](const auto& input) { return input->topic > topic; });
  return **inputs_.insert(place, std::make_unique<Input>(Input{topic, {}, {}}));
}

std::vector<Arrival> Inbox::take_all() {
  std::vector<Arrival> taken;
  for (const auto& input : inputs_) {
    for (Arrival& arrival : input->waiting) taken.push_back(std::move(arrival));
    input->waiting.clear();
  }
  return taken;
}

void deliver(std::vector<Arrival>& due) {
  std::stable_sort(due.begin(), due.end(),
                   [](const auto& a, const auto& b) { return a.stamp_ns < b.stamp_ns; });
  for (Arrival& arrival : due) arrival.deliver();
}

}  // namespace prehend::service
