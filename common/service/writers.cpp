#include "common/service/writers.hpp"

#include <vector>

namespace prehend::service {
namespace {

constexpr Duration noticed = std::chrono::seconds(1);  // who has been silent for longer is gone
constexpr std::size_t max_writers = 16;

}  // namespace

void Writers::heard(const dds::GuidPrefix& writer, Time now) {
  if (heard_.size() >= max_writers && !heard_.contains(writer))
    std::erase_if(heard_, [&](const auto& entry) { return now - entry.second > noticed; });
  if (heard_.size() < max_writers || heard_.contains(writer)) heard_[writer] = now;
}

Expected<dds::GuidPrefix> Writers::named(
    const std::string& name, const std::optional<dds::GuidPrefix>& leader, Time now,
    const std::function<std::string(const dds::GuidPrefix&)>& name_of,
    std::string_view topic) const {
  std::vector<dds::GuidPrefix> meant;
  std::string all;
  for (const auto& [writer, at] : heard_) {
    if (now - at > noticed) continue;
    const std::string service = name_of(writer);
    all += (all.empty() ? "" : ", ") + service;
    if (service == name || (service.starts_with(name + "@") && writer != leader))
      meant.push_back(writer);
  }
  if (!name.empty() && meant.size() == 1) return meant.front();
  return fail(meant.empty() ? "does not send " + std::string(topic) : "several are called so", name,
              all.empty() ? "nobody does" : "those who do: " + all);
}

}  // namespace prehend::service
