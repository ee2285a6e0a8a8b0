#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/base/random.hpp"
#include "common/model/catalogue.hpp"
#include "common/model/human_hand.hpp"
#include "common/model/scene.hpp"
#include "services/demonstration/core/segmentation/phase.hpp"

namespace prehend::demonstration {

/// An object is taken and put somewhere.
struct Transfer {
  std::string object;
  Eigen::Vector3d to;  // of its centre in W, m
  double turn = 0;     // rad about the vertical, on the way
};

/// A person who does not exist shows a task: takes objects of a scene and puts them elsewhere, one
/// after the other. Hands move and fingers close by minimum jerk [Flash1985]. A value of time
/// alone; what sensors add to it (noise) is not here.
class Person {
 public:
  /// Fails on objects that are not in the scene or that no hand can grasp.
  static Expected<Person> create(const model::Scene& scene, const model::Catalogue& catalogue,
                                 const std::vector<Transfer>& transfers, std::uint64_t seed);

  struct HandThen {
    Pose X_WH = Pose::Identity();
    std::array<double, model::finger_count> closure{};  // for HumanHand::posture
  };
  struct ObjectThen {
    std::string name;
    model::Shape shape;
    Pose X_WO = Pose::Identity();
    bool hidden = false;  // in the hand
  };
  /// What truly was: a phase begins with the movement that makes it.
  struct Truth {
    Phase phase{};
    double begin = 0, end = 0;  // s
    std::string object;         // of close, hold and release
  };

  HandThen hand(double t) const;
  std::vector<ObjectThen> objects(double t) const;
  const std::vector<Truth>& truth() const { return truth_; }
  double duration() const { return truth_.back().end; }  // s
  const model::HumanHand& model() const { return hand_; }

 private:
  /// A movement along a line with corners.
  struct Move {
    double begin = 0, end = 0;
    std::vector<Pose> way;
  };
  /// Fingers go from one posture to another.
  struct Squeeze {
    double begin = 0, end = 0;
    std::array<double, model::finger_count> from{}, to{};
  };
  struct Carry {
    double begin = 0, end = 0;  // s: in the hand
    std::size_t object = 0;
    Pose X_HO = Pose::Identity();
  };
  struct Thing {
    std::string name;
    model::Shape shape;
    Pose X_WO = Pose::Identity();  // at first
  };

  explicit Person(const model::Scene& scene);
  Expected<void> take(const Transfer& transfer, Random& random);
  void pass(Phase phase, double duration, const std::string& object = {});

  model::Demonstrator demonstrator_;
  model::HumanHand hand_;
  std::vector<Thing> things_;
  std::vector<Move> moves_;
  std::vector<Squeeze> squeezes_;
  std::vector<Carry> carries_;
  std::vector<Truth> truth_;
  Pose X_WH_rest_ = Pose::Identity();
  double now_ = 0;
};

}  // namespace prehend::demonstration
