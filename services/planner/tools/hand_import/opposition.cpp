#include "services/planner/tools/hand_import/opposition.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "common/base/random.hpp"
#include "common/model/placement.hpp"

namespace prehend::planner {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double further = 0.5;                   // rad, beyond where fingers rest
constexpr int kept = 8;                           // of the samples, to be refined
constexpr std::array radii{0.015, 0.022, 0.033};  // m, of the rods that are tried
constexpr double good = 0.4;                      // quality of a grip that counts
constexpr std::size_t judged = 10;  // of all, in the physics: the best by worth come first
constexpr double enough = 4;        // objects held of six, more than which are not looked for
constexpr double clearly = 0.5;     // objects more that another place must hold
constexpr double better = 0.8;      // by which a found place must surpass the known axes
constexpr double aside = 0.25;      // what a DoF costs that leaves its rest by its whole range
constexpr double clear = 0.002;     // m, between the open hand and a rod, and between its fingers
constexpr double touching = 0.5;    // what fingers cost that are nearer,
constexpr double crossed = 200;     // and by m
constexpr double way_in = 0.16;     // m, along which the hand must be able to come
constexpr double max_aside = 0.06;  // m, that thick rods may lie further out
constexpr double long_half = 0.06;  // m: what stands or lies on a table is longer than its grip
constexpr double step_in = 0.005;   // m, along that way
constexpr double edge = 0.006;      // m, radius of the edges of a box
constexpr double widest = 0.25;     // m

/// A posture and place, and what they are worth.
struct Trial {
  VectorXd dof;
  Vector3d middle = Vector3d::Zero();
  Vector3d across = Vector3d::UnitY();  // y of G
  Vector3d out = Vector3d::UnitZ();     // z of G
  double worth = -1e9;

  Pose X_BG() const { return make_pose(middle, model::grasp_axes(out, across)); }
};

class Search {
 public:
  Search(const ContactWorld& world, const Fingers& fingers, const SearchEffort& effort)
      : world_(world),
        effort_(effort),
        open_(fingers.open),
        fist_(fingers.fist),
        fixed_(fingers.fixed),
        p_LT_(fingers.p_LT),
        tips_(fingers.last),
        at_rest_(std::max(-clear, world.overlap_of_fingers(open_))) {}

  Opposition run(const Pose& X_BG_known, const OppositionJudge& judge) {
    Trial known{open_, X_BG_known.translation(), X_BG_known.linear().col(1),
                X_BG_known.linear().col(2)};
    known.worth = worth(known);
    std::vector<Trial> found{known};
    if (p_LT_.size() > 1) {
      const Trial near = about(known);
      found = searched();
      for (Trial& trial : found) trial = from_the_thumb(trial);
      const bool keep = found.empty() || near.worth > found.front().worth - better;
      found.insert(keep ? found.begin() : found.begin() + 1, near);
    }
    if (auto wider = opened(found.front()); judge && wider)
      found.insert(found.begin() + 1, std::move(*wider));
    std::size_t best = 0;
    Opposition result = described(found[0]);
    double most = judge ? judge(result, 0) : 0;
    for (std::size_t i = 1; judge && i < found.size() && i < judged && most < enough; ++i) {
      Opposition other = described(found[i]);
      const double held = judge(other, most + clearly);
      if (held < most + clearly) continue;
      most = held;
      best = i;
      result = std::move(other);
    }
    add_preshape(result, found[best], "tripod", {{}, 0.018, 0.008}, 3);
    add_preshape(result, found[best], "pinch", {{}, 0.012, 0.004}, 2);
    return result;
  }

 private:
  Opposition described(const Trial& trial) const {
    Opposition result;
    result.open = trial.dof;
    result.quality = trial.worth;
    result.depth = depth(trial);
    result.alone = alone(trial);
    result.opening = opening(trial);
    result.X_BG = trial.X_BG();
    return result;
  }

  bool turns_aside(std::size_t i) const { return world_.closing()[i] == 0 && !fixed_[i]; }

  /// The same with fingers that open further than they rest; none where they do not.
  std::optional<Trial> opened(Trial trial) const {
    double most = 0;
    for (std::size_t i = 0; i < fixed_.size(); ++i) {
      if (world_.closing()[i] == 0 || fixed_[i]) continue;
      const model::HandDof& dof = world_.hand().dofs()[i];
      double& value = trial.dof[static_cast<Eigen::Index>(i)];
      const double by = std::clamp((world_.closing()[i] > 0 ? dof.lower : dof.upper) - value,
                                   -further * radian_of(dof), further * radian_of(dof));
      value += by;
      most = std::max(most, std::abs(by) / radian_of(dof));
    }
    if (most < 0.1 * further) return std::nullopt;
    trial.worth = worth(trial);
    return trial;
  }

