#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/model/hand_model.hpp"
#include "services/recorder/core/dataset/episodes.hpp"

namespace prehend::recorder::dataset {

/// How an orientation is written: as a unit quaternion (w, x, y, z; its sign does not jump), or as
/// the first two columns of its matrix [Zhou2019], which no sign and no jump can spoil.
enum class Turns { quaternion, columns };

/// Whose a feature is.
enum class About { robot, arm, human, object };

using Table = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Numbers of every row.
struct Feature {
  std::string name;
  About about = About::robot;
  std::vector<std::string> columns;
  Table values;  // a row a moment
};

/// An episode at a fixed rate.
struct Rows {
  Time begin;  // of the first row
  Eigen::Index count = 0;
  /// Values of all DoFs and the pose of the hand's base, as they are and as they are commanded.
  Feature state, action;
  Table rate;    // of the state, a second
  Table effort;  // of the drives, N m, and 0 for the base; no column: not known
  std::vector<Feature> others;
  /// By camera: which of its pictures is the newest in each row.
  std::map<std::string, std::vector<std::size_t>> pictures;
};

struct RowOptions {
  double rate = 30;                        // Hz, of the rows
  Turns turns = Turns::quaternion;         // how orientations are written
  const model::HandModel* hand = nullptr;  // where it is known: names, fingertips
};

/// A topic of which nothing is heard for so long before and after an episode begins is not in it;
/// one that is heard only then cuts its beginning.
inline constexpr Duration max_wait = std::chrono::seconds(1);

/// Nine hours at 30 Hz: who leads a hand for longer has a clock that jumped.
inline constexpr Eigen::Index max_rows = 1'000'000;

/// The episode at a fixed rate, from the moment at which everything in it had been told. Fails on
/// an episode without the hand's state, and on one of less than two rows or more than max_rows.
Expected<Rows> make_rows(const RecordingLog& log, const Episode& episode,
                         const RowOptions& options);

}  // namespace prehend::recorder::dataset
