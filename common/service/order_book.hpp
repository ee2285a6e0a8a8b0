#pragma once

#include <algorithm>
#include <deque>
#include <optional>
#include <string>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/dds/topics.hpp"
#include "idl/Operation.h"

namespace prehend::service {

/// Names who gave an order, for people: the writer's name, as mapping@host/1. A writer that gives
/// an order as soon as it has joined is not known by its name yet; then the order's id stands for
/// it.
std::string given_by(const v1::OperatorCommand& order, const std::string& writer);

/// May this writer be believed to mean what it says on the topic? Its role must be known, must be
/// one that writes the topic, and must not be that of a replayer, which only repeats.
bool means(std::optional<dds::Role> role, const dds::TopicInfo& topic);

/// Succeeds for an order that may move a robot, or let it move: it was given less than 10 s ago, by
/// a writer whose role gives orders. by: who gave it, for the message.
Expected<void> meant_now(const v1::OperatorCommand& order, const std::string& by,
                         std::optional<dds::Role> role, Time now);

/// Replies to the last orders: one that comes again is answered as before and not executed again.
/// Whoever gives an order may so repeat it until it is answered. `whose` tells orders of one id
/// apart, where nobody shall be able to answer, or to use up, the order of another.
class OrderBook {
 public:
  std::optional<v1::OperatorReply> find(const std::string& id,
                                        const std::string& whose = {}) const {
    for (const auto& [owner, reply] : replies_)
      if (reply.id().to_string() == id && owner == whose) return reply;
    return std::nullopt;
  }
  void add(const v1::OperatorReply& reply, const std::string& whose = {}) {
    replies_.emplace_back(whose, reply);
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
  std::deque<std::pair<std::string, v1::OperatorReply>> replies_;
  std::deque<std::string> refused_;
};

}  // namespace prehend::service
