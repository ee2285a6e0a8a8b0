#include "services/console/core/story.hpp"

#include <algorithm>
#include <utility>

namespace prehend::console {

void Story::put(const std::string& key, std::int64_t stamp_ns, Payload payload) {
  Message message{key, {stamp_ns, std::move(payload)}};
  const auto [known, fresh] = numbers_.try_emplace(key, ++count_);
  if (fresh) {
    messages_.emplace_hint(messages_.end(), count_, std::move(message));
    if (messages_.size() > max_kept_) erase(std::string(messages_.begin()->second.key));
    return;
  }
  auto node = messages_.extract(std::exchange(known->second, count_));
  node.key() = count_;
  node.mapped() = std::move(message);
  messages_.insert(messages_.end(), std::move(node));
}

void Story::end(const std::string& key) {
  const auto known = numbers_.find(key);
  if (known == numbers_.end()) return;
  messages_.at(known->second).ended = true;
  ended_.push_back(key);
  if (ended_.size() <= max_ended_) return;
  const auto oldest = numbers_.find(ended_.front());
  if (oldest != numbers_.end() && messages_.at(oldest->second).ended) erase(ended_.front());
  ended_.pop_front();
}

void Story::erase(const std::string& key) {
  const auto known = numbers_.find(key);
  messages_.erase(known->second);
  numbers_.erase(known);
}

void Story::clear() {
  messages_.clear();
  numbers_.clear();
  ended_.clear();
}

/// The first that it is to get.
Story::Messages::const_iterator Story::unread(const Reader& reader) const {
  const auto is_for = [&](const auto& entry) {
    return !entry.second.ended || entry.first > reader.begun;
  };
  return std::find_if(messages_.upper_bound(reader.read), messages_.end(), is_for);
}

std::optional<Story::Part> Story::next(Reader& reader) const {
  const auto found = unread(reader);
  if (found == messages_.end()) return std::nullopt;
  const std::uint64_t before = std::max(reader.read, reader.begun);
  if (found->first > before) reader.missed += found->first - before - 1;
  reader.read = found->first;
  return found->second.part;
}

std::optional<Story::Part> Story::rest(Reader& reader, std::string_view opening,
                                       std::string_view closing) {
  auto at = unread(reader);
  if (at == messages_.end()) return std::nullopt;
  reader.missed = missed(reader);
  const std::uint64_t after = std::exchange(reader.read, count_);
  // Who has just come is told less: not what has ended.
  const bool shared = after >= reader.begun;
  if (shared && joined_.part.payload && joined_.after == after && joined_.until == count_)
    return joined_.part;
  Part part = at->second.part;
  std::string all(opening);
  all += *part.payload;
  for (++at; at != messages_.end(); ++at) {
    if (at->second.ended && at->first <= reader.begun) continue;
    part.stamp_ns = std::max(part.stamp_ns, at->second.part.stamp_ns);
    all += ',';
    all += *at->second.part.payload;
  }
  all += closing;
  part.payload = std::make_shared<const std::string>(std::move(all));
  if (shared) joined_ = {after, count_, part};
  return part;
}

std::uint64_t Story::missed(const Reader& reader) const {
  const std::uint64_t before = std::max(reader.read, reader.begun);
  const auto there = std::distance(messages_.upper_bound(before), messages_.end());
  return reader.missed + (count_ - before) - static_cast<std::uint64_t>(there);
}

}  // namespace prehend::console
