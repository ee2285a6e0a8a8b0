// The human hand: frame H as its header defines it, opposition of the thumb, directions of closing,
// the place of the grasp frame, and that closing on an object touches it without entering it.
#include "common/model/human_hand.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/model/placement.hpp"

namespace prehend::model {
namespace {

using Eigen::Vector3d;

constexpr int thumb = 0, index = 1, middle = 2, little = 4;

std::array<double, finger_count> all(double closure) {
  std::array<double, finger_count> result;
  result.fill(closure);
  return result;
}

std::array<Vector3d, finger_count> tips(const HumanHand& hand, double closure) {
  std::array<Vector3d, finger_count> result;
  const auto poses = hand.fingertip_poses(HumanHand::posture(all(closure)));
  for (int f = 0; f < finger_count; ++f) result[f] = poses[f].translation();
  return result;
}

/// Least distance between any segment and the object.
double clearance(const HumanHand& hand, const std::array<double, finger_count>& closure,
                 const Shape& shape, const Pose& X_HO) {
  double least = 1;
  for (const Capsule& capsule : hand.segments(HumanHand::posture(closure)))
    for (int i = 0; i <= 100; ++i) {
      const Vector3d p = capsule.a + (capsule.b - capsule.a) * (i / 100.0);
      least = std::min(least, signed_distance(shape, X_HO.inverse() * p) - capsule.radius);
    }
  return least;
}

// The same bone of the finger beside it is at most 1.4 times as long.
TEST(HumanHand, BonesGetShorterTowardTheTip) {
  const HumanHand hand(1);
  for (int f = index; f <= little; ++f) {
    const auto bones = hand.bones(static_cast<Finger>(f));
    EXPECT_GT(bones[0], 1.2 * bones[1]) << f;
    EXPECT_GT(bones[1], 0.9 * bones[2]) << f;
    for (std::size_t i = 0; f > index && i < bones.size(); ++i) {
      const double beside = hand.bones(static_cast<Finger>(f - 1))[i];
      EXPECT_LT(std::max(bones[i], beside), 1.4 * std::min(bones[i], beside)) << f << ' ' << i;
    }
  }
}

TEST(HumanHand, FrameHPointsAsDocumented) {
  const HumanHand hand(1);
  const auto open = tips(hand, 0);
  // x toward the fingers, about a hand's length of 10 to 20 cm away from the back of the hand.
  for (int f = index; f <= little; ++f) {
    EXPECT_GT(open[f].x(), 0.10);
    EXPECT_LT(open[f].x(), 0.20);
  }
  // y toward the thumb: thumb, index, …, little in falling order.
  for (int f = thumb; f < little; ++f) EXPECT_GT(open[f].y(), open[f + 1].y());
  // z out of the back of the hand: everything is on the palm's side of it.
  for (int f = thumb; f <= little; ++f) EXPECT_LT(open[f].z(), 0);
}

// A straight finger ends its bones' lengths away from where it begins; longer bones move neither
// the beginnings nor the other fingers.
TEST(HumanHand, FingersHaveTheLengthsOfTheirBones) {
  const HumanHand average(1.1), person(1.1, {0.9, 1.1, 1, 1.05, 1.2});
  const std::array<double, finger_count> factors{0.9, 1.1, 1, 1.05, 1.2};
  const auto straight = person.fingertip_poses(HumanPosture::Zero());
  for (int f = thumb; f <= little; ++f) {
    const auto finger = static_cast<Finger>(f);
    EXPECT_EQ(person.base(finger), average.base(finger));
    double length = 0;
    for (std::size_t bone = 0; bone < 3; ++bone) {
      EXPECT_NEAR(person.bones(finger)[bone], factors[f] * average.bones(finger)[bone], 1e-12);
      length += person.bones(finger)[bone];
    }
    if (f != thumb) {
      EXPECT_NEAR((straight[f].translation() - person.base(finger)).norm(), length, 1e-9) << f;
    }
  }
}

TEST(HumanHand, FingersCloseTowardThePalmAndTheThumbOpposesThem) {
  const HumanHand hand(1);
  for (double c = 0; c < 0.5; c += 0.05) {
    const auto before = tips(hand, c), after = tips(hand, c + 0.05);
    // Tips come down until the finger points away from the palm, then curl back to it.
    for (int f = index; f <= little && c < 0.35; ++f) EXPECT_LT(after[f].z(), before[f].z()) << f;
    // Thumb and middle finger approach each other until they meet around half closure.
    EXPECT_LT((after[thumb] - after[middle]).norm(), (before[thumb] - before[middle]).norm()) << c;
  }
  EXPECT_GT((tips(hand, 0)[thumb] - tips(hand, 0)[middle]).norm(), 0.12);
  EXPECT_LT((tips(hand, 0.5)[thumb] - tips(hand, 0.5)[index]).norm(), 0.03);
}

TEST(HumanHand, GraspFrameLiesBetweenThumbAndFingersWhenHalfClosed) {
  for (const double scale : {0.8, 1.0, 1.25}) {
    const HumanHand hand(scale);
    const Pose X_GH = hand.X_HG().inverse();
    EXPECT_NEAR(X_GH.linear().determinant(), 1, 1e-12);
    // Half closed around something: before the fingers meet the thumb.
    const auto p = tips(hand, 0.35);
    EXPECT_LT((X_GH * p[thumb]).y(), 0);  // y: from the thumb's side …
    for (int f = index; f <= little; ++f) EXPECT_GT((X_GH * p[f]).y(), 0);  // … to the fingers'
    // z leaves the palm: the back of the hand is behind, by less than a hand's length.
    const Vector3d back = X_GH * Vector3d::Zero();
    EXPECT_LT(back.z(), -0.05 * scale);
    EXPECT_GT(back.norm(), 0.05 * scale);
    EXPECT_LT(back.norm(), 0.15 * scale);
    // x is along the width of the palm, toward the thumb's side.
    EXPECT_NEAR((hand.X_HG().linear() * Vector3d::UnitX()).y(), 1, 1e-9);
  }
}

TEST(HumanHand, ScalesInProportion) {
  const auto small = tips(HumanHand(0.8), 0.4), large = tips(HumanHand(1.2), 0.4);
  for (int f = 0; f < finger_count; ++f) EXPECT_NEAR((large[f] - 1.5 * small[f]).norm(), 0, 1e-12);
}

TEST(HumanHand, FingertipPosesLieAlongTheLastSegment) {
  const HumanHand hand(1);
  const HumanPosture posture = HumanHand::posture(all(0.3));
  const auto poses = hand.fingertip_poses(posture);
  const auto segments = hand.segments(posture);
  for (const Pose& tip : poses) {
    EXPECT_NEAR((tip.linear() * tip.linear().transpose() - Eigen::Matrix3d::Identity()).norm(), 0,
                1e-12);
    // Some segment ends a radius before the tip, in the direction of the tip's x.
    double nearest = 1;
    for (const Capsule& capsule : segments)
      nearest = std::min(
          nearest, (capsule.b + capsule.radius * tip.linear().col(0) - tip.translation()).norm());
    EXPECT_LT(nearest, 1e-9);
  }
}

TEST(HumanHand, ClampsAngles) {
  const HumanHand hand(1);
  EXPECT_LT(hand.clamp(HumanPosture::Constant(10)).maxCoeff(), 2);
  EXPECT_GT(hand.clamp(HumanPosture::Constant(-10)).minCoeff(), -1);
  for (const double c : {0.0, 0.3, 1.0}) {
    const HumanPosture q = HumanHand::posture(all(c));
    EXPECT_LT((hand.clamp(q) - q).norm(), 1e-12) << "postures are within the limits";
  }
  EXPECT_EQ(HumanHand::posture(all(-3)), HumanHand::open_posture());
  EXPECT_EQ(HumanHand::posture(all(7)), HumanHand::fist_posture());
}

/// Cylinders and boxes of the sizes of everyday things, each with how it is grasped.
struct Case {
  Shape shape;
  bool from_above;
};

std::vector<Case> cases() {
  std::vector<Case> result;
  for (const double r : {0.015, 0.024, 0.033, 0.037})
    for (const double h : {0.12, 0.23}) result.push_back({{ShapeKind::cylinder, {r, r, h}}, false});
  for (const double depth : {0.035, 0.043, 0.062, 0.067})
    for (const double height : {0.043, 0.148})
      result.push_back({{ShapeKind::box, {depth, 0.12, height}}, true});
  return result;
}

TEST(HumanHand, ClosingOnEverydayShapesTouchesWithThumbAndFingers) {
  for (const double scale : {0.85, 1.0, 1.2})
    for (const Case& c : cases()) {
      const HumanHand hand(scale);
      Eigen::Matrix3d R_OG;
      if (c.from_above)
        R_OG << 0, 1, 0, 1, 0, 0, 0, 0, -1;  // x_G = y_O, y_G = x_O, z_G down
      else
        R_OG << 0, 0, 1, 0, -1, 0, 1, 0, 0;  // x_G up, z_G along x_O
      ASSERT_NEAR(R_OG.determinant(), 1, 1e-12);
      const auto X_OG = nearest_grasp(c.shape, make_pose({0, 0, 0}, R_OG), Reach{});
      ASSERT_TRUE(X_OG);
      const Pose X_HO = hand.X_HG() * X_OG->inverse();
      const auto closure = hand.close_on(c.shape, X_HO);
      const auto name = testing::Message()
                        << "scale " << scale << " size " << c.shape.size.transpose();
      // Started free, stopped in the middle of closing: the thumb and at least two fingers touch.
      int touching = 0;
      for (int f = index; f <= little; ++f) touching += closure[f] > 0 && closure[f] < 0.999;
      EXPECT_GT(closure[thumb], 0) << name;
      EXPECT_LT(closure[thumb], 0.999) << name;
      EXPECT_GE(touching, 2) << name;
      // Near the surface but not inside: the axis of a capsule is sampled, which lets at most half
      // a millimetre in.
      const double gap = clearance(hand, closure, c.shape, X_HO);
      EXPECT_GT(gap, -5e-4) << name << " closure " << closure[0] << ' ' << closure[1] << ' '
                            << closure[2] << ' ' << closure[3] << ' ' << closure[4];
      EXPECT_LT(gap, 1e-3) << name;
    }
}

TEST(HumanHand, ClosingOnNothingMakesAFist) {
  const HumanHand hand(1);
  const Shape far_ball{ShapeKind::sphere, Vector3d::Constant(0.02)};
  for (const double c : hand.close_on(far_ball, make_pose({1, 0, 0}))) EXPECT_DOUBLE_EQ(c, 1);
}

}  // namespace
}  // namespace prehend::model
