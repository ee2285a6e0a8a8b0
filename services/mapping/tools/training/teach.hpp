#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/learning/training_set.hpp"
#include "services/mapping/core/features.hpp"
#include "services/mapping/tools/training/robot_grasps.hpp"
#include "services/mapping/tools/training/scheme.hpp"

namespace prehend::mapping {

struct TeachOptions {
  Duration still_for = std::chrono::milliseconds(500);  // that a posture is kept
  double still_within = 0.004;  // m, of every fingertip from its mean meanwhile
  double apart = 0.012;         // m, that some fingertip must be from where it was in every other
  int min_samples = 8;          // in that time
};

/// A posture that was shown, and how well.
struct Shown {
  learning::TrainingPair pair;
  double wobble = 0;      // m, furthest of a fingertip from its mean
  double separation = 0;  // m, from the most alike of the other postures; infinite for the first
  std::string nearest_name;
  /// 1: quite still and unlike all others; 0: just good enough.
  double quality = 0;
};

/// What a person is asked for: the basic postures of the scheme and then the grasps, each once a
/// take. Features of the pairs are still missing.
std::vector<learning::TrainingPair> curriculum(const model::HandModel& hand, const Scheme& scheme,
                                               const std::string& user, int takes, int postures,
                                               const std::vector<RobotGrasp>& grasps);

/// Asks for one posture after the other, and takes each when the hand has kept still in it. Pure:
/// time comes with the samples.
class Teacher {
 public:
  Teacher(std::vector<learning::TrainingPair> asked, const TeachOptions& options)
      : asked_(std::move(asked)), options_(options) {}

  /// What is to be shown now; nullptr when all has been.
  const learning::TrainingPair* asked() const;
  /// A sample of the hand. Returns the posture once it is taken.
  std::optional<Shown> see(const Features& features, Time stamp);
  /// Why the last sample did not complete a posture, in few words.
  const std::string& waiting_for() const { return waiting_for_; }
  /// The last one shall be shown again. False if there is none.
  bool redo();

  const std::vector<Shown>& shown() const { return shown_; }

 private:
  std::vector<learning::TrainingPair> asked_;
  TeachOptions options_;
  std::vector<Shown> shown_;
  std::optional<Features> refused_;  // by redo(): not to be taken again while the hand stays so
  std::deque<std::pair<Time, Features>> window_;
  std::string waiting_for_ = "hand";
};

/// The mean of samples and how far a fingertip was from it at most, m.
struct Stillness {
  Features mean = Features::Zero();
  double wobble = 0;
};
Stillness stillness(const std::deque<std::pair<Time, Features>>& samples);

/// A training set of what was shown.
learning::TrainingSet taught_set(const model::HandModel& hand, const Scheme& scheme,
                                 const std::vector<Shown>& shown);

/// Refuses taught sets that no mapping can follow: in one take of one person, postures that look
/// alike (every fingertip within 3 mm) but shall be answered differently. Names both.
Expected<void> check_consistent(const learning::TrainingSet& set);

}  // namespace prehend::mapping
