#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/base/named_values.hpp"
#include "common/base/pose.hpp"
#include "common/base/time.hpp"
#include "common/model/human_hand.hpp"

namespace prehend::glove {

/// Where a sensor sits on the hand. The order of the first six is that of the messages.
enum class Site { back_of_hand, thumb, index, middle, ring, little, forearm };

/// The finger that carries a sensor, if a finger does.
std::optional<model::Finger> finger_of(Site site);

/// As in lab.toml.
inline constexpr auto site_names = named_values<Site>({{Site::back_of_hand, "back_of_hand"},
                                                       {Site::thumb, "thumb"},
                                                       {Site::index, "index"},
                                                       {Site::middle, "middle"},
                                                       {Site::ring, "ring"},
                                                       {Site::little, "little"},
                                                       {Site::forearm, "forearm"}});
std::optional<Site> site_from_string(std::string_view name);

/// One sensor as the device gave it: nothing has been checked yet. T: the tracker's frame.
struct Reading {
  Site site = Site::back_of_hand;
  bool valid = true;  // false: the device itself says that it saw nothing
  Eigen::Vector3d p_TS = Eigen::Vector3d::Zero();            // m
  Eigen::Quaterniond q_TS = Eigen::Quaterniond::Identity();  // need not have unit norm
};

/// All sensors at one moment.
struct Frame {
  std::uint64_t sequence = 0;  // counts from 0
  Time stamp{};                // acquisition
  std::vector<Reading> readings;
  std::vector<double> joint_angles;  // rad, order of model::HumanPosture; empty: not measured
  std::vector<double> joint_counts;  // what these were made of, for calibration; never published
  bool left = false;                 // a left hand that the device mirrored into a right one
  /// Numbers of the buttons that are held, from 1 and at most max_buttons; nothing: it has none.
  std::optional<std::vector<std::uint8_t>> held{};
};
inline constexpr std::size_t max_buttons = 8;

/// What a lost sensor reports: at the tracker's origin, not turned.
bool is_identity_pose(const Reading& reading);

/// The mirror image of a frame: a left hand becomes a right one and the other way round.
///
/// The mirror S = I - 2 n nᵀ goes through the tracker's origin, with the normal n (unit) in T.
/// Positions become S p. The axes x (towards the fingers) and z (out of the back of the hand) of
/// every sensor become S x and S z, and y follows, so R becomes S R diag(1, -1, 1). Joint angles,
/// which are defined by the hand itself, stay. Nothing is checked: what is not finite or has no
/// norm stays so, and so do identity poses. Twice is the same frame again (rotations up to their
/// sign).
Frame mirrored(Frame frame, const Eigen::Vector3d& normal_T);

/// The normal of the plane that makes the table's left its right: the table's x axis in T.
Eigen::Vector3d left_to_right(const Pose& X_WT);

struct Fingertip {
  bool valid = false;
  Eigen::Vector3d p_HF = Eigen::Vector3d::Zero();  // m
};

/// A hand, clean: what hand/posture says.
struct Posture {
  std::uint64_t sequence = 0;
  Time stamp{};  // of the frame that caused it
  Pose X_WH = Pose::Identity();
  std::array<Fingertip, model::finger_count> fingertips;
  double quality = 0;  // 0 to 1: share of the sensors that were good
  std::vector<double> joint_angles;
};

/// Sites of the four sensors of [Thesis, 4.1] in the order of their addresses: back of the hand,
/// thumb, index and little finger.
const std::vector<Site>& usual_sites();

}  // namespace prehend::glove
