#include "services/cli/service/observer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/printable.hpp"
#include "common/convert/convert.hpp"
#include "common/convert/names.hpp"

namespace prehend::cli {
namespace {

/// The simulation's name for the time from a glove frame to its effect in the world.
constexpr std::string_view stage_to_world = "glove to accepted";

/// A grasp is judged within this time of its closure; older detections are not behind it.
constexpr std::int64_t remembered_ns = 10'000'000'000;

/// That there is no plan is believed once pictures of this long have brought none.
constexpr std::int64_t settled_ns = 1'000'000'000;

/// Where the grasped body was when the hand closed, in W.
std::optional<Eigen::Vector3d> grasped_at(const v1::GraspReport& report,
                                          const std::optional<v2::HandCommand>& command) {
  if (!command) return std::nullopt;
  const auto X_WB = convert::from_message(command->X_WB());
  const auto X_BO = convert::from_message(report.X_BO());
  if (!X_WB || !X_BO) return std::nullopt;
  return (*X_WB * *X_BO).translation();
}

double horizontal_distance(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return (a - b).head<2>().norm();
}

}  // namespace

Observer::Observer(std::optional<model::Scene> truth) : truth_(std::move(truth)) {}

void Observer::hear(const v1::GloveFrame& frame) {
  device_ = frame.device().to_string();
  // The device counts, so that frames lost on the way to here count too.
  frames_ = std::max<std::uint64_t>(frames_, frame.sequence_number() + 1);
}

void Observer::hear(const v1::ObjectDetection& detection) {
  seen_[detection.track()] = detection;
  if (report_ && detection.stamp_ns() > report_->stamp_ns()) return;
  auto& heard = detections_[detection.name().to_string()];
  const auto after = std::upper_bound(heard.begin(), heard.end(), detection.stamp_ns(),
                                      [](std::int64_t stamp, const v1::ObjectDetection& other) {
                                        return stamp < other.stamp_ns();
                                      });
  heard.insert(after, detection);
  while (heard.back().stamp_ns() - heard.front().stamp_ns() > remembered_ns) heard.pop_front();
}

void Observer::hear(const v2::HandCommand& command) {
  // What comes after the first grasp is another story; a hand that holds still because the
  // demonstration is over says nothing about how it was followed.
  if (report_ || (command.mode() == v1::MODE_HOLD && commanded())) return;
  command_ = command;
}

void Observer::hear(const v1::GraspReport& report) {
  if (!report_) report_ = report;
}

void Observer::hear(const v2::GraspCandidates& planned) {
  planned_[planned.track()] = planned;
}

void Observer::lost_object(std::uint32_t track) {
  seen_.erase(track);
  planned_.erase(track);
}

void Observer::hear(const v1::ArmState& state) {
  if (arm_ && !report_) arm_->hear(state);
}

void Observer::hear(const v1::ServiceStatus& status) {
  services_[status.service().to_string()] = status;
}

void Observer::lost_service(const std::string& key) {
  services_.erase(key);
}

const v1::ServiceStatus* Observer::service(std::string_view name) const {
  // One that was restarted is there twice until its first life is noticed to be over.
  const v1::ServiceStatus* newest = nullptr;
  for (const auto& [key, status] : services_)
    if (status.name().to_string() == name && (!newest || status.stamp_ns() > newest->stamp_ns()))
      newest = &status;
  return newest;
}

bool Observer::is_up(std::string_view name) const {
  const v1::ServiceStatus* status = service(name);
  return status && (status->state() == v1::STATE_RUNNING || status->state() == v1::STATE_DEGRADED);
}

bool Observer::has_counted(std::string_view name, std::string_view what) const {
  const v1::ServiceStatus* status = service(name);
  return status &&
         std::any_of(status->rates().begin(), status->rates().end(), [&](const v1::Rate& rate) {
           return rate.name().to_string() == what && rate.total() > 0;
         });
}

bool Observer::commanded() const {
  return command_ && command_->mode() != v1::MODE_HOLD;
}

bool Observer::is_planned(const v1::ObjectDetection& seen) const {
  const auto found = planned_.find(seen.track());
  if (found == planned_.end() || !found->second.complete()) return false;
  return !found->second.candidates().empty() ||
         seen.stamp_ns() - found->second.stamp_ns() >= settled_ns;
}

bool Observer::planned() const {
  return !seen_.empty() && std::all_of(seen_.begin(), seen_.end(), [this](const auto& seen) {
    return is_planned(seen.second);
  });
}

std::string Observer::unplanned() const {
  std::string names;
  for (const auto& [track, seen] : seen_)
    if (!is_planned(seen))
      names += (names.empty() ? "" : ", ") + printable(seen.name().to_string());
  return names;
}

std::vector<std::pair<std::string, std::string>> Observer::without_plan() const {
  std::vector<std::pair<std::string, std::string>> all;
  for (const auto& [track, seen] : seen_)
    if (const auto found = planned_.find(track);
        found != planned_.end() && found->second.complete() && found->second.candidates().empty())
      all.emplace_back(printable(seen.name().to_string()),
                       printable(found->second.reason().to_string()));
  return all;
}

bool Observer::latency_is_in() const {
  const v1::ServiceStatus* status = service("simulation");
  if (!status || !report_ || status->stamp_ns() < report_->stamp_ns()) return false;
  return std::any_of(status->latency().begin(), status->latency().end(), [](const auto& stage) {
    return stage.stage().to_string() == stage_to_world && stage.count() > 0;
  });
}

/// The detection behind the grasp: the newest up to closure of what the mapping took the object
/// for; where it took it for nothing, the one nearest to what was grasped; without a grasp the
/// surest.
const v1::ObjectDetection* Observer::recognised() const {
  const std::int64_t closure =
      report_ ? report_->stamp_ns() : std::numeric_limits<std::int64_t>::max();
  std::map<std::string, const v1::ObjectDetection*> newest;
  for (const auto& [name, heard] : detections_)
    for (const v1::ObjectDetection& detection : heard)
      if (detection.stamp_ns() <= closure) newest[name] = &detection;
  if (newest.empty()) return nullptr;
  const std::string believed = report_    ? report_->believed_object().to_string()
                               : command_ ? command_->object().to_string()
                                          : std::string();
  if (const auto found = newest.find(believed); found != newest.end()) return found->second;
  const auto place = report_ ? grasped_at(*report_, command_) : std::nullopt;
  const auto cost = [&](const auto& entry) {
    return place
               ? horizontal_distance(convert::from_message(entry.second->X_WO().position()), *place)
               : -entry.second->probability();
  };
  return std::min_element(newest.begin(), newest.end(),
                          [&](const auto& a, const auto& b) { return cost(a) < cost(b); })
      ->second;
}

std::string Observer::progress() const {
  std::string text = fmt::format("{} frames", frames_);
  if (const v1::ObjectDetection* seen = recognised())
    text += fmt::format(", {} ({:.0f} %)", printable(seen->name().to_string()),
                        100 * seen->probability());
  if (command_)
    text += fmt::format(", {} {:.2f}", convert::mode_names.name(command_->mode(), "hold"),
                        command_->weight());
  if (report_)
    text += fmt::format(", {} contacts, {}", report_->contacts().size(),
                        report_->held() ? "held" : "dropped");
  return text;
}

Outcome Observer::outcome() const {
  Outcome result;
  if (truth_) result.target = truth_->demonstrator.target;
  if (const v1::ObjectDetection* seen = recognised()) {
    Outcome::Object object;
    object.name = seen->name().to_string();
    object.shape = {convert::from_message(seen->shape()), convert::from_message(seen->size())};
    const Eigen::Vector3d p_WO = convert::from_message(seen->X_WO().position());
    // Against the object that it was taken for; against the nearest where that stands nowhere.
    std::optional<double> nearest, same;
    if (truth_)
      for (const model::PlacedObject& placed : truth_->objects) {
        const double distance = horizontal_distance(placed.X_WO.translation(), p_WO);
        std::optional<double>& best = placed.name == object.name ? same : nearest;
        if (!best || distance < *best) best = distance;
      }
    object.position_error = same ? same : nearest;
    result.object = object;
  }
  if (command_) {
    result.mode = command_->mode();
    result.weight = command_->weight();
    result.hand = command_->model().to_string();
    result.grasp_type = command_->grasp_type();
  }
  if (report_) {
    result.judged = true;
    // When the glove was late just then, the hand closed on what it had been led to before.
    if (report_->mode() != v1::MODE_HOLD) {
      result.mode = report_->mode();
      result.weight = report_->weight();
    }
    result.grasp_type = report_->grasp_type();
    result.grasp = {static_cast<int>(report_->contacts().size()),
                    report_->epsilon(),
                    report_->volume(),
                    report_->force_closure(),
                    report_->held(),
                    report_->reason().to_string()};
  }
  if (const v1::ServiceStatus* simulation = service("simulation"))
    for (const v1::StageLatency& stage : simulation->latency())
      if (stage.stage().to_string() == stage_to_world && stage.count() > 0)
        result.latency = Outcome::Latency{stage.p50_us() / 1000, stage.p99_us() / 1000};
  if (arm_)
    result.arm = Outcome::Arm{arm_->name(), arm_->worst_joint_speed(), arm_->out_of_reach()};
  result.device = device_;
  result.frames = frames_;
  if (const v1::ServiceStatus* glove = service("glove"))
    for (const v1::Drop& drop : glove->drops()) result.rejected += drop.count();
  return result;
}

}  // namespace prehend::cli
