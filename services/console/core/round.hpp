#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "services/console/core/hub.hpp"

namespace prehend::console {

/// What one tick has brought, until the hub is told: of each key the newest. Clients are sent
/// something at the end of a tick only, so nobody is too slow for what was replaced within it.
/// Pure.
class Round {
 public:
  /// Nothing as payload: the key is only to be forgotten.
  void put(std::uint32_t channel, const std::string& key, std::int64_t stamp_ns, Payload payload,
           bool last) {
    const auto [place, fresh] = places_.try_emplace({channel, key}, all_.size());
    if (fresh) all_.emplace_back();
    all_[place->second] = {channel, key, stamp_ns, std::move(payload), last};
  }

  void tell(Hub& hub) {
    for (One& one : all_) {
      if (one.payload) hub.publish(one.channel, one.key, one.stamp_ns, std::move(one.payload));
      if (one.last) hub.forget(one.channel, one.key);
    }
    all_.clear();
    places_.clear();
  }

 private:
  struct One {
    std::uint32_t channel = 0;
    std::string key;
    std::int64_t stamp_ns = 0;
    Payload payload;
    bool last = false;
  };
  std::vector<One> all_;
  std::map<std::pair<std::uint32_t, std::string>, std::size_t> places_;
};

}  // namespace prehend::console
