#include "common/service/status.hpp"

#include <algorithm>
#include <utility>

namespace prehend::service {

void LatencyWindow::add(Duration latency) {
  values_us_[next_] = std::chrono::duration<double, std::micro>(latency).count();
  next_ = (next_ + 1) % values_us_.size();
  count_ = std::min(count_ + 1, values_us_.size());
}

double LatencyWindow::quantile_us(double q) const {
  if (count_ == 0) return 0;
  std::vector<double> sorted(values_us_.begin(), values_us_.begin() + static_cast<long>(count_));
  const auto rank = static_cast<long>(q * static_cast<double>(count_ - 1) + 0.5);
  std::nth_element(sorted.begin(), sorted.begin() + rank, sorted.end());
  return sorted[static_cast<std::size_t>(rank)];
}

double LatencyWindow::max_us() const {
  return count_ == 0 ? 0
                     : *std::max_element(values_us_.begin(),
                                         values_us_.begin() + static_cast<long>(count_));
}

void Status::count(std::string_view what, std::uint64_t n) {
  const std::scoped_lock lock(mutex_);
  const auto found = counts_.find(what);
  if (found != counts_.end())
    found->second.total += n;
  else
    counts_.emplace(std::string(what), Counter{n, 0});
}

void Status::drop(std::string_view reason, std::uint64_t n) {
  const std::scoped_lock lock(mutex_);
  const auto found = drops_.find(reason);
  if (found != drops_.end())
    found->second += n;
  else
    drops_.emplace(std::string(reason), n);
}

void Status::latency(std::string_view stage, Duration latency) {
  const std::scoped_lock lock(mutex_);
  const auto found = latencies_.find(stage);
  if (found != latencies_.end())
    found->second.add(latency);
  else
    latencies_.emplace(std::string(stage), LatencyWindow{}).first->second.add(latency);
}

void Status::running() {
  const std::scoped_lock lock(mutex_);
  state_ = v1::STATE_RUNNING;
  message_.clear();
}

void Status::degraded(std::string message) {
  const std::scoped_lock lock(mutex_);
  state_ = v1::STATE_DEGRADED;
  message_ = std::move(message);
}

void Status::note(std::string trouble) {
  const std::scoped_lock lock(mutex_);
  note_ = std::move(trouble);
}

std::uint64_t Status::dropped(std::string_view reason) const {
  const std::scoped_lock lock(mutex_);
  const auto found = drops_.find(reason);
  return found == drops_.end() ? 0 : found->second;
}

void Status::fill(v1::ServiceStatus& message, Time now) {
  const std::scoped_lock lock(mutex_);
  const double elapsed = to_seconds(now - last_fill_);
  message.stamp_ns(to_ns(now));
  const bool noted = !note_.empty() && state_ == v1::STATE_RUNNING;
  message.state(noted ? v1::STATE_DEGRADED : state_);
  const std::string both = message_ + (message_.empty() || note_.empty() ? "" : "; ") + note_;
  message.message(both.substr(0, 255).c_str());
  // The message's lists are bounded (idl/Operation.idl).
  message.rates().clear();
  for (auto& [name, counter] : counts_) {
    if (message.rates().size() == 64) break;
    v1::Rate rate;
    rate.name(name.substr(0, 64).c_str());
    rate.total(counter.total);
    rate.per_second(last_fill_ == Time{} || elapsed <= 0
                        ? 0
                        : static_cast<double>(counter.total - counter.last) / elapsed);
    counter.last = counter.total;
    message.rates().push_back(rate);
  }
  message.drops().clear();
  for (const auto& [reason, count] : drops_) {
    if (message.drops().size() == 64) break;
    v1::Drop drop;
    drop.reason(reason.substr(0, 64).c_str());
    drop.count(count);
    message.drops().push_back(drop);
  }
  message.latency().clear();
  for (const auto& [stage, window] : latencies_) {
    if (message.latency().size() == 32) break;
    v1::StageLatency latency;
    latency.stage(stage.substr(0, 64).c_str());
    latency.p50_us(window.quantile_us(0.5));
    latency.p99_us(window.quantile_us(0.99));
    latency.max_us(window.max_us());
    latency.count(window.count());
    message.latency().push_back(latency);
  }
  last_fill_ = now;
}

}  // namespace prehend::service