  /// How far the way in along `out` is free, at most to `wanted`: the least room on it, m.
  double way(const Trial& trial, Rod rod) const {
    double least = 0.02;
    for (double s = 0; s < way_in && least > 0; s += 0.02) {
      rod.X_BR.translation() = trial.middle + s * trial.out;
      least = std::min(least, world_.room(trial.dof, rod, 0.02));
    }
    return least;
  }

  /// How near to the middle something can come along `out` from outside, at most to `nearest`, m:
  /// rods at these places along y, moved together.
  double comes_in(const Trial& trial, double radius, const std::vector<double>& at_y,
                  double nearest) const {
    Rod rod{trial.X_BG(), radius, long_half};
    double free = way_in;
    for (double s = way_in; s > nearest - 0.5 * step_in; s -= step_in) {
      for (const double y : at_y) {
        rod.X_BR.translation() = trial.middle + s * trial.out + y * rod.X_BR.linear().col(1);
        if (world_.room(trial.dof, rod, 2 * clear) < clear) return free;
      }
      free = s;
    }
    return free;
  }

  /// The rod about the middle, or further out where it does not fit; none if it fits nowhere.
  std::optional<Rod> placed(const Trial& trial, double radius, double half_length) const {
    Rod rod{trial.X_BG(), radius, half_length};
    for (double out = 0; out <= max_aside; out += 0.006) {
      rod.X_BR.translation() = trial.middle + out * trial.out;
      if (world_.room(trial.dof, rod) > clear) return rod;
    }
    return std::nullopt;
  }

  double worth(const Trial& trial) const {
    double sum = 0;
    for (const double radius : radii) {
      const auto rod = placed(trial, radius, 0.03);
      if (!rod) continue;
      const auto touches = world_.close(trial.dof, *rod);
      const double quality = grip_quality(touches);
      if (quality < 0.1) continue;
      std::set<int> fingers;
      for (const Touch& touch : touches)
        if (touch.presses) fingers.insert(touch.finger);
      sum += std::min(quality, 0.75) +
             0.06 * static_cast<double>(std::min<std::size_t>(fingers.size(), 5));
    }
    if (sum == 0) return 0;
    // Rods that need not be pushed in past a finger, and a posture near that at rest.
    sum += 10 * std::min(0.0, way(trial, {trial.X_BG(), radii[1], 0.01}) - clear);
    double away = 0;
    for (std::size_t i = 0; i < fixed_.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      const model::HandDof& dof = world_.hand().dofs()[i];
      if (turns_aside(i)) away += std::abs(trial.dof[k] - open_[k]) / (dof.upper - dof.lower);
    }
    const double nearer = crossing(trial.dof);
    return sum - aside * away - (nearer > 0 ? touching + crossed * nearer : 0);
  }

  /// How much nearer fingers are than they may be, and than they are at rest, m: physics and
  /// mapping take what touches in the open hand for no obstacle.
  double crossing(const VectorXd& dof) const {
    return std::max(0.0, world_.overlap_of_fingers(dof) - at_rest_);
  }

  std::vector<Vector3d> tips(const VectorXd& dof) const {
    const auto& hand = world_.hand();
    const auto X_BL = hand.link_poses(hand.joint_angles(dof));
    std::vector<Vector3d> p_BT;
    for (std::size_t i = 0; i < p_LT_.size(); ++i)
      p_BT.push_back(X_BL[static_cast<std::size_t>(tips_[i])] * p_LT_[i]);
    return p_BT;
  }

  VectorXd closed_by(const VectorXd& dof, double share) const {
    VectorXd closed = dof;
    for (std::size_t i = 0; i < fixed_.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      if (world_.closing()[i] != 0 && !fixed_[i]) closed[k] += share * (fist_[k] - dof[k]);
    }
    return closed;
  }

  /// Out of the palm, across `across`, where the way is freest.
  Vector3d way_out(Trial trial) const {
    const Vector3d palm = world_.nearest_of_palm(trial.dof, trial.middle);
    Vector3d start = trial.middle - palm;
    start -= start.dot(trial.across) * trial.across;
    if (start.norm() < 1e-3) start = trial.across.unitOrthogonal();
    start.normalize();
    Vector3d best = start;
    double most = -1e9;
    for (const double angle : {0.0, -0.4, 0.4, -0.8, 0.8, -1.2, 1.2}) {
      trial.out = Eigen::AngleAxisd(angle, trial.across) * start;
      const double free = way(trial, {trial.X_BG(), radii[1], 0.01}) - 0.004 * std::abs(angle);
      if (free <= most) continue;
      most = free;
      best = trial.out;
    }
    return best;
  }

