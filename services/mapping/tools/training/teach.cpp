#include "services/mapping/tools/training/teach.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace prehend::mapping {

namespace {

/// How far some fingertip is from where it is in another posture, at most, m.
double distance(const Features& a, const Features& b) {
  const Features d = a - b;
  return std::max({d.segment<3>(0).norm(), d.segment<3>(3).norm(), d.segment<3>(6).norm()});
}

}  // namespace

std::vector<learning::TrainingPair> curriculum(const model::HandModel& hand, const Scheme& scheme,
                                               const std::string& user, int takes, int postures,
                                               const std::vector<RobotGrasp>& grasps) {
  constexpr double past = 0.30;  // rad, as in SetOptions::past_contact
  std::vector<learning::TrainingPair> asked;
  for (int take = 0; take < takes; ++take) {
    learning::TrainingPair pair;
    pair.user = user;
    pair.take = static_cast<unsigned>(take);
    pair.source = "teach";
    for (const SchemePosture& posture : scheme.posture_set(postures)) {
      pair.posture = posture.name;
      pair.dof = posture.robot;
      asked.push_back(pair);
    }
    for (const RobotGrasp& grasp : grasps) {
      pair.posture = to_string(grasp.type);
      pair.object = grasp.object;
      pair.shape = model::to_string(grasp.shape.kind);
      pair.size = grasp.shape.size;
      pair.X_OG = grasp.X_OG;
      pair.dof = past_contact(hand, grasp, scheme.open.robot, past);
      asked.push_back(pair);
    }
  }
  return asked;
}

Stillness stillness(const std::deque<std::pair<Time, Features>>& samples) {
  Stillness result;
  for (const auto& [stamp, features] : samples)
    result.mean += features / static_cast<double>(samples.size());
  for (const auto& [stamp, features] : samples)
    result.wobble = std::max(result.wobble, distance(features, result.mean));
  return result;
}

const learning::TrainingPair* Teacher::asked() const {
  return shown_.size() < asked_.size() ? &asked_[shown_.size()] : nullptr;
}

std::optional<Shown> Teacher::see(const Features& features, Time stamp) {
  if (!asked()) return std::nullopt;
  // Time that goes back belongs to another recording or clock.
  if (!window_.empty() && stamp <= window_.back().first) window_.clear();
  window_.emplace_back(stamp, features);
  while (stamp - window_.front().first > options_.still_for) window_.pop_front();
  const auto refuse = [&](std::string why) {
    waiting_for_ = std::move(why);
    return std::nullopt;
  };
  // A frame's time may be missing at the window's begin.
  const bool whole = stamp - window_.front().first >= options_.still_for * 9 / 10;
  const Stillness now = stillness(window_);
  if (now.wobble > options_.still_within) return refuse("keep still");
  if (!whole || static_cast<int>(window_.size()) < options_.min_samples)
    return refuse("keep still a moment longer");
  if (refused_ && distance(now.mean, *refused_) < options_.apart)
    return refuse("move, then show it again");

  Shown shown{*asked(), now.wobble, std::numeric_limits<double>::infinity(), {}, 0};
  for (const Shown& other : shown_) {
    if (other.pair.take != shown.pair.take) continue;
    const double apart = distance(now.mean, Features(other.pair.features));
    // Grasps may look alike: they are told apart by their object.
    const bool comparable = shown.pair.object.empty() && other.pair.object.empty();
    if (comparable && apart < shown.separation) {
      shown.separation = apart;
      shown.nearest_name = other.pair.posture;
    }
    // The posture before this one, whatever it was, is not shown twice.
    if (&other == &shown_.back() && apart < options_.apart / 2)
      return refuse(fmt::format("this is still «{}»", other.pair.posture));
  }
  if (shown.separation < options_.apart)
    return refuse(fmt::format("too much like «{}»", shown.nearest_name));
  shown.pair.features = now.mean;
  const double unlike = std::min(1.0, shown.separation / options_.apart - 1);
  shown.quality = unlike * (1 - now.wobble / options_.still_within);
  refused_.reset();
  window_.clear();
  waiting_for_.clear();
  shown_.push_back(shown);
  return shown;
}

bool Teacher::redo() {
  if (shown_.empty()) return false;
  refused_ = Features(shown_.back().pair.features);
  shown_.pop_back();
  window_.clear();
  return true;
}

learning::TrainingSet taught_set(const model::HandModel& hand, const Scheme& scheme,
                                 const std::vector<Shown>& shown) {
  learning::TrainingSet set{hand.name(), scheme.name, {}, {}};
  for (const model::HandDof& dof : hand.dofs()) set.dof_names.push_back(dof.name);
  for (const Shown& one : shown) set.pairs.push_back(one.pair);
  return set;
}

Expected<void> check_consistent(const learning::TrainingSet& set) {
  constexpr double alike = 0.003;    // m
  constexpr double different = 0.1;  // rad or m, of some DoF
  const auto same_scene = [](const learning::TrainingPair& a, const learning::TrainingPair& b) {
    return a.user == b.user && a.take == b.take && a.object == b.object;
  };
  for (std::size_t i = 0; i < set.pairs.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const learning::TrainingPair &a = set.pairs[k], &b = set.pairs[i];
      if (!same_scene(a, b) || distance(Features(a.features), Features(b.features)) > alike ||
          (a.dof - b.dof).lpNorm<Eigen::Infinity>() < different)
        continue;
      return fail(
          "two postures look alike and shall be answered differently",
          fmt::format("pairs {} ({}) and {} ({}) of {}", k, a.posture, i, b.posture, a.user),
          "show one of them again");
    }
  return {};
}

}  // namespace prehend::mapping
