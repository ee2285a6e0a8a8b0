#include "services/glove/core/calibration/toucher.hpp"

#include <fmt/format.h>

namespace prehend::glove {
namespace {

const ProcessorOptions toucher_hand{.hand = model::HumanHand(1.4)};
constexpr StillOptions touching{.apart = 0.05};
constexpr auto index_finger = static_cast<std::size_t>(model::Finger::index);

}  // namespace

Toucher::Toucher(std::vector<Eigen::Vector3d> p_W)
    : p_W_(std::move(p_W)), processor_(toucher_hand), still_(touching) {}

std::optional<Eigen::Vector3d> Toucher::asked() const {
  if (p_T_.size() >= p_W_.size()) return std::nullopt;
  return p_W_[p_T_.size()];
}

std::optional<double> Toucher::see(const Frame& frame) {
  if (!asked()) return std::nullopt;
  const Processed processed = processor_.process(frame, frame.stamp);
  if (!processed.posture || !processed.posture->fingertips[index_finger].valid) {
    waiting_for_ = "the index finger is not seen";
    return std::nullopt;
  }
  // With the tracker taken for the table, the hand's pose is that in T.
  const Eigen::Vector3d p_TF =
      processed.posture->X_WH * processed.posture->fingertips[index_finger].p_HF;
  const auto held = still_.see(frame.stamp, p_TF);
  if (!held) {
    waiting_for_ = still_.waiting_for();
    return std::nullopt;
  }
  p_T_.emplace_back(held->mean);
  waiting_for_.clear();
  return held->wobble;
}

bool Toucher::redo() {
  if (p_T_.empty()) return false;
  p_T_.pop_back();
  return true;
}

Expected<Registration> Toucher::result() const {
  if (asked())
    return fail(fmt::format("{} of {} points were touched", p_T_.size(), p_W_.size()),
                "registration", waiting_for_);
  return register_tracker(p_W_, p_T_);
}

}  // namespace prehend::glove
