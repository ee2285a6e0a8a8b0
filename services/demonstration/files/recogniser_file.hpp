#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "services/demonstration/core/recognition/object_likelihood.hpp"
#include "services/demonstration/core/recognition/recogniser.hpp"

namespace prehend::demonstration {

/// A recogniser of one task, and what it was trained on.
struct TaskRecogniser {
  std::string task;
  Recogniser recogniser;
  unsigned people = 0, takes = 0;
  std::optional<ObjectLikelihood> objects = {};  // where objects were measured
};

/// A sealed file (kind «grasp-recogniser»). Refused: what is damaged, something else, or does not
/// fit together.
Expected<void> save_recognisers(const std::filesystem::path& file,
                                const std::vector<TaskRecogniser>& recognisers);
Expected<std::vector<TaskRecogniser>> load_recognisers(const std::filesystem::path& file);

}  // namespace prehend::demonstration
