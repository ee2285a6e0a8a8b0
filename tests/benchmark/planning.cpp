// What planning a way of an arm costs, on tables that are drawn, and how many of them are solved.
// One thread, processor time. What no branch of the inverse kinematics can do is not counted as a
// way to be found.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <map>
#include <vector>

#include "tests/support/planning/tables.hpp"

using namespace prehend;

namespace {

struct Tally {
  std::vector<double> times;  // ms, of those that were solved
  int lost = 0, impossible = 0;
  std::map<std::string, int> reasons;

  void tell(const char* what) {
    std::sort(times.begin(), times.end());
    const auto at = [&](double share) {
      return times.empty() ? 0 : times[static_cast<std::size_t>(share * (times.size() - 1))];
    };
    fmt::print(
        "{}: {} solved, {} without a way, {} that no branch can do; ms p50 {:.2f} p95 {:.2f} "
        "worst {:.2f}\n",
        what, times.size(), lost, impossible, at(0.5), at(0.95), at(1));
    for (const auto& [reason, count] : reasons) fmt::print("  {:4} {}\n", count, reason);
  }
};

Expected<planning::Trajectory> counted(const planning::Robot& robot, const planning::Query& query,
                                       Tally& tally) {
  const std::clock_t begin = std::clock();
  auto made = planning::plan(robot, query);
  const double ms = 1000.0 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  if (made)
    tally.times.push_back(ms);
  else if (made.error().what.starts_with("no way"))
    ++tally.lost;
  else
    ++tally.impossible;
  if (!made) ++tally.reasons[made.error().what.substr(0, 60)];
  return made;
}

}  // namespace

int main(int argc, char** argv) {
  const int scenes = argc > 1 ? std::atoi(argv[1]) : 200;
  const planning::Robot robot = test::puma_with("barrett");
  Tally reaches, carries;
  for (int seed = 1; seed <= scenes; ++seed) {
    const auto reach = test::drawn_reach(robot, static_cast<std::uint64_t>(seed));
    const auto there = counted(robot, reach, reaches);
    if (!there) continue;
    Pose lifted = reach.then.front();
    lifted.translation().z() += 0.08;
    const planning::Room room(robot, {}, {.hand_clearance = 0.001});
    const auto grasp =
        planning::straight_way(robot, room, there->at(there->duration()), reach.then.front());
    if (!grasp) continue;
    const auto up = planning::straight_way(robot, room, grasp->back(), lifted);
    if (!up) continue;
    counted(robot, test::drawn_carry(robot, reach, up->back(), static_cast<std::uint64_t>(seed)),
            carries);
  }
  reaches.tell("reach");
  carries.tell("carry upright");
}
