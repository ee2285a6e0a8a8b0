#include "services/demonstration/tools/trials/trial.hpp"

#include <algorithm>

#include "common/base/random.hpp"
#include "common/model/placement.hpp"
#include "services/demonstration/core/person/table.hpp"
#include "services/demonstration/core/rehearsal/rehearsal.hpp"
#include "services/demonstration/core/tasks/learn_task.hpp"

namespace prehend::demonstration {

namespace {

constexpr double rate = 30;  // Hz, of the glove
constexpr int frames_a_picture = 3;
constexpr double hand_noise = 0.0015;                       // m
constexpr double object_noise = 0.002;                      // m
constexpr double world_noise = 0.001, world_turn = 0.0175;  // m, rad
constexpr double max_place_error = 0.01;                    // m, of what was understood
constexpr double longest = 120;                             // s, of a task
constexpr std::uint64_t elsewhere = 1000;

const Time beginning = Time(seconds(1'000'000));

/// Objects that the hand can take, in an order drawn from the seed.
std::vector<std::string> drawn_objects(const model::HandModel& hand,
                                       const model::Catalogue& catalogue, int count,
                                       Random& random) {
  std::vector<std::string> names;
  for (const model::CatalogueObject& object : catalogue.objects())
    if (model::nearest_grasp(object.shape, Pose::Identity(), hand.reach()))
      names.push_back(object.name);
  for (std::size_t i = names.size(); i > 1; --i) std::swap(names[i - 1], names[random.index(i)]);
  names.resize(std::min(names.size(), static_cast<std::size_t>(count)));
  return names;
}

Thing thing_of(const model::PlacedObject& placed, const model::Catalogue& catalogue) {
  const model::CatalogueObject& known = *catalogue.find(placed.name);
  return {{known.name, known.shape, known.mass, known.material, {}, {}}, placed.X_WO};
}

/// Where things truly stand.
std::vector<Thing> disturbed(std::vector<Thing> things, Random& random) {
  for (Thing& thing : things) {
    const Eigen::AngleAxisd turn(random.normal(world_turn), Eigen::Vector3d::UnitZ());
    Eigen::Vector3d shift = random.normal3(world_noise);
    shift.z() = 0;
    thing.X_WO = make_pose(thing.X_WO.translation() + shift, turn * thing.X_WO.linear());
  }
  return things;
}

bool is_right(const TaskModel& task, const std::vector<Transfer>& transfers) {
  return task.steps.size() == transfers.size() &&
         std::equal(task.steps.begin(), task.steps.end(), transfers.begin(),
                    [](const Step& step, const Transfer& transfer) {
                      return step.object == transfer.object && step.reference == the_table &&
                             (step.X_RO.translation() - transfer.to).norm() < max_place_error;
                    });
}

void perform(const model::HandModel& hand, const TaskModel& task, const std::vector<Thing>& things,
             std::uint64_t seed, const std::optional<planning::Robot>& robot, TaskTrial& trial) {
  HandGoal from{make_pose({0, -0.4, 0.6}), hand.postures().at("open")};
  std::unique_ptr<carrying::CarryingArm> arm;
  RehearsalOptions how;
  if (robot) {
    how.robot = robot;
    how.posture = robot->arm->home;
    auto made = arm_of(*robot, robot->arm->home);
    if (!made) {
      trial.reason = made.error().message();
      return;
    }
    arm = std::move(*made);
    from.X_WB = arm->home();
  }
  const auto rehearsed = rehearse(hand, task, things, from, how);
  if (!rehearsed) {
    trial.reason = rehearsed.error().message();
    return;
  }
  trial.rehearsed = true;
  Random random(seed * 31 + 7);
  const std::vector<Thing> truth = disturbed(things, random);
  grasping::WorldOptions physics;
  if (arm) physics.base = carrying::CarryingArm::base();
  auto world = grasping::World::create(hand, from.X_WB, from.dof, physics);
  if (!world) return;
  for (const Thing& thing : truth) (*world)->add_body(thing.body, thing.X_WO);
  auto performer = TaskPerformer::create(hand, task, shapes_of(things), places_of(**world),
                                         rehearsed->grasps, from, {}, {}, {robot});
  if (!performer) {
    trial.reason = performer.error().message();
    return;
  }
  if (const auto performed = perform_in(**world, *performer, longest, arm.get()); !performed) {
    trial.reason = performed.error().message();
    return;
  }
  trial.done = performer->done();
  trial.reason = performer->reason();
  for (const Verdict& verdict : performer->verdicts()) {
    trial.max_error = std::max(trial.max_error, verdict.error);
    trial.max_turn = std::max(trial.max_turn, verdict.turn);
  }
}

}  // namespace

Expected<Demonstration> watched(const Person& person, const std::string& task, std::uint64_t seed) {
  Watcher watcher{WatcherOptions{}};
  if (auto begun = watcher.begin(task, beginning); !begun) return tl::unexpected(begun.error());
  Random random(seed);
  for (int n = 0; n / rate < person.duration(); ++n) {
    const double t = n / rate;
    const Time now = beginning + seconds(t);
    if (n % frames_a_picture == 0)
      for (const Person::ObjectThen& object : person.objects(t)) {
        if (object.hidden) continue;
        Pose X_WO = object.X_WO;
        X_WO.pretranslate(random.normal3(object_noise));
        if (auto seen = watcher.see(SeenObject{now, object.name, object.shape, X_WO}); !seen)
          return tl::unexpected(seen.error());
      }
    const Person::HandThen then = person.hand(t);
    const auto tips = person.model().fingertip_poses(model::HumanHand::posture(then.closure));
    SeenHand hand{now, then.X_WH, person.model().scale(), {}};
    hand.X_WH.pretranslate(random.normal3(hand_noise));
    for (std::size_t f = 0; f < tips.size(); ++f)
      hand.p_HF[f] = tips[f].translation() + random.normal3(hand_noise);
    if (auto seen = watcher.see(hand, ""); !seen) return tl::unexpected(seen.error());
  }
  std::vector<TimedSegment> rest;
  return watcher.end(beginning + seconds(person.duration()), rest);
}

TaskTrial try_task(const model::HandModel& hand, const model::Catalogue& catalogue, int steps,
                   std::uint64_t seed, const std::optional<planning::Robot>& robot) {
  TaskTrial trial{.steps = steps};
  const auto refuse = [&](const Error& error) {
    trial.reason = error.message();
    return trial;
  };
  Random random(seed * 7919 + static_cast<std::uint64_t>(steps));
  TableOptions table{.objects = drawn_objects(hand, catalogue, steps, random),
                     .apart = 0.24,
                     .half_width = 0.45,
                     .half_depth = 0.32};
  if (robot) reachable(table);
  auto shown = drawn_table(catalogue, seed, table);
  if (!shown) return refuse(shown.error());
  shown->demonstrator.reach = hand.reach();
  std::vector<Transfer> transfers;
  for (const std::string& name : table.objects) {
    const auto place = free_place(*shown, seed + transfers.size(), table);
    if (!place) return refuse(place.error());
    table.free.push_back(*place);
    const double z = model::half_extents(catalogue.find(name)->shape).z();
    transfers.push_back({name, {place->x(), place->y(), z}, 0});
  }
  const auto person = Person::create(*shown, catalogue, transfers, seed);
  if (!person) return refuse(person.error());
  const auto seen = watched(*person, "trial", seed);
  if (!seen) return refuse(seen.error());
  const auto task = learn_task("trial", {seen->steps});
  if (!task) return refuse(task.error());
  trial.understood = is_right(*task, transfers);
  if (!trial.understood) {
    trial.reason = "other steps were understood";
    return trial;
  }
  const auto again = drawn_table(catalogue, seed + elsewhere, table);
  if (!again) return refuse(again.error());
  std::vector<Thing> things;
  for (const model::PlacedObject& placed : again->objects)
    things.push_back(thing_of(placed, catalogue));
  perform(hand, *task, things, seed, robot, trial);
  return trial;
}

}  // namespace prehend::demonstration
