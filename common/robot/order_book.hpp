#pragma once

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
    if (replies_.size() > 64) replies_.pop_front();
  }

 private:
  std::deque<v1::OperatorReply> replies_;
};

}  // namespace prehend::robot
