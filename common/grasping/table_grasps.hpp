#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/grasping/planner.hpp"
#include "common/grasping/table_closing.hpp"
#include "common/model/past_contact.hpp"

namespace prehend::grasping {

/// A grasp of an object that stands on a table, and how surely it holds.
struct SureGrasp {
  /// The approach that it answers: what model::nearest_grasp says of a hand that comes from there.
  /// The hand's own grasp frame stands near it, at grasp.X_OG.
  Pose X_OG = Pose::Identity();
  TableGrasp grasp;
  /// Share of small errors with which it holds as well, 0 to 1: the hand 3 mm and 2° beside its
  /// place, an object 20 % smaller or larger than was said, or half as heavy again.
  double room = 0;
  /// How far the mapping's fingers may go on past where they touch until they are stopped, rad: 0
  /// where it is sure as it is, and lost when they press on.
  double follow_through = model::full_follow_through;
  int tried = 0;  // which attempt of its approach it was, from 0
};

struct SearchOptions {
  int attempts = 24;  // of each approach, at most, 1 to 1000
  int at_once = 3;    // of these in each round
  /// Of an approach that has a grasp with so much room no better one is looked for;
  double enough = 0.85;
  /// nor after so many of its grasps were judged by small errors.
  int judged = 4;
};

/// Looks for grasps of an object that stands on a table, from each approach, as the mapping closes
/// a hand: places, turns and preshapes near what is usual, the likeliest first. Each is closed on
/// the object, then from the open hand on the table, lifted, held and shaken; those that hold are
/// judged by small errors; what is sure, once more with fingers that go on. Goes on round by round,
/// so that the first grasps are known soon. The same for the same hand and object however the work
/// is divided. Keeps a reference to the hand.
class TableGraspSearch {
 public:
  /// Fails on objects that cannot be, and on options out of their range.
  static Expected<TableGraspSearch> create(const model::HandModel& hand, const Body& object,
                                           const SearchOptions& options = {});

  /// A round: of every approach that has none yet that is sure enough, judges the grasp that was
  /// found, or else tries the next; of one that has, looks whether its fingers may go on. False
  /// when there is nothing more to do.
  bool try_next(const ForEach& for_each);

  /// The surest grasp that was found of each approach, one without room if none is judged yet;
  /// those with the most room first.
  std::vector<SureGrasp> found() const;
  /// How many attempts came to nothing, by reason.
  const std::map<std::string, int>& refused() const { return refused_; }
  int attempts() const { return attempts_; }

 private:
  struct Approach {
    Pose X_OG;
    std::vector<TableApproach> untried;  // in order
    std::size_t next = 0;
    std::vector<SureGrasp> unjudged;  // these hold; in order
    std::vector<SureGrasp> best;      // none or one
    int judged = 0;
    bool pressed = false;  // the best was closed with fingers that go on
    bool is_sure(const SearchOptions& options) const;
    bool is_searched(const SearchOptions& options) const;
    bool is_done(const SearchOptions& options) const;
  };
  struct Task;
  TableGraspSearch(const model::HandModel& hand, const Body& object, const SearchOptions& options)
      : hand_(hand), object_(object), options_(options) {}
  std::vector<Task> next_round();
  void work_on(Task& task) const;
  void judge(Approach& approach, const std::vector<char>& held);
  static void press(Approach& approach, const std::vector<char>& held);

  const model::HandModel& hand_;
  Body object_;
  SearchOptions options_;
  std::vector<Approach> approaches_;
  std::map<std::string, int> refused_;
  int attempts_ = 0;
};

}  // namespace prehend::grasping
