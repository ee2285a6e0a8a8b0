#include "services/console/service/mailbox.hpp"

#include <utility>

namespace prehend::console {

void Mailbox::put(std::size_t topic, dds::RawSample&& sample) {
  Letter letter{topic, sample.instance, to_ns(sample.sent), nullptr};
  if (sample.kind == dds::RawSample::Kind::data)
    letter.payload =
        std::make_shared<const std::string>(sample.payload.begin(), sample.payload.end());
  bool first = false;
  {
    const std::scoped_lock lock(mutex_);
    first = newest_.empty() && queued_.empty();
    keep(topic, std::move(letter));
  }
  if (first) ring_();
}

void Mailbox::keep(std::size_t topic, Letter letter) {
  if (keeps_all_[topic]) {
    queued_.push_back(std::move(letter));
    if (queued_.size() <= max_queued) return;
    queued_.pop_front();
    ++lost_;
    return;
  }
  const std::pair key{topic, letter.instance};
  if (newest_.size() >= max_instances && !newest_.contains(key))
    ++lost_;
  else
    newest_[key] = std::move(letter);
}

std::vector<Letter> Mailbox::take() {
  std::vector<Letter> all;
  const std::scoped_lock lock(mutex_);
  all.reserve(newest_.size() + queued_.size());
  for (auto& [key, letter] : newest_) all.push_back(std::move(letter));
  for (Letter& letter : queued_) all.push_back(std::move(letter));
  newest_.clear();
  queued_.clear();
  return all;
}

std::uint64_t Mailbox::lost() const {
  const std::scoped_lock lock(mutex_);
  return lost_;
}

}  // namespace prehend::console
