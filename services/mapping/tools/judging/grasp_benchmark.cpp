#include "services/mapping/tools/judging/grasp_benchmark.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <numeric>
#include <utility>

#include "common/analysis/contact_wrenches.hpp"
#include "common/analysis/resistance.hpp"
#include "common/grasping/catalogue_bodies.hpp"
#include "common/grasping/hold_test.hpp"
#include "common/grasping/world.hpp"
#include "services/mapping/tools/judging/planned_grasps.hpp"

namespace prehend::mapping {

namespace {

using Eigen::Vector3d;

constexpr Duration camera_period = std::chrono::milliseconds(100);
constexpr Duration state_period = std::chrono::milliseconds(10);

/// One take answered by one mode in a world of its own.
class Trial {
 public:
  Trial(const BenchmarkedHand& parts, const BenchmarkTake& take, Answerer& answerer,
        std::unique_ptr<grasping::World> world, gate::CommandGate gate)
      : parts_(parts),
        whole_(take),
        grasp_(take.grasp),
        take_(take.recorded),
        answerer_(answerer),
        world_(std::move(world)),
        gate_(std::move(gate)) {}

  void run(TrialResult& result) {
    const Duration step = seconds(world_->time_step());
    std::size_t next = 0;
    // A person keeps the fingers closed until the robot's have come to rest.
    for (Time now{}; next < take_.postures.size() && !(now > take_.closed && at_rest(now));
         now += step) {
      Told told;
      if (now.time_since_epoch() % camera_period < step)
        told.detection = seen_object(whole_, world_->body_motion(0).X_WO, now);
      if (now.time_since_epoch() % state_period < step) told.state = felt(now);
      if (now >= take_.postures[next].stamp) told.posture = take_.postures[next++];
      const auto commands = answerer_.answer(told, now);
      if (!commands) {
        result.reason = commands.error().message();
        return;
      }
      for (const gate::Command& command : *commands) obey(command, now);
      world_->step();
    }
    measure(result);
    grasping::HoldOptions hold;
    hold.shake = true;
    const auto verdict = grasping::hold_test(*world_, 0, hold);
    result.held = verdict.held;
    result.reason = obeyed_ || refused_.empty() ? verdict.reason : refused_;
  }

 private:
  /// The joints have kept their place for 0.3 s, as the judge of the simulation wants it.
  bool at_rest(Time now) {
    constexpr double still = 0.05 * 0.3;  // rad
    const grasping::HandMotion motion = world_->hand_motion();
    for (std::size_t i = 0; i < parts_.hand.joints().size(); ++i) {
      const auto dof = static_cast<std::size_t>(parts_.hand.joints()[i].dof);
      const double unit = model::radian_of(parts_.hand.dofs()[dof]);
      const auto k = static_cast<Eigen::Index>(i);
      if (joint_.size() > 0 && std::abs(motion.joint[k] - joint_[k]) <= still * unit) continue;
      joint_ = motion.joint;
      moved_ = now;
      break;
    }
    return now - moved_ > std::chrono::milliseconds(300);
  }

  void obey(const gate::Command& command, Time now) {
    const auto passed = gate_.admit(command, now);
    if (!passed)
      refused_ = gate::to_string(passed.error());
    else if (const auto limited = world_->limit_effort(passed->place.effort); !limited)
      refused_ = limited.error().message();
    else if (const auto done = world_->command(passed->place.X_WB, passed->place.dof); !done)
      refused_ = done.error().message();
    else
      obeyed_ = true;
  }

  RobotState felt(Time now) const {
    const grasping::HandMotion motion = world_->hand_motion();
    return {now, motion.dof, motion.velocity, motion.torque, motion.X_WB};
  }

  void measure(TrialResult& result) const {
    const grasping::HandMotion motion = world_->hand_motion();
    result.joint_error = (motion.dof - grasp_.dof).squaredNorm();
    const Pose X_OB = world_->body_motion(0).X_WO.inverse() * motion.X_WB;
    const Pose X_OB_shown = grasp_.X_OR() * parts_.hand.X_BG().inverse();
    const auto tips = parts_.hand.fingertip_positions(motion.dof);
    const auto shown = parts_.hand.fingertip_positions(grasp_.dof);
    double sum = 0;
    for (std::size_t i = 0; i < tips.size(); ++i)
      sum += (X_OB * tips[i] - X_OB_shown * shown[i]).norm();
    result.fingertip_error = tips.empty() ? 0 : sum / static_cast<double>(tips.size());

    const auto contacts = grasping::about_centre_of_mass(world_->contacts(0), world_->body(0));
    for (const analysis::Contact& contact : contacts)
      result.penetration = std::max(result.penetration, contact.depth);
    if (contacts.size() < 2) return;
    if (const auto resistance = analysis::l1_resistance(
            analysis::contact_wrenches(analysis::spread_contacts(contacts, analysis::max_contacts),
                                       grasping::torque_scale(world_->body(0)))))
      result.epsilon = resistance->epsilon;
  }