  /// A random posture, and a place where two of its fingertips could meet.
  std::optional<Trial> sampled() {
    Trial trial;
    trial.dof = open_;
    for (std::size_t i = 0; i < fixed_.size(); ++i) {
      const model::HandDof& dof = world_.hand().dofs()[i];
      const double place = random_.uniform(), keep = random_.uniform();
      if (turns_aside(i) && keep > 0.5)
        trial.dof[static_cast<Eigen::Index>(i)] = dof.lower + place * (dof.upper - dof.lower);
    }
    const std::size_t n = p_LT_.size();
    const std::size_t first = random_.index(n), second = (first + 1 + random_.index(n - 1)) % n;
    const double s = random_.uniform(0, 0.7), t = random_.uniform(0, 0.7);
    const Vector3d a = tips(closed_by(trial.dof, s))[first];
    const Vector3d b = tips(closed_by(trial.dof, t))[second];
    const Vector3d a_next = tips(closed_by(trial.dof, s + 0.05))[first];
    const Vector3d b_next = tips(closed_by(trial.dof, t + 0.05))[second];
    const double gap = (b - a).norm();
    if (gap < 0.02 || gap > 0.12) return std::nullopt;
    trial.across = (b - a) / gap;
    // They must come from both sides.
    if (trial.across.dot(a_next - a) <= 0 || trial.across.dot(b_next - b) >= 0) return std::nullopt;
    trial.middle = 0.5 * (a + b);
    trial.out = way_out(trial);
    // Behind the tips, where links can wrap.
    trial.middle -= random_.uniform(0, 0.03) * trial.out;
    trial.worth = worth(trial);
    return trial;
  }

  /// The known axes, with other postures and places.
  Trial about(const Trial& known) {
    Trial best = known;
    for (int i = 0; i < effort_.shapings; ++i) {
      Trial next = varied(best, i < effort_.shapings / 2 ? 0.02 : 0.006, 0);
      if (next.worth > best.worth) best = std::move(next);
    }
    return best;
  }

  /// moved: m, turned: rad; standard deviations.
  Trial varied(const Trial& from, double moved, double turned) {
    Trial trial = from;
    for (std::size_t i = 0; i < fixed_.size(); ++i) {
      const model::HandDof& dof = world_.hand().dofs()[i];
      const double by = random_.normal(0.12) * (dof.upper - dof.lower);
      const auto k = static_cast<Eigen::Index>(i);
      if (turns_aside(i)) trial.dof[k] = std::clamp(trial.dof[k] + by, dof.lower, dof.upper);
    }
    trial.middle += random_.normal3(moved);
    const Eigen::Matrix3d R = trial.X_BG().linear();
    const Vector3d turn = random_.normal3(turned) + Vector3d(1e-12, 0, 0);
    const Eigen::AngleAxisd by(turn.norm(), turn.normalized());
    trial.across = by * R.col(1);
    trial.out = by * R.col(2);
    trial.worth = worth(trial);
    return trial;
  }

  /// The best of many, refined.
  std::vector<Trial> searched() {
    std::vector<Trial> best;
    for (int i = 0; i < effort_.samples; ++i) {
      const auto trial = sampled();
      if (trial && trial->worth > 0) best.push_back(*trial);
    }
    const auto order = [&] {
      std::stable_sort(best.begin(), best.end(),
                       [](const Trial& a, const Trial& b) { return a.worth > b.worth; });
    };
    order();
    if (best.size() > kept) best.resize(kept);
    for (Trial& trial : best)
      for (int i = 0; i < effort_.refinements; ++i) {
        Trial next = varied(trial, 0.006, 0.12);
        if (next.worth > trial.worth) trial = std::move(next);
      }
    order();
    return best;
  }

  /// The fingers that touch a rod from -y and from +y.
  std::array<std::set<int>, 2> sides(const Trial& trial) const {
    std::array<std::set<int>, 2> found;
    if (const auto rod = placed(trial, radii[1], 0.03))
      for (const Touch& touch : world_.close(trial.dof, *rod))
        if (touch.finger >= 0 && std::abs(touch.normal_R.y()) > 0.3)
          found[touch.normal_R.y() > 0 ? 1 : 0].insert(touch.finger);
    return found;
  }

