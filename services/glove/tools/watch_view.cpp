#include "services/glove/tools/watch_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "common/base/named_values.hpp"
#include "common/base/printable.hpp"
#include "common/model/human_hand.hpp"
#include "common/service/status.hpp"

namespace prehend::glove {
namespace {

using Json = nlohmann::ordered_json;

constexpr Duration window = std::chrono::seconds(2);
constexpr double silent = 0.3;  // s
/// For the screen: «back of hand», where lab.toml has back_of_hand.
constexpr auto site_words = named_values<v1::SensorSite>({{v1::SITE_BACK_OF_HAND, "back of hand"},
                                                          {v1::SITE_THUMB, "thumb"},
                                                          {v1::SITE_INDEX, "index"},
                                                          {v1::SITE_MIDDLE, "middle"},
                                                          {v1::SITE_RING, "ring"},
                                                          {v1::SITE_LITTLE, "little"},
                                                          {v1::SITE_FOREARM, "forearm"}});

std::string_view name_of(v1::SensorSite site) {
  return site_words.name(site, "?");
}

std::string_view name_of(v1::ServiceState state) {
  return service::state_names.name(state, "?");
}

double quantile(std::deque<double> values, double q) {
  if (values.empty()) return 0;
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Text from outside, `width` bytes of it at most.
std::string clipped(std::string_view text, std::size_t width) {
  return printable(text.substr(0, width));
}

Json numbers(const v1::Vector3& v) {
  // Not finite is null in JSON.
  return {v.x(), v.y(), v.z()};
}

}  // namespace

void WatchView::Pace::add(Time now) {
  times_.push_back(now);
  while (now - times_.front() > window) times_.pop_front();
}

double WatchView::Pace::rate(Time now) const {
  const auto recent =
      std::count_if(times_.begin(), times_.end(), [&](Time time) { return now - time <= window; });
  if (recent < 2) return 0;
  const double span = to_seconds(now - times_[times_.size() - static_cast<std::size_t>(recent)]);
  return span > 0 ? static_cast<double>(recent) / span : 0;
}

void WatchView::hear(const v1::GloveFrame& frame, Time now) {
  if (frame.glove().to_string() != glove_) return;
  frame_ = frame;
  frame_at_ = now;
  frames_.add(now);
}

void WatchView::hear(const v1::HandPosture& posture, Time now) {
  if (posture.glove().to_string() != glove_) return;
  posture_ = posture;
  posture_at_ = now;
  postures_.add(now);
  latency_ms_.push_back(1e3 * to_seconds(now - from_ns(posture.origin_ns())));
  if (latency_ms_.size() > 256) latency_ms_.pop_front();
}

void WatchView::hear(const v1::ServiceStatus& status) {
  if (status.name().to_string() == "glove") services_[status.service().to_string()] = status;
}

void WatchView::lost_service(const std::string& key) {
  services_.erase(key);
}

std::string WatchView::page(Time now) const {
  std::string text;
  const auto line = [&](const std::string& words) { text += words.substr(0, 80) + '\n'; };
  if (!frame_) {
    line(fmt::format("glove {}: no frames heard", clipped(glove_, 40)));
  } else {
    const double age = to_seconds(now - frame_at_);
    line(fmt::format("glove {}: {}{}, {:.1f} frames/s{}", clipped(glove_, 20),
                     clipped(frame_->device().to_string(), 20),
                     frame_->left() ? ", left hand (mirrored)" : "", frames_.rate(now),
                     age > silent ? fmt::format(", silent for {:.1f} s", age) : ""));
    for (const v1::SensorReading& sensor : frame_->sensors()) {
      const auto& p = sensor.X_TS().position();
      line(fmt::format("  {:<13}{:<8} x {:7.3f}  y {:7.3f}  z {:7.3f} m", name_of(sensor.site()),
                       sensor.valid() ? "valid" : "LOST", p.x(), p.y(), p.z()));
    }
    if (!frame_->joint_angles().empty())
      line(fmt::format("  {} joint angles", frame_->joint_angles().size()));
  }
  if (!posture_) {
    line("hand: no posture heard");
  } else {
    const double age = to_seconds(now - posture_at_);
    line(
        fmt::format("hand of {}, scale {:.2f}: {:.1f} postures/s, quality {:.0f} %, latency {:.1f}"
                    " ms{}",
                    clipped(posture_->user().to_string(), 16), posture_->hand_scale(),
                    postures_.rate(now), 100 * posture_->quality(), quantile(latency_ms_, 0.5),
                    age > silent ? fmt::format(", held for {:.1f} s", age) : ""));
    const auto& p = posture_->X_WH().position();
    line(fmt::format("  back of hand         x {:7.3f}  y {:7.3f}  z {:7.3f} m on the table", p.x(),
                     p.y(), p.z()));
    for (std::size_t f = 0; f < model::finger_names.size(); ++f) {
      const v1::Fingertip& tip = posture_->fingertips()[f];
      if (!tip.valid()) {
        line(fmt::format("  {:<13}no tip", model::finger_names.rows[f].name));
        continue;
      }
      line(fmt::format("  {:<13}tip      x {:7.3f}  y {:7.3f}  z {:7.3f} m in the hand",
                       model::finger_names.rows[f].name, tip.p_HF().x(), tip.p_HF().y(),
                       tip.p_HF().z()));
    }
  }
  if (services_.empty()) line("service: none is there");
  for (const auto& [key, status] : services_) {
    line(fmt::format("service {}: {} {}", clipped(key, 40), name_of(status.state()),
                     clipped(status.message().to_string(), 80)));
    for (const v1::StageLatency& stage : status.latency())
      line(fmt::format("  {:<13}p50 {:.0f} us, p99 {:.0f} us",
                       clipped(stage.stage().to_string(), 13), stage.p50_us(), stage.p99_us()));
    for (const v1::Drop& drop : status.drops())
      line(fmt::format("  rejected: {:<28}{:>10}", clipped(drop.reason().to_string(), 28),
                       drop.count()));
  }
  return text;
}

std::string WatchView::json(Time now) const {
  Json document{
      {"glove", glove_}, {"frame", nullptr}, {"posture", nullptr}, {"services", Json::array()}};
  if (frame_) {
    Json list = Json::array();
    for (const v1::SensorReading& sensor : frame_->sensors())
      list.push_back({{"site", name_of(sensor.site())},
                      {"valid", sensor.valid()},
                      {"position_m", numbers(sensor.X_TS().position())}});
    document["frame"] = {{"device", frame_->device().to_string()},
                         {"left", frame_->left()},
                         {"rate_hz", frames_.rate(now)},
                         {"age_s", to_seconds(now - frame_at_)},
                         {"sensors", list},
                         {"joint_angles", frame_->joint_angles().size()}};
  }
  if (posture_) {
    Json tips = Json::object();
    for (std::size_t f = 0; f < model::finger_names.size(); ++f) {
      const v1::Fingertip& tip = posture_->fingertips()[f];
      tips[std::string(model::finger_names.rows[f].name)] =
          tip.valid() ? numbers(tip.p_HF()) : Json(nullptr);
    }
    document["posture"] = {
        {"user", posture_->user().to_string()},
        {"hand_scale", posture_->hand_scale()},
        {"rate_hz", postures_.rate(now)},
        {"age_s", to_seconds(now - posture_at_)},
        {"quality", posture_->quality()},
        {"position_m", numbers(posture_->X_WH().position())},
        {"fingertips_m", tips},
        {"latency_ms",
         {{"p50", quantile(latency_ms_, 0.5)}, {"p99", quantile(latency_ms_, 0.99)}}}};
  }
  for (const auto& [key, status] : services_) {
    Json rejected = Json::object(), latency = Json::object();
    for (const v1::Drop& drop : status.drops()) rejected[drop.reason().to_string()] = drop.count();
    for (const v1::StageLatency& stage : status.latency())
      latency[stage.stage().to_string()] = {{"p50", stage.p50_us()}, {"p99", stage.p99_us()}};
    document["services"].push_back({{"name", key},
                                    {"state", name_of(status.state())},
                                    {"message", status.message().to_string()},
                                    {"rejected", rejected},
                                    {"latency_us", latency}});
  }
  return document.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace prehend::glove
