#include "services/demonstration/tools/training/trainer.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "services/demonstration/tools/training/material.hpp"

namespace prehend::demonstration {

namespace {

/// Of a classifier in an answer, beside the first.
constexpr std::array share_steps{0.0, 0.1, 0.2, 0.4, 0.7, 1.0, 1.5};
constexpr double no_better = 1e-6;

constexpr std::array all_inputs{Inputs::both, Inputs::posture, Inputs::motion};

/// Trains what methods share once.
class Workshop {
 public:
  Workshop(const Material& material, const TrainerOptions& options)
      : material_(material), options_(options) {}

  Expected<Recogniser> make(Method method) {
    std::vector<Expected<const Trained*>> parts;
    if (method == Method::posture) parts.push_back(networks(Inputs::posture));
    if (method == Method::trajectory) parts.push_back(networks(Inputs::motion));
    if (method == Method::hybrid)
      for (const Inputs inputs : all_inputs) parts.push_back(networks(inputs));
    if (method == Method::hybrid || method == Method::hmm)
      for (const Inputs inputs : all_inputs) parts.push_back(hmms(inputs));
    std::vector<const Trained*> trained;
    for (const auto& part : parts) {
      if (!part) return tl::unexpected(part.error());
      trained.push_back(*part);
    }
    return together(method, trained);
  }

 private:
  using Kept = std::map<Inputs, Trained>;

  static Expected<const Trained*> kept(Kept& all, Inputs inputs, const auto& train) {
    if (const auto found = all.find(inputs); found != all.end()) return &found->second;
    auto trained = train();
    if (!trained) return tl::unexpected(trained.error());
    return &all.emplace(inputs, std::move(*trained)).first->second;
  }
  Expected<const Trained*> networks(Inputs inputs) {
    return kept(networks_, inputs, [&] { return train_networks(material_, inputs, options_); });
  }
  Expected<const Trained*> hmms(Inputs inputs) {
    return kept(hmms_, inputs, [&] { return train_hmms(material_, inputs); });
  }

  /// Each counts as much as makes left-out people's takes most likely.
  Expected<Recogniser> together(Method method, const std::vector<const Trained*>& trained) const {
    const std::vector<double> shares = shares_of(trained);
    std::vector<Part> parts;
    for (std::size_t i = 0; i < trained.size(); ++i)
      if (shares[i] > 0) parts.push_back({shares[i], trained[i]->classifier});
    return Recogniser::create(method, material_.classes, std::move(parts),
                              calibrated_temperature(scores(trained, shares), material_.truths));
  }

  static Eigen::MatrixXd scores(const std::vector<const Trained*>& trained,
                                const std::vector<double>& shares) {
    Eigen::MatrixXd made = shares[0] * trained[0]->unseen_scores;
    for (std::size_t i = 1; i < trained.size(); ++i) made += shares[i] * trained[i]->unseen_scores;
    return made;
  }

  /// The first counts 1; the others' shares are tried one after the other until none gets better.
  std::vector<double> shares_of(const std::vector<const Trained*>& trained) const {
    std::vector<double> shares(trained.size(), 0.0);
    shares[0] = 1;
    double least = best_loss(scores(trained, shares), material_.truths);
    for (bool better = true; better;) {
      better = false;
      for (std::size_t i = 1; i < trained.size(); ++i) {
        double best = shares[i];
        for (const double share : share_steps) {
          shares[i] = share;
          const double now = best_loss(scores(trained, shares), material_.truths);
          if (now >= least - no_better) continue;
          least = now;
          best = share;
          better = true;
        }
        shares[i] = best;
      }
    }
    return shares;
  }

  const Material& material_;
  const TrainerOptions& options_;
  Kept networks_, hmms_;
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
