#include "services/mapping/tools/study/grasp_benchmark.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <mutex>
#include <utility>

#include "common/analysis/contact_wrenches.hpp"
#include "common/analysis/resistance.hpp"
#include "common/grasping/hold_test.hpp"
#include "common/grasping/world.hpp"

namespace prehend::mapping {

namespace {

using Eigen::Vector3d;

constexpr Duration camera_period = std::chrono::milliseconds(100);
constexpr Duration state_period = std::chrono::milliseconds(10);

MappingOptions mapping_options(const BenchmarkedMode& mode) {
  MappingOptions options;
  options.modes.intelligent = mode.mode == BenchmarkMode::intelligent;
  options.modes.placement = mode.placement;
  if (const auto fingers = finger_modes.value(to_string(mode.mode)))
    options.modes.fingers = *fingers;
  return options;
}

/// One take answered by one mode in a world of its own.
class Trial {
 public:
  Trial(const BenchmarkedHand& parts, const RobotGrasp& grasp, const RecordedTake& take,
        Mapping mapping, std::unique_ptr<grasping::World> world)
      : parts_(parts),
        grasp_(grasp),
        take_(take),
        mapping_(std::move(mapping)),
        world_(std::move(world)) {}

  void run(TrialResult& result) {
    const Duration step = seconds(world_->time_step());
    std::size_t next = 0;
    // A person keeps the fingers closed until the robot's have come to rest.
    for (Time now{}; next < take_.postures.size() && !(now > take_.closed && at_rest(now));
         now += step) {
      if (now.time_since_epoch() % camera_period < step) see(now);
      if (now.time_since_epoch() % state_period < step) feel(now);
      if (now >= take_.postures[next].stamp) {
        const auto command = mapping_.on_posture(take_.postures[next++], now);
        if (command && !world_->command(command->X_WB, command->dof)) {
          result.reason = "command refused";
          return;
        }
      }
      world_->step();
    }
    measure(result);
    grasping::HoldOptions hold;
    hold.shake = true;
    const auto verdict = grasping::hold_test(*world_, 0, hold);
    result.held = verdict.held;
    result.reason = verdict.reason;
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

  void see(Time now) {
    Detection detection;
    detection.track = 1;
    detection.name = grasp_.object;
    detection.shape = take_.seen_shape;
    detection.X_WO = world_->body_motion(0).X_WO * take_.X_OS;
    detection.probability = 0.95;
    detection.stamp = now;
    detection.covariance = take_.covariance;
    (void)mapping_.on_detection(detection);  // modes that know no objects are told all the same
  }

  void feel(Time now) {
    const grasping::HandMotion motion = world_->hand_motion();
    (void)mapping_.on_state({now, motion.dof, motion.velocity, motion.torque, motion.X_WB});
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

    const auto contacts = world_->contacts(0);
    for (const analysis::Contact& contact : contacts)
      result.penetration = std::max(result.penetration, contact.depth);
    if (contacts.size() < 2) return;
    if (const auto resistance = analysis::l1_resistance(
            analysis::contact_wrenches(analysis::spread_contacts(contacts, analysis::max_contacts),
                                       grasping::torque_scale(world_->body(0)))))
      result.epsilon = resistance->epsilon;
  }

  const BenchmarkedHand& parts_;
  const RobotGrasp& grasp_;
  const RecordedTake& take_;
  Mapping mapping_;
  std::unique_ptr<grasping::World> world_;
  Eigen::VectorXd joint_;  // when it last moved
  Time moved_{};
};

Expected<std::unique_ptr<grasping::World>> world_of(const BenchmarkedHand& parts,
                                                    const RobotGrasp& grasp,
                                                    const RecordedTake& take) {
  const model::CatalogueObject* object = parts.catalogue.find(grasp.object);
  if (!object) return fail("is not in the catalogue", grasp.object);
  const Posture& first = take.postures.front();
  const Pose X_WG = first.X_WH * model::HumanHand(first.hand_scale).X_HG();
  auto world = grasping::World::create(parts.hand, X_WG * parts.hand.X_BG().inverse(),
                                       parts.hand.postures().at("open"));
  if (!world) return world;
  auto added = (*world)->add_body(
      {object->name, object->shape, object->mass, object->material, {}, {}}, take.X_WO);
  if (!added) return tl::unexpected(added.error());
  return world;
}

}  // namespace

std::string_view to_string(BenchmarkMode mode) {
  return benchmark_modes.name(mode);
}

Expected<std::vector<TrialResult>> run_grasp_benchmark(
    const BenchmarkedHand& parts, const GraspBenchmarkOptions& options,
    const grasping::ForEach& for_each, const std::function<void(double)>& progress) {
  if (parts.grasps.empty()) return fail("there is no grasp to repeat", parts.hand.name());
  for (const BenchmarkedMode& mode : options.modes)
    if (auto allowed = Mapping::create(parts.hand, parts.model, mapping_options(mode)); !allowed)
      return tl::unexpected(allowed.error());

  std::vector<std::optional<TrialResult>> results(static_cast<std::size_t>(options.trials) *
                                                  options.modes.size());
  std::mutex mutex;
  std::size_t done = 0;
  Error failed;
  for_each(results.size(), [&](std::size_t index) {
    // Modes of the same take stand together.
    const std::size_t number = index / options.modes.size();
    const BenchmarkedMode& mode = options.modes[index % options.modes.size()];
    const RobotGrasp& grasp = parts.grasps[number % parts.grasps.size()];
    // People whose hand does not fit around the object are replaced.
    std::optional<RecordedTake> take;
    constexpr std::uint64_t max_people = 100;
    for (std::uint64_t person = 0; person < max_people && !take; ++person)
      take = record_take(grasp, options.seed + max_people * number + person, options.take);
    if (take) {
      auto world = world_of(parts, grasp, *take);
      TrialResult result;
      result.hand = parts.hand.name();
      result.object = grasp.object;
      result.grasp_type = to_string(grasp.type);
      result.user = take->user;
      result.take = static_cast<int>(number);
      result.mode = mode;
      result.demonstrated_held = grasp.held;
      if (world) {
        auto mapping = Mapping::create(parts.hand, parts.model, mapping_options(mode));
        Trial(parts, grasp, *take, std::move(*mapping), std::move(*world)).run(result);
        results[index] = std::move(result);
      } else {
        const std::lock_guard lock(mutex);
        failed = world.error();
      }
    }
    const std::lock_guard lock(mutex);
    if (progress) progress(static_cast<double>(++done) / static_cast<double>(results.size()));
  });
  if (!failed.what.empty()) return tl::unexpected(failed);
  std::vector<TrialResult> all;
  for (auto& result : results)
    if (result) all.push_back(std::move(*result));
  return all;
}

}  // namespace prehend::mapping
