#pragma once

#include <filesystem>
#include <map>
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
///  - 21 landmarks: `frame,l0_x,…,l20_z`, metres in any frame; in place of `frame` a time, named
///    `timestamp`, `time`, `stamp` or `t` with its unit: `_s`, `_ms`, `_us` or `_ns`
/// Fails, with the reason, when most rows are no hand in these units (plausible_hand.hpp), or
/// frames are less than half a millisecond apart. In H the recorded middle knuckle lies where that
/// of the hand model lies. If there are rows of a right hand, those of a left one are left out; a
/// recording of left hands only, or whose fingers bend as those of a left hand, is mirrored.
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
  /// What is odd about the others: gaps, numbers that begin anew, a hand that is mirrored.
  const std::vector<std::string>& remarks() const { return remarks_; }

 private:
  friend class RecordingReader;
  std::vector<Frame> frames_;
  bool left_ = false;
  std::size_t unreadable_ = 0, other_hand_ = 0;
  std::map<std::string, std::size_t> no_hands_;  // rows, by what they are instead
  std::vector<std::string> remarks_;
};

}  // namespace prehend::glove
