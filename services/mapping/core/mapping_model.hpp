#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/learning/network.hpp"
#include "common/learning/scaling.hpp"
#include "common/model/hand_model.hpp"
#include "common/model/shape.hpp"
#include "services/mapping/core/features.hpp"
#include "services/mapping/core/palm_offset.hpp"
#include "services/mapping/core/size_input.hpp"

namespace prehend::mapping {

/// Mean over pairs of the sum over DoF of squared differences, rad² [Thesis, eq. 5.1].
struct ModelErrors {
  double training = 0, validation = 0;
  double test = 0;  // takes of users that were in neither
};

/// One network with what belongs to it. Its input scaling is the range that was trained.
struct MappingNetwork {
  model::ShapeKind shape = model::ShapeKind::unknown;  // unknown: the direct mapping
  learning::Network network;
  learning::Scaling input, output;
  ModelErrors errors;
};

/// What belongs to all networks of a model.
struct ModelTraits {
  std::string scheme, training_set_digest;
  SizeInput size_input = SizeInput::characteristic;
  /// Of each DoF, rad or m: what the scheme keeps to within the hand's limits. Answers do, too.
  Eigen::VectorXd lower, upper;
  /// Tells precision grasps from circular sphere ones: a weight of each feature, 1/m, and an
  /// offset; their sum is positive for precision. Empty: not learnt.
  Eigen::VectorXd precision;
  std::vector<PalmOffset> places;  // where the hand stands to grasp what
  std::string made_for;            // digest of the user's hand; empty: not said
  /// How far a person has closed on an object, whatever robot hand answers: one output, 0 open to
  /// 1, at which the robot's fingers shall be past contact. Told of the object: SizeInput::seen.
  /// None: not learnt; planned grasps are then of no use.
  std::optional<MappingNetwork> closing;
};

/// How far a person has closed, 0 to 1, and whether that lay outside what was trained.
struct ClosingAnswer {
  double share = 0;
  bool extrapolating = false;
};

/// A robot posture, and whether the question lay outside what was trained.
struct NetworkAnswer {
  Eigen::VectorXd dof;  // rad or m
  bool extrapolating = false;
};

/// Trained networks for one hand: direct, from nine features, and intelligent, one a shape, from
/// the same and the object's size.
class MappingModel {
 public:
  /// From trained parts. Refuses a missing or doubled network, sizes that do not fit the hand, and
  /// limits that are not within its own.
  static Expected<MappingModel> create(const model::HandModel& hand, ModelTraits traits,
                                       std::vector<MappingNetwork> networks);

  const ModelTraits& traits() const { return traits_; }
  const std::vector<MappingNetwork>& networks() const { return networks_; }  // [0] is direct

  /// Inputs outside the trained range are taken as its nearest end, with a tenth of the range more
  /// at each side, and the answer says so. Sizes are not stretched: the nearest trained one counts.
  NetworkAnswer direct(const Features& features) const;
  /// X_OG: the grasp frame that the hand is at or reaches for, as model::nearest_grasp gives it.
  /// nullopt: no network knows this shape, nor what it is like.
  std::optional<NetworkAnswer> intelligent(const Features& features, const model::Shape& shape,
                                           const Pose& X_OG) const;
  /// The shape that a network of this model answers for: this one, or what it is like
  /// (model::like_known) if there is a network of that kind only.
  std::optional<model::Shape> known_as(const model::Shape& shape) const;
  /// The same inputs: how far the person has closed on it. nullopt: not learnt.
  std::optional<ClosingAnswer> closing(const Features& features, const model::Shape& shape,
                                       const Pose& X_OG) const;
  /// The nearest posture within the scheme's limits; answers are already.
  Eigen::VectorXd limited(const Eigen::VectorXd& dof) const;
  /// Whether these fingers, above an object, make a precision grasp rather than a circular sphere.
  /// Not learnt: whether the little finger stays out of it.
  bool is_precision(const Features& features) const;

 private:
  MappingModel() = default;
  /// nullptr: none.
  const MappingNetwork* find(model::ShapeKind shape) const;
  ModelTraits traits_;
  std::vector<MappingNetwork> networks_;
};

}  // namespace prehend::mapping
