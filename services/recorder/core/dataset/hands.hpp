#pragma once

#include "services/recorder/core/dataset/rows.hpp"

namespace prehend::recorder::dataset {

/// What a recording says of one of its hands. log must outlive it, and hand, where it is known.
struct HandLog {
  std::string name;
  const RecordingLog* log = nullptr;
  const model::HandModel* hand = nullptr;
};

/// Episodes in which all these hands are led, by the rules of find_episodes() for what was judged
/// of any of them. What several of them grasp one after the other is one episode, to its very end:
/// they carry it, or hand it over. None if they are never led together.
std::vector<Episode> find_episodes(const std::vector<HandLog>& hands);

/// An episode with hands side by side, in their order: state, action, rate and effort of all in one
/// row, and features of each hand and its glove, with the hand's name before them; arm and objects
/// once. Of one hand alone: make_rows(). Fails as that, and where they are not led at the same
/// time.
Expected<Rows> make_rows(const std::vector<HandLog>& hands, const Episode& episode,
                         const RowOptions& options);

}  // namespace prehend::recorder::dataset
