#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/grasping/catalogue_bodies.hpp"
#include "common/grasping/planner.hpp"
#include "common/model/hand_model.hpp"
#include "services/mapping/core/grasp_type.hpp"
#include "services/mapping/tools/training/scheme.hpp"

namespace prehend::mapping {

/// A robot hand closed on an object.
struct RobotGrasp {
  std::string object;
  GraspType type = GraspType::none;
  model::Shape shape;
  Pose X_OG = Pose::Identity();                    // grasp frame that was asked for
  Eigen::Vector3d p_GR = Eigen::Vector3d::Zero();  // m: where the hand's own stood in it
  Eigen::VectorXd preshape;                        // DoF values before closing, rad or m
  Eigen::VectorXd dof;                             // where the fingers were stopped
  Eigen::VectorXd closing;  // of each DoF: +1, -1, which way it closed, 0 if it rested
  double epsilon = -1;
  bool held = false;  // standing on the table, then lifted and shaken

  Pose X_OR() const { return X_OG * Eigen::Translation3d(p_GR); }
};

/// As model::past_contact, from this open hand.
Eigen::VectorXd past_contact(const model::HandModel& hand, const RobotGrasp& grasp,
                             const Eigen::VectorXd& open, double angle);

/// The types that a hand makes from there: power wrap from the side; circular sphere, with all
/// fingers, and precision, with the fingertips of some, from above.
std::vector<GraspType> types_from(const Pose& X_OG);

/// Where a hand is tried beside the grasp frame asked for, m, in it: less than a placement may be
/// corrected.
std::vector<Eigen::Vector3d> places_to_try();

/// How thoroughly a hand is tried on an object.
struct Trials {
  std::vector<Eigen::Vector3d> places = places_to_try();
  double hold = 3;        // s, that a grasp is held up where it was asked for
  bool shake = true;      // it is also shaken
  bool beside = true;     // it also holds 8 mm to either side
  bool each_type = true;  // what was not held in one way of closing is tried everywhere in the next
  /// Takes a fraction of the time: for a first use, which somebody waits for.
  static Trials quick();
};

/// Closes the hand in Bullet on the object where it stands, with every preshape of the scheme for
/// this type, from the first of the places where a grasp is found that, closed on the table as
/// the mapping closes it, neither shoves nor topples the object and holds when it is lifted and
/// shaken, and also 8 mm to either side; of several the one with the greatest epsilon. If there is
/// none, the one that survives in most of these. Fails when the fingers find no two contacts from
/// anywhere without reaching into the table.
Expected<RobotGrasp> robot_grasp(const model::HandModel& hand, const Scheme& scheme,
                                 const grasping::Body& object, const Pose& X_OG, GraspType type,
                                 const Trials& trials = {});

/// The same on every object of the catalogue, from every approach, with every type. What the hand
/// cannot grasp is left out, and `report` is told why. The same however the work is divided.
std::vector<RobotGrasp> close_on_catalogue(const model::HandModel& hand, const Scheme& scheme,
                                           const grasping::CatalogueBodies& catalogue,
                                           const grasping::ForEach& for_each,
                                           const std::function<void(const Error&)>& report,
                                           const Trials& trials = {});

/// As bytes within a file. Decoding refuses what was made for another hand, or, where both sides
/// say for which (ModelPlaces::made_for), for this hand as it was before.
std::string encode_robot_grasps(const model::HandModel& hand, const std::vector<RobotGrasp>& grasps,
                                const std::string& made_for = {});
Expected<std::vector<RobotGrasp>> decode_robot_grasps(const std::string& bytes,
                                                      const model::HandModel& hand,
                                                      const std::string& made_for = {});
/// As a sealed file of kind «robot-grasps», so that nobody needs to close the hand again. Loading
/// refuses what is damaged or was made for another hand.
Expected<void> save_robot_grasps(const std::filesystem::path& file, const model::HandModel& hand,
                                 const std::vector<RobotGrasp>& grasps,
                                 const std::string& made_for = {});
Expected<std::vector<RobotGrasp>> load_robot_grasps(const std::filesystem::path& file,
                                                    const model::HandModel& hand,
                                                    const std::string& made_for = {});

}  // namespace prehend::mapping
