#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/model/grasp_taxonomy.hpp"
#include "services/demonstration/core/observation/seen.hpp"
#include "services/demonstration/core/recognition/object_likelihood.hpp"
#include "services/demonstration/core/recognition/recogniser.hpp"

namespace prehend::demonstration {

/// How fast a hand goes from place to place, whatever the noise of its single places.
class PalmSpeed {
 public:
  double add(Time stamp, const Eigen::Vector3d& p_WH);  // m/s

 private:
  bool seen_ = false;
  Time stamp_{};
  Eigen::Vector3d p_WH_ = Eigen::Vector3d::Zero(), v_WH_ = Eigen::Vector3d::Zero();
};

/// Which kind of grasp a hand makes: P(kind | hand) as far as somebody trained a recogniser, times
/// P(kind | object), by the object's shape and size, as it was learnt with the recogniser or else
/// as the taxonomy says, times P(kind | task). Without a recogniser the hand tells no more than
/// from where the palm comes. A hand that is faster than 0.2 m/s is on its way to its next grasp:
/// what was seen before does not count any more. Keeps references to all three.
class GraspJudge {
 public:
  /// recogniser, objects (of the recogniser's classes): may be nullptr.
  GraspJudge(const model::GraspTaxonomy& taxonomy, const Recogniser* recogniser,
             const ObjectLikelihood* objects = nullptr);

  const std::vector<std::string>& kinds() const { return kinds_; }
  /// A hand comes to an object; nothing that was seen before counts any more.
  void begin();
  /// What the task says of the kinds, a number from 0 up for each; empty: nothing.
  void expect(Eigen::VectorXd prior_of_task) { prior_of_task_ = std::move(prior_of_task); }
  /// After all hands since begin(). object: nullptr if the hand is at none.
  Distribution see(const SeenHand& hand, const SeenObject* object);

 private:
  Eigen::VectorXd prior(const SeenObject* object) const;
  Distribution by_approach(const SeenHand& hand) const;

  const model::GraspTaxonomy& taxonomy_;
  const Recogniser* recogniser_;
  const ObjectLikelihood* objects_;
  Eigen::VectorXd prior_of_task_;
  std::vector<std::string> kinds_;
  std::vector<std::optional<std::size_t>> classes_;  // of the taxonomy: which one each kind is
  std::optional<RecogniserStream> stream_;
  std::optional<SeenHand> first_, last_;
  PalmSpeed speed_;
};

/// What a recogniser looks at. before: the hand a moment ago, for speeds; nullptr if there was
/// none.
HandSample sample_of(const SeenHand& hand, const SeenHand* before, Time begin);

}  // namespace prehend::demonstration
