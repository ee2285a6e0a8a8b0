#include "services/planner/tools/hand_import/anatomy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "services/planner/tools/hand_import/hand_toml.hpp"
#include "services/planner/tools/hand_import/opposition.hpp"
#include "services/planner/tools/hand_import/overlap.hpp"

namespace prehend::planner {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using model::HandModel;

constexpr double parallel = 0.8;     // cosine: axes that turn the same way
constexpr double same_reach = 0.8;   // share of the farthest leaf of the same DoFs
constexpr double tip_slice = 0.002;  // m: the end of a link, whose middle is the tip
constexpr double min_tip = 0.005;
constexpr double fist = 2.6;  // rad, the most that a joint bends

/// A hand.toml that only lets the URDF be loaded: a DoF a leading joint, fingertips wherever.
std::string provisional_toml(const Robot& robot, const std::vector<std::string>& leaders) {
  std::string text =
      "name = \"hand\"\n[grasp_frame]\nposition = [0, 0, 0]\n"
      "orientation = [1, 0, 0, 0]\n[materials]\ndefault = \"rubber\"\n";
  std::string open;
  for (const std::string& joint : leaders) {
    text += fmt::format("[[dof]]\nname = {0}\njoint = {0}\n", toml_text(joint));
    const JointLimit& limit = *robot.find_joint(joint)->limit;
    open += fmt::format("{}{:.17g}", open.empty() ? "" : ", ",
                        std::clamp(0.0, limit.lower, limit.upper));
  }
  return text + fmt::format(
                    "[[fingertip]]\nname = \"tip\"\nlink = {}\nposition = [0, 0, 0]\n"
                    "[postures]\nopen = [{}]\n",
                    toml_text(robot.links[0].name), open);
}

/// Points on all shapes of a link, in its frame; its origin if it has none.
std::vector<Vector3d> points_of(const model::HandLink& link) {
  std::vector<Vector3d> points;
  for (const model::CollisionShape& part : link.collision)
    for (const Vector3d& p_S : surface_points(part.shape)) points.push_back(part.X_LS * p_S);
  if (points.empty()) points.push_back(Vector3d::Zero());
  return points;
}

Vector3d middle_of(const std::vector<Vector3d>& points) {
  Vector3d low = points[0], high = points[0];
  for (const Vector3d& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return 0.5 * (low + high);
}

struct Finger {
  int leaf = 0;             // link
  std::vector<int> joints;  // from the palm to the leaf
  std::set<int> dofs;
  Vector3d p_LT = Vector3d::Zero();
  double reach = 0;  // m, of the tip from the first joint, at rest
};

class Finder {
 public:
  Finder(const Robot& robot, const HandModel& hand, const SearchEffort& effort,
         const AnatomyJudge& judge)
      : robot_(robot),
        hand_(hand),
        effort_(effort),
        judge_(judge),
        rest_(hand.postures().at("open")) {
    find_palm();
  }

  Expected<Anatomy> run() {
    find_fingers();
    if (fingers_.empty() || fingers_.size() > 32)
      return fail("no fingertips found", "robot " + robot_.name,
                  "a finger is a chain of moving links that ends somewhere");
    for (int dof = 0; dof < rest_.size(); ++dof) find_closing(dof);
    agree_within_fingers();
    name_fingers();
    find_grasp_frame();
    search_opposition();
    return std::move(found_);
  }

 private:
  const model::HandJoint& joint(int i) const { return hand_.joints()[at(i)]; }

  std::vector<Pose> poses(const VectorXd& dof) const {
    return hand_.link_poses(hand_.joint_angles(dof));
  }
  std::vector<Vector3d> tips(const VectorXd& dof) const {
    const auto X_BL = poses(dof);
    std::vector<Vector3d> p_BT;
    for (const Finger& finger : fingers_) p_BT.push_back(X_BL[at(finger.leaf)] * finger.p_LT);
    return p_BT;
  }

  /// The link on which the hand branches, and the joints before it: a wrist.
  void find_palm() {
    while (true) {
      std::vector<int> next;
      for (int i = 0; i < static_cast<int>(hand_.joints().size()); ++i)
        if (joint(i).parent == palm_) next.push_back(i);
      if (next.size() != 1) break;
      wrist_.push_back(next[0]);
      palm_ = joint(next[0]).child;
    }
    // A single chain is a finger, not a wrist.
    if (std::none_of(hand_.joints().begin(), hand_.joints().end(),
                     [&](const auto& j) { return j.parent == palm_; })) {
      palm_ = 0;
      wrist_.clear();
    }
    p_BP_ = poses(rest_)[at(palm_)] * middle_of(points_of(hand_.links()[at(palm_)]));
  }

  std::vector<Vector3d> palm_points() const {
    std::vector<Vector3d> points = points_of(hand_.links()[at(palm_)]);
    const Pose X_BP = poses(rest_)[at(palm_)];
    for (Vector3d& p : points) p = X_BP * p;
    return points;
  }

  bool is_wrist(int dof) const {
    bool moves_palm = false, moves_more = false;
    for (int i = 0; i < static_cast<int>(hand_.joints().size()); ++i) {
      if (joint(i).dof != dof) continue;
      const bool before = std::find(wrist_.begin(), wrist_.end(), i) != wrist_.end();
      (before ? moves_palm : moves_more) = true;
    }
    return moves_palm && !moves_more;
  }

  void find_fingers() {
    std::vector<bool> carries(hand_.links().size(), false);
    for (const auto& j : hand_.joints()) carries[at(j.parent)] = true;
    for (int link = 1; link < static_cast<int>(carries.size()); ++link) {
      if (carries[at(link)]) continue;
      Finger finger;
      finger.leaf = link;
      for (int l = link; l != palm_ && l > 0; l = joint(hand_.links()[at(l)].joint).parent) {
        finger.joints.insert(finger.joints.begin(), hand_.links()[at(l)].joint);
        finger.dofs.insert(joint(finger.joints.front()).dof);
      }
      if (finger.joints.empty()) continue;
      finger.p_LT = end_of(finger);
      const auto X_BL = poses(rest_);
      const model::HandJoint& first = joint(finger.joints.front());
      finger.reach = (X_BL[at(link)] * finger.p_LT - X_BL[at(first.child)].translation()).norm() +
                     (first.kind == model::JointKind::prismatic ? 1.0 : 0.0);
      fingers_.push_back(finger);
    }
    std::map<std::set<int>, double> farthest;
    for (const Finger& f : fingers_) farthest[f.dofs] = std::max(farthest[f.dofs], f.reach);
    std::erase_if(fingers_,
                  [&](const Finger& f) { return f.reach < same_reach * farthest[f.dofs]; });
  }

  /// The end of the last link: from its joint towards the middle of its shapes, and for a sliding
  /// link across the slide.
  Vector3d end_of(const Finger& finger) const {
    const auto points = points_of(hand_.links()[at(finger.leaf)]);
    const model::HandJoint& last = joint(finger.joints.back());
    Vector3d bone = middle_of(points);
    if (last.kind == model::JointKind::prismatic) {
      bone -= bone.dot(last.axis_J) * last.axis_J;
      // The finger may start beside the palm: it points away from it all the same.
      const Vector3d p_LP = poses(rest_)[at(finger.leaf)].inverse() * p_BP_;
      Vector3d away = middle_of(points) - p_LP;
      away -= away.dot(last.axis_J) * last.axis_J;
      if (away.norm() > min_tip) bone = away;
    } else if (bone.norm() < min_tip && finger.joints.size() > 1) {
      bone = last.X_PJ.linear().transpose() * last.X_PJ.translation();
    }
    if (bone.norm() < 1e-9) return middle_of(points);
    bone.normalize();
    double extent = -1e9;
    for (const Vector3d& p : points) extent = std::max(extent, bone.dot(p));
    std::vector<Vector3d> end;
    for (const Vector3d& p : points)
      if (bone.dot(p) > extent - tip_slice) end.push_back(p);
    const Vector3d tip = middle_of(end);
    return tip + (extent - bone.dot(tip)) * bone;
  }

  /// Axis of a joint at rest, in B, so that a growing DoF turns about it by the right hand.
  Vector3d axis(int i) const {
    const model::HandJoint& j = joint(i);
    return (j.multiplier < 0 ? -1.0 : 1.0) * (poses(rest_)[at(j.child)].linear() * j.axis_J);
  }

  /// A DoF flexes a finger if a joint of it turns about the axis of the last turning joint that
  /// another or the same DoF drives; a single DoF always does.
  bool flexes(const Finger& finger, int dof) const {
    if (finger.dofs.size() == 1) return true;
    int last = -1;
    for (const int i : finger.joints)
      if (joint(i).kind == model::JointKind::revolute) last = i;
    int like = 0, unlike = 0;
    for (const int i : finger.joints) {
      if (joint(i).dof != dof) continue;
      const bool turns = joint(i).kind == model::JointKind::revolute;
      const bool along = !turns || (last >= 0 && std::abs(axis(i).dot(axis(last))) > parallel);
      ++(along ? like : unlike);
    }
    return like > unlike;
  }

  void find_closing(int dof) {
    const model::HandDof& limits = hand_.dofs()[at(dof)];
    const bool slides = limits.kind == model::JointKind::prismatic;
    if (is_wrist(dof)) {
      found_.dofs.push_back({joint(limits.joint).name, 0, rest_[dof], rest_[dof], true});
      return;
    }
    VectorXd low = rest_, high = rest_;
    const double quarter = slides ? 1e9 : 0.5 * std::numbers::pi;  // beyond, tips come round again
    low[dof] = std::max(limits.lower, rest_[dof] - quarter);
    high[dof] = std::min(limits.upper, rest_[dof] + quarter);
    const auto at_low = tips(low), at_high = tips(high), at_rest = tips(rest_);
    double towards_high = 0;  // m, by which closing to the upper limit brings the tips nearer
    double travel = 0, tie = 0;
    for (std::size_t i = 0; i < fingers_.size(); ++i) {
      if (!fingers_[i].dofs.contains(dof) || !flexes(fingers_[i], dof)) continue;
      Vector3d others_low = Vector3d::Zero(), others_high = others_low;
      for (std::size_t k = 0; k < fingers_.size(); ++k)
        if (k != i) {
          others_low += at_low[k] / static_cast<double>(fingers_.size() - 1);
          others_high += at_high[k] / static_cast<double>(fingers_.size() - 1);
        }
      if (fingers_.size() == 1) others_low = others_high = p_BP_;
      const double gap = (at_low[i] - others_low).norm() - (at_high[i] - others_high).norm();
      const double palm = (at_low[i] - p_BP_).norm() - (at_high[i] - p_BP_).norm();
      towards_high += slides ? gap : palm;
      tie += gap;
      travel += std::max((at_low[i] - at_rest[i]).norm(), (at_high[i] - at_rest[i]).norm());
    }
    Anatomy::Dof result;
    result.joint = joint(limits.joint).name;
    if (travel > 0) {
      // Bent equally far either way: the side of the other tips.
      if (std::abs(towards_high) < 0.02 * travel) towards_high = tie;
      const bool matters = !slides || std::abs(towards_high) > 0.3 * travel;
      if (matters && towards_high != 0) result.closing = towards_high > 0 ? 1 : -1;
    }
    result.open = rest_[dof];
    result.fist = rest_[dof];
    if (result.closing != 0) {
      const double closed = result.closing > 0 ? limits.upper : limits.lower;
      const double opened = result.closing > 0 ? limits.lower : limits.upper;
      // A hand that rests closed, as grippers do, is opened.
      if (std::abs(closed - rest_[dof]) < 0.5 * (limits.upper - limits.lower)) result.open = opened;
      result.fist = slides ? closed : std::clamp(closed, rest_[dof] - fist, rest_[dof] + fist);
    }
    found_.dofs.push_back(result);
  }

  /// Joints of a finger that turn about the same axis close in the same sense as the last, whose
  /// range tells most; that of one that bends equally far either way tells nothing.
  void agree_within_fingers() {
    for (const Finger& finger : fingers_) {
      const int last = finger.joints.back();
      if (joint(last).kind != model::JointKind::revolute) continue;
      const int sense = found_.dofs[at(joint(last).dof)].closing;
      for (const int i : finger.joints) {
        Anatomy::Dof& d = found_.dofs[at(joint(i).dof)];
        const model::HandDof& limits = hand_.dofs()[at(joint(i).dof)];
        const double rest = rest_[joint(i).dof];
        const double below = rest - limits.lower, above = limits.upper - rest;
        const bool either_way = std::min(below, above) > 0.5 * std::max(below, above);
        const double along = axis(i).dot(axis(last));
        if (sense == 0 || d.closing == 0 || !either_way || std::abs(along) < parallel) continue;
        const int wanted = along > 0 ? sense : -sense;
        if (d.closing == wanted) continue;
        d.closing = wanted;
        d.open = rest;
        const double closed = wanted > 0 ? limits.upper : limits.lower;
        d.fist = std::clamp(closed, rest - fist, rest + fist);
      }
    }
  }

  void name_fingers() {
    for (const Finger& finger : fingers_) {
      const std::string& link = hand_.links()[at(finger.leaf)].name;
      found_.fingertips.push_back({link, link, finger.p_LT});
    }
  }

  VectorXd closed_by(double share) const {
    VectorXd dof = rest_;
    for (Eigen::Index i = 0; i < dof.size(); ++i) {
      const Anatomy::Dof& d = found_.dofs[static_cast<std::size_t>(i)];
      dof[i] = d.open + share * (d.fist - d.open);
    }
    return dof;
  }

  /// The finger that the others oppose: whose motion while closing goes most against theirs; of
  /// two, the second.
  std::size_t find_thumb(const std::vector<Vector3d>& motion,
                         const std::vector<Vector3d>& place) const {
    const std::size_t n = fingers_.size();
    std::size_t thumb = n - 1;
    if (n < 3) return thumb;
    double best = 1e9;
    for (std::size_t i = 0; i < n; ++i) {
      Vector3d others = Vector3d::Zero(), middle = Vector3d::Zero();
      for (std::size_t k = 0; k < n; ++k)
        if (k != i) {
          others += motion[k];
          middle += place[k] / static_cast<double>(n - 1);
        }
      // Of equal opposition (fingers around a circle), the one that stands alone.
      const double alone = (place[i] - middle).norm();
      const double score = motion[i].normalized().dot(others.normalized()) - 5 * alone;
      if (score < best) {
        best = score;
        thumb = i;
      }
    }
    return thumb;
  }

  /// The middle of all tips but the thumb's; of a single finger it is the palm's.
  Vector3d middle_of_others(const std::vector<Vector3d>& tips, std::size_t thumb) const {
    const std::size_t n = tips.size();
    Vector3d others = n == 1 ? p_BP_ : Vector3d(Vector3d::Zero());
    for (std::size_t k = 0; k < n; ++k)
      if (k != thumb) others += tips[k] / static_cast<double>(n - 1);
    return others;
  }

  /// Thumb and fingers about to meet.
  struct Meeting {
    Vector3d middle = Vector3d::Zero();    // between them
    Vector3d closing = Vector3d::UnitY();  // from thumb to fingers
    double share = 0;                      // of closing, at which they are there
    double widest = 0;                     // m, between them before
  };

  /// Where they have come as near as 5 cm, or as near as they do.
  Meeting find_meeting(std::size_t thumb) const {
    constexpr double wanted = 0.05;
    Meeting meeting;
    double nearest = 1e9;
    for (int i = 0; i <= 40 && nearest > wanted; ++i) {
      const std::vector<Vector3d> now = tips(closed_by(i / 40.0));
      const Vector3d p = now[thumb], others = middle_of_others(now, thumb);
      const double gap = (others - p).norm();
      meeting.widest = std::max(meeting.widest, gap);
      if (gap < 0.005 || gap > nearest) continue;
      nearest = gap;
      meeting.middle = 0.5 * (others + p);
      meeting.closing = (others - p).normalized();
      meeting.share = i / 40.0;
    }
    return meeting;
  }

  /// Of the grasp frame; at right angles.
  struct Directions {
    Vector3d closing, approach;
  };

  /// Out of the palm is where the tips go when they begin to close. Where the thumb moves against
  /// the fingers, what brings them together cancels out; beside fingers that it does not move
  /// against, as in a human hand, it does not count. Jaws that slide point out of the palm.
  Directions find_directions(std::size_t thumb, const Meeting& meeting) const {
    const auto open = tips(closed_by(0)), begun = tips(closed_by(0.1));
    const auto direction = [&](std::size_t i) {
      return Vector3d((begun[i] - open[i]).normalized());
    };
    Vector3d fingers = Vector3d::Zero();
    for (std::size_t i = 0; i < fingers_.size(); ++i)
      if (i != thumb) fingers += direction(i);
    fingers.normalize();
    const bool like_human = fingers_.size() >= 4 && direction(thumb).dot(fingers) > -0.6;
    Vector3d approach = like_human ? fingers : Vector3d(fingers + direction(thumb));
    if (approach.norm() < 0.2) approach = meeting.middle - p_BP_;
    const auto across = [](const Vector3d& v, const Vector3d& unit) {
      const Vector3d rest = v - v.dot(unit) * unit;
      return Vector3d(rest.norm() > 1e-3 * v.norm() ? rest : unit.unitOrthogonal()).normalized();
    };
    if (!like_human) return {meeting.closing, across(approach, meeting.closing)};
    approach.normalize();
    return {across(meeting.closing, approach), approach};
  }

  /// The grasp frame a little nearer to the palm than where the tips meet, and what fits between.
  void place_grasp_frame(const Meeting& meeting, const Directions& directions) {
    const Vector3d &closing = directions.closing, &approach = directions.approach;
    double surface = -1e9, width = 0.02;
    const Vector3d side = closing.cross(approach);
    for (const Vector3d& p : palm_points()) {
      surface = std::max(surface, approach.dot(p));
      width = std::max(width, std::abs(side.dot(p - meeting.middle)));
    }
    // How far the palm's surface is away below the tips' meeting point.
    const double depth = std::clamp(approach.dot(meeting.middle) - surface, 0.02, 0.2);
    const Vector3d origin = meeting.middle - 0.25 * depth * approach;
    found_.X_BG = make_pose(origin, model::grasp_axes(approach, closing));
    double below = 0.01;
    for (double share = meeting.share; share <= 1; share += 0.1)
      for (const Vector3d& tip : tips(closed_by(share)))
        below = std::max(below, approach.dot(tip - origin));
    model::Reach& reach = found_.reach;
    reach.opening = std::clamp(std::min(0.9 * meeting.widest, 1.6 * depth), 0.01, 0.25);
    reach.engage = std::clamp(0.5 * depth, 0.01, 0.06);
    reach.clearance = below + 0.01;
    reach.half_width = std::min(width, 0.15) + 0.01;
  }

  void find_grasp_frame() {
    const auto open = tips(closed_by(0)), half = tips(closed_by(0.5));
    std::vector<Vector3d> motion;
    for (std::size_t i = 0; i < open.size(); ++i) motion.push_back(half[i] - open[i]);
    const std::size_t thumb = find_thumb(motion, open);
    const Meeting meeting = find_meeting(thumb);
    found_.opposed = meeting.widest > 0.01 && fingers_.size() > 1;
    place_grasp_frame(meeting, find_directions(thumb, meeting));
  }

  /// What the fingers can really hold, and from which posture.
  void search_opposition() {
    std::vector<int> closing;
    Fingers known;
    known.open = known.fist = rest_;
    for (std::size_t i = 0; i < found_.dofs.size(); ++i) {
      closing.push_back(found_.dofs[i].closing);
      known.fixed.push_back(found_.dofs[i].wrist);
      known.open[static_cast<Eigen::Index>(i)] = found_.dofs[i].open;
      known.fist[static_cast<Eigen::Index>(i)] = found_.dofs[i].fist;
    }
    for (const Finger& finger : fingers_) {
      known.last.push_back(finger.leaf);
      known.p_LT.push_back(finger.p_LT);
    }
    const ContactWorld world(hand_, closing, known.last);
    const Anatomy before = found_;
    const auto judge = [&](const Opposition& opposition, double needed) {
      found_ = before;
      take(opposition);
      return judge_(found_, needed);
    };
    const Opposition best = find_opposition(world, known, found_.X_BG, effort_,
                                            judge_ ? OppositionJudge(judge) : OppositionJudge());
    found_ = before;
    take(best);
  }

  /// What was found is said of the hand.
  void take(const Opposition& best) {
    if (best.opening < 0.01) return;
    found_.X_BG = best.X_BG;
    found_.reach.opening = best.opening;
    found_.reach.engage = std::clamp(best.depth - 0.004, 0.005, 0.05);
    found_.preshapes = best.preshapes;
    if (best.alone >= 0)
      for (const int i : fingers_[at(best.alone)].joints)
        found_.thumb_joints.push_back(joint(i).name);
    for (std::size_t i = 0; i < found_.dofs.size(); ++i)
      found_.dofs[i].open = best.open[static_cast<Eigen::Index>(i)];
    find_clearance();
  }

  /// How far tips and palm reach beyond the origin of G.
  void find_clearance() {
    const Vector3d p = found_.X_BG.translation(), out = found_.X_BG.linear().col(2),
                   side = found_.X_BG.linear().col(0);
    double below = 0.01, width = 0.02;
    for (double share = 0; share <= 1; share += 0.1)
      for (const Vector3d& tip : tips(closed_by(share))) below = std::max(below, out.dot(tip - p));
    for (const Vector3d& on_palm : palm_points())
      width = std::max(width, std::abs(side.dot(on_palm - p)));
    found_.reach.clearance = below + 0.01;
    found_.reach.half_width = std::min(width, 0.15) + 0.01;
  }

  const Robot& robot_;
  const HandModel& hand_;
  const SearchEffort effort_;
  const AnatomyJudge& judge_;
  VectorXd rest_;
  int palm_ = 0;            // link
  std::vector<int> wrist_;  // joints before it
  Vector3d p_BP_;           // middle of the palm
  std::vector<Finger> fingers_;
  Anatomy found_;
};

}  // namespace

Expected<Anatomy> find_anatomy(const Robot& robot, const SearchEffort& effort,
                               const AnatomyJudge& judge) {
  // DoFs in the order of the tree, as HandModel has its joints.
  std::vector<std::string> leaders;
  for (const RobotJoint& joint : robot.joints)
    if (!joint.mimic) leaders.push_back(joint.name);
  const auto hand =
      HandModel::parse(write_robot(robot, "provisional"), provisional_toml(robot, leaders));
  if (!hand) return tl::unexpected(hand.error());
  return Finder(robot, *hand, effort, judge).run();
}

}  // namespace prehend::planner
