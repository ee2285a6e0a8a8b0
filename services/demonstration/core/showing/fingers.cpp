#include "services/demonstration/core/showing/fingers.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>

namespace prehend::demonstration {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using model::HumanPosture;

constexpr double bend = 0.02;  // rad, of a step
constexpr int max_bends = 120;
constexpr int joints_a_finger = 4;
constexpr int points_a_segment = 6;

// How much a hand minds (standard deviations).
constexpr double tip_error = 0.001;   // m
constexpr double joint_error = 0.35;  // rad
constexpr int iterations = 15;
constexpr double difference = 1e-5;  // rad or m, for derivatives
constexpr double damping = 1e-3;

int first_joint(model::Finger finger) {
  const int f = static_cast<int>(finger);
  return f == 0 ? 16 : joints_a_finger * (f - 1);
}

/// The segments of a finger, in the order of HumanHand::segments(): the thumb has two, whose first
/// one its first joints move together.
std::vector<model::Capsule> segments_of(const model::HumanHand& hand, const HumanPosture& posture,
                                        model::Finger finger) {
  const auto all = hand.segments(posture);
  const auto f = static_cast<std::ptrdiff_t>(finger);
  const auto begin = all.begin() + (f == 0 ? 0 : 3 * f - 1);
  return {begin, begin + (f == 0 ? 2 : 3)};
}

bool touches(const model::Capsule& segment, const model::Shape& shape, const Pose& X_OH) {
  for (int i = 0; i <= points_a_segment; ++i) {
    const Vector3d p_H = segment.a + (segment.b - segment.a) * i / points_a_segment;
    if (model::signed_distance(shape, X_OH * p_H) < segment.radius) return true;
  }
  return false;
}

/// The last segment that touches, from 0; −1 if none does.
int last_touching(const std::vector<model::Capsule>& segments, const model::Shape& shape,
                  const Pose& X_OH) {
  for (std::size_t k = segments.size(); k-- > 0;)
    if (touches(segments[k], shape, X_OH)) return static_cast<int>(k);
  return -1;
}

void wrap(const model::HumanHand& hand, model::Finger finger, const Bending& bending,
          const model::Shape& shape, const Pose& X_OH, HumanPosture& posture) {
  const std::array rates{bending.first, bending.second, bending.third};
  const int d = first_joint(finger), bent = finger == model::Finger::thumb ? 2 : 1;
  int free = 0;  // first joint of the three that still bends
  for (int n = 0; n < max_bends && free < 3; ++n) {
    HumanPosture next = posture;
    for (int j = free; j < 3; ++j) next[d + 1 + j] += bend * rates[static_cast<std::size_t>(j)];
    next = hand.clamp(next);
    const int touching = last_touching(segments_of(hand, next, finger), shape, X_OH);
    // Segment k is moved by the joints up to k (of the thumb k + 1).
    if (touching >= 0 && touching + bent > free)
      free = touching + bent;
    else
      posture = next;
  }
}

/// What a hand minds, in standard deviations; x: joints of the fingers, then the object's place.
class Comfort {
 public:
  Comfort(const model::HumanHand& hand, const Held& comfortable,
          const std::vector<TipPlace>& places, const Slack& slack)
      : hand_(hand), comfortable_(comfortable), places_(places), slack_(slack) {}

  Index joints() const { return joints_a_finger * static_cast<Index>(places_.size()); }
  Index size() const { return joints() + 6; }

  Held held(const VectorXd& x) const {
    Held made = comfortable_;
    for (std::size_t i = 0; i < places_.size(); ++i)
      made.posture.segment<joints_a_finger>(first_joint(places_[i].finger)) +=
          x.segment<joints_a_finger>(joints_a_finger * static_cast<Index>(i));
    made.posture = hand_.clamp(made.posture);
    const Vector3d turn = x.tail<3>();
    made.X_HO.pretranslate(x.segment<3>(joints()));
    if (turn.norm() > 1e-12) made.X_HO.rotate(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
    return made;
  }

  VectorXd minded(const VectorXd& x) const {
    const Held now = held(x);
    const auto tips = hand_.fingertip_poses(now.posture);
    VectorXd made(3 * static_cast<Index>(places_.size()) + size());
    Index at = 0;
    for (const TipPlace& place : places_) {
      made.segment<3>(at) =
          (tips[static_cast<std::size_t>(place.finger)].translation() - now.X_HO * place.p_O) /
          tip_error;
      at += 3;
    }
    made.segment(at, joints()) = x.head(joints()) / joint_error;
    made.segment<3>(at + joints()) = x.segment<3>(joints()).cwiseQuotient(slack_.place_H);
    made.tail<3>() = x.tail<3>() / slack_.turn;
    return made;
  }

 private:
  const model::HumanHand& hand_;
  const Held& comfortable_;
  const std::vector<TipPlace>& places_;
  const Slack& slack_;
};

}  // namespace

HumanPosture wrapped(const model::HumanHand& hand, const HumanPosture& from, const Bending& bending,
                     const model::Shape& shape, const Pose& X_HO) {
  HumanPosture made = hand.clamp(from);
  const Pose X_OH = X_HO.inverse();
  for (int f = 0; f < model::finger_count; ++f)
    wrap(hand, static_cast<model::Finger>(f), bending, shape, X_OH, made);
  return made;
}

Held pinched(const model::HumanHand& hand, const Held& comfortable,
             const std::vector<TipPlace>& places, const Slack& slack) {
  const Comfort comfort(hand, comfortable, places, slack);
  VectorXd x = VectorXd::Zero(comfort.size());
  for (int n = 0; n < iterations; ++n) {
    const VectorXd now = comfort.minded(x);
    MatrixXd J(now.size(), x.size());
    for (Index i = 0; i < x.size(); ++i) {
      VectorXd other = x;
      other[i] += difference;
      J.col(i) = (comfort.minded(other) - now) / difference;
    }
    MatrixXd H = J.transpose() * J;
    H.diagonal() *= 1 + damping;
    VectorXd next = x - H.ldlt().solve(J.transpose() * now);
    // What a joint cannot do is not asked of it.
    const Held limited = comfort.held(next);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const int d = first_joint(places[i].finger);
      next.segment<joints_a_finger>(joints_a_finger * static_cast<Index>(i)) =
          limited.posture.segment<joints_a_finger>(d) -
          comfortable.posture.segment<joints_a_finger>(d);
    }
    if (comfort.minded(next).squaredNorm() >= now.squaredNorm()) break;
    x = std::move(next);
  }
  return comfort.held(x);
}

}  // namespace prehend::demonstration