  /// Turns y so that it leads from the side with fewer fingers to the other.
  Trial from_the_thumb(Trial trial) const {
    const auto [before, behind] = sides(trial);
    const bool last_behind =
        !behind.empty() && !before.empty() && *behind.rbegin() > *before.rbegin();
    if (before.size() > behind.size() || (before.size() == behind.size() && last_behind))
      trial.across = -trial.across;
    return trial;
  }

  /// The finger against which two or more others press.
  int alone(const Trial& trial) const {
    const auto both = sides(trial);
    for (const std::size_t side : {0, 1})
      if (both[side].size() == 1 && both[1 - side].size() > 1 &&
          !both[1 - side].contains(*both[side].begin()))
        return *both[side].begin();
    return -1;
  }

  /// How far beyond the origin of G the top of a box of this width can come to the palm, m.
  double depth(const Trial& trial, double width) const {
    std::vector<double> at_y;
    const double end = 0.5 * width - edge;
    for (double y = -end; y < end; y += 2 * edge) at_y.push_back(y);
    at_y.push_back(end);
    return edge - comes_in(trial, edge, at_y, -0.06);
  }

  /// The same for the widest of some boxes for which it is not negative.
  double depth(const Trial& trial) const {
    double found = 0;
    for (const double width : {0.024, 0.034, 0.044, 0.056, 0.068})
      if (const double deep = depth(trial, width); deep > 0.005) found = deep;
    return found;
  }

  double opening(const Trial& trial) const {
    double found = 0;
    for (double radius = 0.005; radius < 0.5 * widest; radius += effort_.step) {
      const auto rod = placed(trial, radius, 0.01);
      if (rod && grip_quality(world_.close(trial.dof, *rod)) > good) found = 2 * radius;
    }
    return std::min(found + 2 * clear, gap(trial));
  }

  /// Between the two tips that are farthest apart along y, m: nothing wider goes between them.
  double gap(const Trial& trial) const {
    double least = 1e9, most = -1e9;
    for (const Vector3d& tip : tips(trial.dof)) {
      least = std::min(least, trial.across.dot(tip));
      most = std::max(most, trial.across.dot(tip));
    }
    return most - least;
  }

  /// Fingers begin partly closed, near what they take with their ends.
  void add_preshape(Opposition& result, const Trial& from, const std::string& name, Rod rod,
                    std::size_t wanted) {
    Trial best;
    for (int i = 0; i < effort_.shapings; ++i) {
      Trial trial = from;
      for (std::size_t k = 0; k < fixed_.size(); ++k) {
        const model::HandDof& dof = world_.hand().dofs()[k];
        const auto j = static_cast<Eigen::Index>(k);
        const double share = random_.uniform(0, 0.6), by = random_.normal(0.1);
        if (turns_aside(k))
          trial.dof[j] =
              std::clamp(trial.dof[j] + by * (dof.upper - dof.lower), dof.lower, dof.upper);
        else if (world_.closing()[k] != 0)
          trial.dof[j] += share * (fist_[j] - trial.dof[j]);
      }
      const double out = random_.uniform(-0.01, 0.03);
      rod.X_BR = trial.X_BG();
      rod.X_BR.translation() += out * trial.out;
      if (world_.room(trial.dof, rod) < clear || crossing(trial.dof) > 0) continue;
      const auto touches = world_.close(trial.dof, rod);
      std::set<int> ends;
      std::size_t others = 0;
      for (const Touch& touch : touches)
        if (touch.last && touch.presses)
          ends.insert(touch.finger);
        else
          ++others;
      if (ends.size() < wanted) continue;
      trial.worth = grip_quality(touches) - 0.05 * static_cast<double>(others);
      if (trial.worth > std::max(good, best.worth)) best = trial;
    }
    if (best.worth > good) result.preshapes[name] = best.dof;
  }

  const ContactWorld& world_;
  const SearchEffort effort_;
  const VectorXd &open_, &fist_;
  const std::vector<bool>& fixed_;
  const std::vector<Vector3d>& p_LT_;
  const std::vector<int>& tips_;
  const double at_rest_;  // overlap of fingers, m
  Random random_{1};
};

}  // namespace

Opposition find_opposition(const ContactWorld& world, const Fingers& fingers,
                           const Pose& X_BG_known, const SearchEffort& effort,
                           const OppositionJudge& judge) {
  return Search(world, fingers, effort).run(X_BG_known, judge);
}

}  // namespace prehend::planner
