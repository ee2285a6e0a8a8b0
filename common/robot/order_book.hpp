#pragma once

#include <algorithm>
#include <deque>
#include <optional>
#include <string>

#include "idl/Operation.h"

namespace prehend::robot {

/// Replies to the last orders: one that comes again is answered as before and not executed again.
/// Whoever gives an order may so repeat it until it is answered.
class OrderBook {
 public:
  std::optional<v1::OperatorReply> find(const std::string& id) const {
    for (const v1::OperatorReply& reply : replies_)
      if (reply.id().to_string() == id) return reply;
    return std::nullopt;
  }
  void add(const v1::OperatorReply& reply) {
    replies_.push_back(reply);
    if (replies_.size() > max_kept) replies_.pop_front();
  }
  /// Is it refused for the first time?
  bool refuse(const std::string& id) {
    if (std::find(refused_.begin(), refused_.end(), id) != refused_.end()) return false;
    refused_.push_back(id);
    if (refused_.size() > max_kept) refused_.pop_front();
    return true;
  }

 private:
  static constexpr std::size_t max_kept = 64;
  std::deque<v1::OperatorReply> replies_;
  std::deque<std::string> refused_;
};

}  // namespace prehend::robot
