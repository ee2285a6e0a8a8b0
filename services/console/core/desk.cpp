#include "services/console/core/desk.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "services/console/core/documents.hpp"

namespace prehend::console {
namespace {

constexpr Duration patience = std::chrono::seconds(3);

}  // namespace

void Desk::add(const std::string& id, bool for_all, Hub::Call call, Time now) {
  waiting_[id] = {std::move(call), for_all, now + patience, ""};
}

std::vector<Desk::Answer> Desk::hear(View reply) {
  const auto found = waiting_.find(reply["id"].text());
  if (found == waiting_.end()) return {};
  Waiting& waiting = found->second;
  const std::string by = reply["service"].text(), message = reply["message"].text();
  const bool done = reply["done"].flag();
  if (!done && waiting.for_all) {
    waiting.refused += (waiting.refused.empty() ? "" : "; ") + by + ": " + message;
    return {};
  }
  const Hub::Call call = std::move(waiting.call);
  waiting_.erase(found);
  if (!done) return {{call, fail(message.empty() ? "not done" : message, by)}};
  return {{call, text_of({{"service", by}, {"message", message}})}};
}

std::vector<Desk::Answer> Desk::wait(Time now) {
  std::vector<Answer> late;
  for (auto at = waiting_.begin(); at != waiting_.end();) {
    Waiting& waiting = at->second;
    if (now < waiting.until) {
      ++at;
      continue;
    }
    late.push_back({std::move(waiting.call), waiting.refused.empty()
                                                 ? fail("nobody answered within 3 s")
                                                 : fail(waiting.refused)});
    at = waiting_.erase(at);
  }
  return late;
}

}  // namespace prehend::console
