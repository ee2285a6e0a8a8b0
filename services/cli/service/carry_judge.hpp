#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/base/pose.hpp"
#include "common/base/time.hpp"

namespace prehend::cli {

/// What two hands do with an object: press it between them all the way, or take it with the left
/// one and hand it over to the right one.
enum class CarryTask { carry, hand_over };

/// What came of an object that two hands were to carry.
struct Carried {
  double lifted = 0;  // m, by which it rose at most
  double off = 0;     // m, horizontally, from where it was to be set down
  double tilt = 0;    // rad, at most, while it was off the table
  double both = 0;    // share of that time in which both hands touched it
  double held = 0;    // in which one did, or both
  /// The left hand alone held it at first, later the right hand alone for a second or more, in the
  /// air.
  bool handed_over = false;
  bool set_down = false;  // it stands again by itself
  bool fell = false;      // it lies

  /// Lifted by 10 cm, and set down 3 cm from its place or nearer, level within 10° in both hands,
  /// or handed over without falling from them.
  bool done(CarryTask task) const;
};

/// Watches an object from where it stands first until it has been lifted and stands again. The
/// hands are «left» and «right». Pure.
class CarryJudge {
 public:
  /// carry_W: m, from where it stands to where it is to stand.
  explicit CarryJudge(const Eigen::Vector3d& carry_W) : carry_W_(carry_W) {}

  /// A hand touches something or not.
  void feel(const std::string& hand, bool touches) { touches_[hand] = touches; }
  /// Where the object is at that time; later than before.
  void see(const Pose& X_WO, Time stamp);

  /// It stands again, or lies, and has for half a second by itself.
  bool is_over() const { return carried_.set_down || carried_.fell; }
  const Carried& carried() const { return carried_; }

 private:
  Eigen::Vector3d carry_W_;
  std::optional<Pose> X_WO_first_;
  std::map<std::string, bool> touches_;
  bool left_alone_ = false;
  Carried carried_;
  Time last_{}, left_since_{};                                   // alone, on the table
  double in_air_ = 0, by_both_ = 0, by_one_ = 0, by_right_ = 0;  // s
};

}  // namespace prehend::cli
