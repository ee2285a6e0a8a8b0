#pragma once

#include <filesystem>
#include <vector>

#include "common/base/error.hpp"
#include "services/mapping/core/mapping_model.hpp"
#include "services/mapping/tools/training/closures.hpp"
#include "services/mapping/tools/training/trainer.hpp"

namespace prehend::mapping {

/// What a mapping model of a hand is made from.
struct TrainingRun {
  std::filesystem::path catalogue;
  std::filesystem::path grasps;  // the robot's: read, or made if missing
  bool close_again = false;      // make them, though the file is there
  ClosureOptions closures;       // of a made_for: what was made for another hand is made anew
  SetOptions people;
  TrainerOptions trainer;                     // its seed, precision and places are worked out
  std::vector<std::filesystem::path> taught;  // sets of `prehend teach`
  std::filesystem::path set_file;             // not empty: what is learnt from is written there
};

struct TrainedMapping {
  std::vector<RobotGrasp> grasps;
  Sets sets;
  MappingModel model;
};

/// Reads all that it names, makes the people, and trains. The model is not saved yet.
Expected<TrainedMapping> run_training(const TrainingRun& run, const model::HandModel& hand,
                                      const Scheme& scheme, const grasping::ForEach& for_each,
                                      const Progress& progress);

}  // namespace prehend::mapping
