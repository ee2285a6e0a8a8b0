#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "services/mapping/tools/training/teach.hpp"

namespace prehend::mapping {

/// What `prehend teach` publishes when a posture was taken, so that a recording of the session
/// tells what was shown when: the posture, and where it is a grasp the object.
std::string label_of(const learning::TrainingPair& pair);

/// The postures of a recording: of each label, the mean of hand/posture in the `still_for` before
/// it. Labels are those of the session and `labels` (label, seconds from the first posture).
/// `curriculum` says what they mean. Later labels of the same posture replace earlier ones, as
/// redo() does. Fails on what is no recording, on unknown labels, and on a hand that moved.
Expected<std::vector<Shown>> shown_in(const std::filesystem::path& recording,
                                      const std::multimap<std::string, double>& labels,
                                      const std::vector<learning::TrainingPair>& curriculum,
                                      const TeachOptions& options);

}  // namespace prehend::mapping
