#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/learning/scaling.hpp"
#include "common/learning/training.hpp"
#include "common/learning/training_set.hpp"
#include "common/model/catalogue.hpp"
#include "common/model/hand_model.hpp"
#include "services/mapping/core/mapping_model.hpp"
#include "services/mapping/tools/training/demonstrator.hpp"
#include "services/mapping/tools/training/robot_grasps.hpp"
#include "services/mapping/tools/training/scheme.hpp"

namespace prehend::mapping {

/// Told which step is being done and how much of it, 0 to 1; one call at a time.
using Progress = std::function<void(std::string_view step, double share)>;

struct SetOptions {
  int users = 60;  // of synthetic people
  /// Each shows so many grasps in a take, drawn anew; all where there are fewer. A network learns
  /// more of many people who show a little than of a few who show everything.
  int grasps = 8;
  int takes = 1;       // each puts the glove on so often
  int postures = 7;    // basic ones: 4, 7, 10 or 13 (see Scheme::posture_set)
  int beside = 1;      // basic postures that are shown with each grasp, drawn anew
  int on_the_way = 1;  // pairs between the open hand and each posture shown
  /// Share of a person's closing on an object at which the robot hand is closed. Takes differ in
  /// how far the fingers bend around the same object; the robot must grip in all of them.
  double complete = 0.7;
  std::uint64_t seed = 1;  // people with another seed are other people
  /// rad, past the contact posture, that a grasp is trained to: the squeeze, and as much again so
  /// that an imprecise network still reaches the object.
  double past_contact = 0.30;
  DemonstratorOptions demonstrator;  // how people and their sensors differ
};

/// What synthetic people show: in each take some grasps, and with each some of the scheme's
/// postures (which have nothing to do with the object, but its network must know them); of a hand
/// that grasps nothing all postures. Between the
/// open hand (the scheme's first posture) and each of them lie pairs in proportion: a network that
/// knows the ends alone jumps somewhere between them.
learning::TrainingSet demonstrate(const model::HandModel& hand, const Scheme& scheme,
                                  const std::vector<RobotGrasp>& grasps, const SetOptions& options);

/// Weights of the features and an offset that tell people's precision grasps (positive) from their
/// circular sphere ones best in the sense of least squares (Fisher's discriminant, both classes
/// counting alike). People of `options` grasp every object from above, whatever the robot can do;
/// empty if nobody could both ways.
Eigen::VectorXd precision_discriminant(const model::Catalogue& catalogue, const model::Reach& reach,
                                       const SetOptions& options);

/// Where the hand stood in each grasp that held.
std::vector<PalmOffset> palm_offsets(const std::vector<RobotGrasp>& grasps);

struct TrainerOptions {
  /// Of each network.
  learning::TrainingOptions network{
      .hidden = 16, .epochs = 1200, .patience = 150, .restarts = 3, .heat = 150};
  SizeInput size_input = SizeInput::seen;  // what intelligent networks are told of the object
  learning::ScalingKind scaling = learning::ScalingKind::each_feature;  // of the inputs
  Eigen::VectorXd precision;                                            // see ModelTraits
  std::vector<PalmOffset> places;                                       // see palm_offsets()
  std::string made_for;                                                 // see ModelTraits
  std::optional<MappingNetwork> closing;                                // see ModelTraits
};

/// A set for each purpose; their users are disjoint.
struct Sets {
  learning::TrainingSet training, validation, test;
};

/// Trains direct mapping on all pairs without shape and size, and intelligent mapping for each
/// shape among them on that shape's pairs with its size. The networks are the pieces of work that
/// `for_each` divides; the model is the same however it does.
Expected<MappingModel> train_mapping(const model::HandModel& hand, const Scheme& scheme,
                                     const Sets& sets, const TrainerOptions& options,
                                     const grasping::ForEach& for_each, const Progress& progress);

/// Error of a model on the pairs of one shape [Thesis, eq. 5.1], rad²: of its direct and of its
/// intelligent answers. Grasps only, or postures as well.
struct Comparison {
  double direct = 0, intelligent = 0;
  int pairs = 0;
};
Comparison compare(const MappingModel& model, const learning::TrainingSet& set,
                   model::ShapeKind shape, bool grasps_only);

}  // namespace prehend::mapping