  const BenchmarkedHand& parts_;
  const BenchmarkTake& whole_;
  const RobotGrasp& grasp_;
  const RecordedTake& take_;
  Answerer& answerer_;
  std::unique_ptr<grasping::World> world_;
  gate::CommandGate gate_;
  bool obeyed_ = false;
  std::string refused_;    // why the last command that was not obeyed was not
  Eigen::VectorXd joint_;  // when it last moved
  Time moved_{};
};

Expected<std::unique_ptr<grasping::World>> world_of(const BenchmarkedHand& parts,
                                                    const RobotGrasp& grasp,
                                                    const RecordedTake& take) {
  const grasping::Body* object = parts.objects.find(grasp.object);
  if (!object) return fail("is not in the catalogue", grasp.object);
  const Posture& first = take.postures.front();
  const Pose X_WG = first.X_WH * model::HumanHand(first.hand_scale).X_HG();
  auto world = grasping::World::create(parts.hand, X_WG * parts.hand.X_BG().inverse(),
                                       parts.hand.postures().at("open"));
  if (!world) return world;
  auto added = (*world)->add_body(*object, take.X_WO);
  if (!added) return tl::unexpected(added.error());
  return world;
}

}  // namespace

MappingOptions mapping_options(const BenchmarkedMode& mode) {
  MappingOptions options;
  options.modes.intelligent =
      mode.mode == BenchmarkMode::intelligent || mode.mode == BenchmarkMode::planned;
  options.modes.placement = mode.placement;
  if (const auto fingers = finger_modes.value(to_string(mode.mode)))
    options.modes.fingers = *fingers;
  return options;
}

Detection seen_object(const BenchmarkTake& take, const Pose& X_WO, Time now) {
  Detection detection;
  detection.track = 1;
  detection.name = take.grasp.object;
  detection.shape = take.recorded.seen_shape;
  detection.X_WO = X_WO * take.recorded.X_OS;
  detection.probability = 0.95;
  detection.stamp = now;
  detection.covariance = take.recorded.covariance;
  return detection;
}

std::optional<BenchmarkTake> make_take(const std::vector<RobotGrasp>& grasps,
                                       const GraspBenchmarkOptions& options, int number) {
  constexpr std::uint64_t max_people = 100;
  const auto turn = static_cast<std::uint64_t>(number);
  const RobotGrasp& grasp = grasps[turn % grasps.size()];
  // People whose hand does not fit around the object are replaced.
  for (std::uint64_t person = 0; person < max_people; ++person)
    if (auto take = record_take(grasp, options.seed + max_people * turn + person, options.take))
      return BenchmarkTake{number, grasp, std::move(*take), false};
  return std::nullopt;
}

Expected<TrialResult> judge_take(const BenchmarkedHand& parts, const BenchmarkTake& take,
                                 const BenchmarkedMode& mode, Answerer& answerer) {
  auto world = world_of(parts, take.grasp, take.recorded);
  if (!world) return tl::unexpected(world.error());
  const grasping::World& there = **world;
  auto gate = gate::CommandGate::create(
      parts.hand, {.hand = benchmarked_hand_name}, gate::limits_of(parts.hand), [&there] {
        return gate::Place{there.commanded_dof(), there.commanded_base()};
      });
  if (!gate) return tl::unexpected(gate.error());
  TrialResult result;
  result.hand = parts.hand.name();
  result.object = take.grasp.object;
  result.grasp_type = to_string(take.grasp.type);
  result.user = take.recorded.user;
  result.take = take.number;
  result.real = take.real;
  result.mode = mode;
  result.demonstrated_held = take.grasp.held;
  Trial(parts, take, answerer, std::move(*world), std::move(*gate)).run(result);
  return result;
}

std::string_view to_string(BenchmarkMode mode) {
  return benchmark_modes.name(mode);
}

std::vector<int> first_takes(int count) {
  std::vector<int> takes(static_cast<std::size_t>(count));
  std::iota(takes.begin(), takes.end(), 0);
  return takes;
}

Expected<void> check_mode(const BenchmarkedHand& parts, const BenchmarkedMode& mode) {
  const auto mapping = Mapping::create(parts.hand, parts.model, mapping_options(mode));
  if (!mapping) return tl::unexpected(mapping.error());
  return {};
}

static Expected<std::optional<TrialResult>> answer_take(const BenchmarkedHand& parts,
                                                        const GraspBenchmarkOptions& options,
                                                        int number, const BenchmarkedMode& mode,
                                                        PlannedGrasps& planned) {
  const auto take = make_take(parts.grasps, options, number);
  if (!take) return std::nullopt;
  auto mapping = planned.mapping_for(parts, mode, *take);
  if (!mapping) return tl::unexpected(mapping.error());
  OwnMapping own(parts.hand, std::move(*mapping));
  auto result = judge_take(parts, *take, mode, own);
  if (!result) return tl::unexpected(result.error());
  return std::move(*result);
}

Expected<std::vector<TrialResult>> run_grasp_benchmark(const BenchmarkedHand& parts,
                                                       const GraspBenchmarkOptions& options,
                                                       const grasping::ForEach& for_each,
                                                       const OnTrial& on_trial) {
  if (parts.grasps.empty())
    return fail("there is no grasp to repeat", parts.hand.name(),
                "prehend train --hand HAND finds the grasps that are repeated");
  for (const BenchmarkedMode& mode : options.modes)
    if (auto allowed = check_mode(parts, mode); !allowed) return tl::unexpected(allowed.error());

  std::vector<std::optional<TrialResult>> results(options.takes.size() * options.modes.size());
  PlannedGrasps planned(parts.hand, parts.objects);
  std::mutex mutex;
  Error failed;
  for_each(results.size(), [&](std::size_t index) {
    // Modes of the same take stand together.
    const int number = options.takes[index / options.modes.size()];
    const BenchmarkedMode& mode = options.modes[index % options.modes.size()];
    auto result = answer_take(parts, options, number, mode, planned);
    const std::lock_guard lock(mutex);
    if (!result) {
      failed = result.error();
      return;
    }
    if (on_trial) on_trial(mode, number, *result);
    results[index] = std::move(*result);
  });
  if (!failed.what.empty()) return tl::unexpected(failed);
  std::vector<TrialResult> all;
  for (auto& result : results)
    if (result) all.push_back(std::move(*result));
  return all;
}

}  // namespace prehend::mapping
