#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/model/grasp_taxonomy.hpp"
#include "services/demonstration/core/recognition/hand_sample.hpp"

namespace prehend::demonstration {

/// The kinds of grasps that recognition is measured by, of Cutkosky's sixteen.
inline constexpr std::array<std::string_view, 10> measured_kinds{
    "large diameter", "medium wrap",      "small diameter", "power sphere",   "power disk",
    "lateral pinch",  "precision sphere", "tripod",         "thumb-4 finger", "thumb-index finger"};

struct DrawOptions {
  int people = 20;         // that are drawn
  int trials = 6;          // of each kind, by each of them
  std::uint64_t seed = 1;  // the same draws the same people
};

/// Takes of people who do not exist. Each has a hand of a size that hands have, habits of his own,
/// sensors that sit a little beside his fingertips; each object has a size of its own, and each
/// take its noise. From first touch to lift, as in the real ones. Fails on kinds that the taxonomy
/// does not have.
Expected<std::vector<Take>> drawn_takes(const model::GraspTaxonomy& taxonomy,
                                        const DrawOptions& options);

}  // namespace prehend::demonstration
