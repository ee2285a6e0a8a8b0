#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/grasping/catalogue_bodies.hpp"
#include "common/grasping/table_grasps.hpp"
#include "common/model/detection.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::planner {

/// What was found for a hand and an object.
struct Plan {
  grasping::Body object;
  std::vector<grasping::SureGrasp> grasps;
  bool complete = false;
  std::string reason;  // why there is no grasp; empty while there is one, or hope
};

/// The same for something that is seen.
struct TrackPlan {
  model::Detection seen;  // as it was when it was planned for
  Plan plan;
};

/// Where plans are kept that took seconds to make: by the object, of one hand.
struct PlanStore {
  std::function<std::optional<Plan>(const grasping::Body&)> recall = [](const grasping::Body&) {
    return std::nullopt;
  };
  std::function<void(const Plan&)> keep = [](const Plan&) {};
};

struct PlanBookOptions {
  double min_probability = 0.6;  // of a detection that counts, 0 to 1
  /// m: an object whose size is no further from the planned one needs no other plan.
  double same_size = 0.003;
  grasping::SearchOptions search;
};

/// Which objects are seen, and what has been planned for each. Objects that are alike share a
/// plan. Pure: whoever has it searches when he wants, round by round. Keeps references to the hand
/// and the catalogue.
class PlanBook {
 public:
  PlanBook(const model::HandModel& hand, const grasping::CatalogueBodies& catalogue,
           PlanStore store = {}, const PlanBookOptions& options = {});

  /// Refuses what is not finite, has no shape, is not probable enough, does not stand, or is older
  /// than what is known of this track. The error's `what` is a short reason to count.
  Expected<void> observe(const model::Detection& seen);
  void remove(std::uint32_t track);

  /// What is searched next: a round for the object of which least has been searched. Nothing: all
  /// that is seen has its plan. The search may go on in another thread, one round at a time.
  struct Work {
    std::string object;  // its key in this book
    std::shared_ptr<grasping::TableGraspSearch> search;
  };
  std::optional<Work> next() const;
  /// A round has been searched; more: try_next() said that there is more to try.
  void searched(const Work& work, bool more);

  /// What has become known since it was last asked, a plan a track.
  std::vector<TrackPlan> news();

 private:
  struct Entry {
    Plan plan;
    std::shared_ptr<grasping::TableGraspSearch> search;  // none: complete
    int rounds = 0;
    int version = 0;  // of the plan; 0: nothing is known
  };
  Entry* find(const std::string& key);
  /// Makes room for one more that is not seen now.
  void forget_one();
  /// What is planned for: from the catalogue where it is there, else estimated.
  grasping::Body body_of(const model::Detection& seen) const;

  const model::HandModel& hand_;
  const grasping::CatalogueBodies& catalogue_;
  PlanStore store_;
  PlanBookOptions options_;
  std::map<std::string, Entry> entries_;            // by key
  std::map<std::uint32_t, model::Detection> seen_;  // newest
  std::map<std::uint32_t, std::string> key_of_;     // what each track was planned as
  std::map<std::uint32_t, int> told_;               // version of the entry that was told
};

}  // namespace prehend::planner
