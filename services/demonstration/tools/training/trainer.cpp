#include "services/demonstration/tools/training/trainer.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "services/demonstration/tools/training/material.hpp"

namespace prehend::demonstration {

namespace {

/// Of the hidden Markov models beside the networks.
constexpr std::array weights{0.0, 0.1, 0.2, 0.4, 0.8};

/// Trains what methods share once.
class Workshop {
 public:
  Workshop(const Material& material, const TrainerOptions& options)
      : material_(material), options_(options) {}

  Expected<Recogniser> make(Method method) {
    switch (method) {
      case Method::posture:
        return alone(method, posture_,
                     [&] { return train_networks(material_, Inputs::posture, options_); });
      case Method::trajectory:
        return alone(method, motion_,
                     [&] { return train_networks(material_, Inputs::motion, options_); });
      case Method::hmm:
        return alone(method, hmms_, [&] { return train_hmms(material_, Inputs::both); });
      case Method::hybrid:
        break;
    }
    return hybrid();
  }

 private:
  using Kept = std::optional<Trained>;

  static Expected<void> fill(Kept& kept, const auto& train) {
    if (kept) return {};
    auto trained = train();
    if (!trained) return tl::unexpected(trained.error());
    kept = std::move(*trained);
    return {};
  }

  Expected<Recogniser> alone(Method method, Kept& kept, const auto& train) {
    if (auto ok = fill(kept, train); !ok) return tl::unexpected(ok.error());
    return Recogniser::create(method, material_.classes, {{1, kept->classifier}},
                              calibrated_temperature(kept->unseen_scores, material_.truths));
  }

  Expected<Recogniser> hybrid() {
    if (auto ok = fill(both_, [&] { return train_networks(material_, Inputs::both, options_); });
        !ok)
      return tl::unexpected(ok.error());
    if (auto ok = fill(hmms_, [&] { return train_hmms(material_, Inputs::both); }); !ok)
      return tl::unexpected(ok.error());
    double best = 0, least = std::numeric_limits<double>::infinity();
    for (const double weight : weights) {
      const double loss =
          best_loss(both_->unseen_scores + weight * hmms_->unseen_scores, material_.truths);
      if (loss < least) least = loss, best = weight;
    }
    return Recogniser::create(
        Method::hybrid, material_.classes, {{1, both_->classifier}, {best, hmms_->classifier}},
        calibrated_temperature(both_->unseen_scores + best * hmms_->unseen_scores,
                               material_.truths));
  }

  const Material& material_;
  const TrainerOptions& options_;
  Kept posture_, motion_, both_, hmms_;
};

}  // namespace

Expected<std::vector<Recogniser>> train_recognisers(const std::vector<const Take*>& takes,
                                                    const std::vector<Method>& wanted,
                                                    const TrainerOptions& options,
                                                    const std::function<void(double)>& progress) {
  const auto material = material_of(takes, options.folds);
  if (!material) return tl::unexpected(material.error());
  Workshop workshop(*material, options);
  std::vector<Recogniser> made;
  for (const Method method : wanted) {
    auto recogniser = workshop.make(method);
    if (!recogniser) return tl::unexpected(recogniser.error());
    made.push_back(std::move(*recogniser));
    if (progress) progress(static_cast<double>(made.size()) / static_cast<double>(wanted.size()));
  }
  return made;
}

}  // namespace prehend::demonstration
