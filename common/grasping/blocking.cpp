#include "common/grasping/blocking.hpp"

#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <btBulletCollisionCommon.h>

#include <algorithm>
#include <map>
#include <utility>

#include "common/grasping/closest.hpp"
#include "common/grasping/hand_body.hpp"

namespace prehend::grasping {
namespace {

using Eigen::VectorXd;

constexpr double touch = 0.001;   // m
constexpr double deeper = 0.001;  // m, than they overlap now, that means one runs into the other
constexpr int moments = 32;       // of an opening movement that are looked at

/// The hand's geometry without a world around it.
class Fingers {
 public:
  Fingers(const model::HandModel& hand, const VectorXd& closed)
      : hand_(hand),
        closed_(closed),
        open_(hand.joint_angles(hand.postures().at("open"))),
        body_(hand,
              std::vector<analysis::Material>(hand.links().size(), analysis::Material::plastic),
              bullet_, filter_, 0.002) {}

  int count() const { return static_cast<int>(hand_.fingertips().size()); }

  /// The first pair that meets when `finger` opens while those in `opened` (a bit each) are open,
  /// and only those in `present` are there at all.
  std::optional<LinkPair> obstacle(int finger, unsigned opened, unsigned present) {
    const std::vector<LinkPair> pairs = pairs_of(finger, present);
    std::vector<double> allowed;
    place(finger, 0, opened);
    for (const LinkPair& pair : pairs) allowed.push_back(std::min(distance(pair), 0.0) - deeper);
    for (int moment = 1; moment <= moments; ++moment) {
      place(finger, static_cast<double>(moment) / moments, opened);
      for (std::size_t i = 0; i < pairs.size(); ++i)
        if (distance(pairs[i]) < allowed[i]) return pairs[i];
    }
    return std::nullopt;
  }

  std::vector<LinkPair> touching() {
    std::vector<LinkPair> found;
    place(0, 0, 0);
    for (int finger = 0; finger < count(); ++finger)
      for (const LinkPair& pair : pairs_of(finger, ~0U))
        if (pair.link < pair.other && distance(pair) < touch) found.push_back(pair);
    return found;
  }

 private:
  /// Pairs of links that may touch, the first of this finger and the second of another.
  std::vector<LinkPair> pairs_of(int finger, unsigned present) const {
    std::vector<LinkPair> pairs;
    const auto& links = hand_.links();
    for (int i = 0; i < static_cast<int>(links.size()); ++i)
      for (int k = 0; k < static_cast<int>(links.size()); ++k) {
        const int other = links[static_cast<std::size_t>(k)].finger;
        if (links[static_cast<std::size_t>(i)].finger == finger && other >= 0 && other != finger &&
            (present >> other & 1U) && body_.may_touch(i, k))
          pairs.push_back({i, k});
      }
    return pairs;
  }

  /// `finger` at a share of its way to open, the opened ones open, the others as they are.
  void place(int finger, double share, unsigned opened) {
    VectorXd joint = closed_;
    for (std::size_t i = 0; i < hand_.joints().size(); ++i) {
      const model::HandJoint& moves = hand_.joints()[i];
      const int of = hand_.links()[static_cast<std::size_t>(moves.child)].finger;
      if (of < 0 || hand_.dofs()[static_cast<std::size_t>(moves.dof)].closing == 0) continue;
      const double way = of == finger ? share : (opened >> of & 1U) ? 1.0 : 0.0;
      const auto k = static_cast<Eigen::Index>(i);
      joint[k] += way * (open_[k] - closed_[k]);
    }
    body_.place(Pose::Identity(), joint, VectorXd::Zero(joint.size()));
  }

  double distance(const LinkPair& pair) {
    ClosestDistance closest(2 * touch);
    bullet_.contactPairTest(body_.colliders()[static_cast<std::size_t>(pair.link)].get(),
                            body_.colliders()[static_cast<std::size_t>(pair.other)].get(), closest);
    return closest.distance;
  }

  const model::HandModel& hand_;
  const VectorXd closed_, open_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btMultiBodyConstraintSolver solver_;
  btMultiBodyDynamicsWorld bullet_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  LinkPairFilter filter_;
  HandBody body_;
};

/// The order in which the fingers that are not in `opened` can open, or none. `hopeless` remembers
/// sets that lead nowhere.
std::optional<std::vector<int>> order_from(Fingers& fingers, unsigned opened,
                                           std::map<unsigned, bool>& hopeless) {
  if (opened == (1U << fingers.count()) - 1) return std::vector<int>{};
  if (hopeless[opened]) return std::nullopt;
  for (int finger = 0; finger < fingers.count(); ++finger) {
    if (opened >> finger & 1U || fingers.obstacle(finger, opened, ~0U)) continue;
    if (auto rest = order_from(fingers, opened | 1U << finger, hopeless)) {
      rest->insert(rest->begin(), finger);
      return rest;
    }
  }
  hopeless[opened] = true;
  return std::nullopt;
}

}  // namespace

Expected<Blocking> find_blocking(const model::HandModel& hand, const VectorXd& joint) {
  if (joint.size() != static_cast<Eigen::Index>(hand.joints().size()) || !joint.allFinite())
    return fail("the hand needs " + std::to_string(hand.joints().size()) + " finite joint values",
                hand.name());
  if (hand.fingertips().size() > 10) return fail("has more than ten fingers", hand.name());
  Fingers fingers(hand, joint);
  Blocking found;
  found.touching = fingers.touching();
  for (int finger = 0; finger < fingers.count(); ++finger)
    for (int other = 0; other < fingers.count(); ++other)
      if (other != finger)
        if (const auto pair = fingers.obstacle(finger, 0, 1U << other))
          found.blocked.push_back(*pair);
  std::map<unsigned, bool> hopeless;
  found.order = order_from(fingers, 0, hopeless);
  return found;
}

std::string to_string(const Blocking& blocking, const model::HandModel& hand) {
  if (blocking.blocked.empty()) return {};
  const auto link = [&](int i) { return hand.links()[static_cast<std::size_t>(i)].name; };
  std::string text;
  for (const LinkPair& pair : blocking.blocked)
    text += (text.empty() ? "" : ", ") + link(pair.other) + " blocks " + link(pair.link);
  if (!blocking.order) return text + "; no order of opening frees them";
  text += "; open ";
  for (std::size_t i = 0; i < blocking.order->size(); ++i)
    text += (i == 0 ? "" : ", then ") +
            hand.fingertips()[static_cast<std::size_t>((*blocking.order)[i])].name;
  return text;
}

}  // namespace prehend::grasping
