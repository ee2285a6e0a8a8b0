#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "services/glove/core/frame_source.hpp"

namespace prehend::glove {

struct RecordingOptions {
  Pose X_WT = Pose::Identity();  // tracker on the table
  /// Where the hand shall be: a recording of a bare hand has no place in the room, it moves only
  /// the fingers. Not at the tracker itself: the core takes an identity pose for a fault.
  Pose X_WH = make_pose(Eigen::Vector3d(0, 0, 0.25));
  double rate = 30;       // Hz, where there are no time stamps
  double hand_scale = 1;  // of the recorded hand
};

/// A recorded bare hand as a glove with sensors on the back of the hand and on all five fingertips.
/// Two formats, told apart by their first line:
///  - Leap: `frame,t_us,fps,hand,…,palm_x,…`, mm and µs; positions of palm and joints
///  - 21 landmarks: `frame,l0_x,…,l20_z`, metres in any frame, without time stamps
/// Fails when its middle finger is never longer than 2 cm or mostly longer than 30 cm, or its
/// frames are less than half a millisecond apart: units are others. In H the recorded middle
/// knuckle lies where that of the hand model lies. If there are rows of a right hand, those of a
/// left one are left out; a recording of left hands only is mirrored.
class Recording final : public FrameSource {
 public:
  static Expected<Recording> load(const std::filesystem::path& file,
                                  const RecordingOptions& options);
  /// `name` is that of the file, for errors.
  static Expected<Recording> parse(std::string_view text, std::string_view name,
                                   const RecordingOptions& options);

  std::optional<Frame> frame(std::uint64_t n) const override;

  std::size_t size() const { return frames_.size(); }
  bool left() const { return left_; }
  /// Rows that could not be read, and rows of the other hand.
  std::size_t unreadable() const { return unreadable_; }
  std::size_t other_hand() const { return other_hand_; }
  /// The rows that were left out in few words; empty where none was.
  std::string left_out() const;

 private:
  std::vector<Frame> frames_;
  bool left_ = false;
  std::size_t unreadable_ = 0, other_hand_ = 0;
};

}  // namespace prehend::glove
