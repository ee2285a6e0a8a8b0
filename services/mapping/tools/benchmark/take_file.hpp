#pragma once

#include <filesystem>
#include <vector>

#include "common/base/error.hpp"
#include "common/model/hand_model.hpp"
#include "services/mapping/tools/judging/grasp_benchmark.hpp"

namespace prehend::mapping {

/// The take as everybody reads it from its messages.
BenchmarkTake as_read(BenchmarkTake take);

/// Writes a take as a recording (MCAP): hand/posture at 30 Hz, object/detection at 10 Hz of the
/// object where it stands, from 2026 on; and, sealed beside them, what its judge must know.
Expected<void> save_take(const std::filesystem::path& file, const model::HandModel& hand,
                         const BenchmarkTake& take);

/// Reads what save_take() wrote, with hand/posture as it is in the file. Refuses what is damaged or
/// was made for another hand.
Expected<BenchmarkTake> load_take(const std::filesystem::path& file, const model::HandModel& hand);

/// The usable hand/posture of a recording, by time from the first. Fails where there is none.
Expected<std::vector<Posture>> read_postures(const std::filesystem::path& file);

/// All of a folder (*.mcap), by number. Fails where there is none, and where one is twice.
Expected<std::vector<BenchmarkTake>> load_takes(const std::filesystem::path& folder,
                                                const model::HandModel& hand);

}  // namespace prehend::mapping
