#include "services/demonstration/tools/performing/performing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <optional>
#include <thread>

#include "common/base/log.hpp"
#include "common/convert/convert.hpp"
#include "common/dds/topics.hpp"
#include "common/model/arm_choice.hpp"
#include "common/model/catalogue.hpp"
#include "common/model/grasp_taxonomy.hpp"
#include "services/demonstration/core/rehearsal/rehearsal.hpp"

namespace prehend::demonstration {

namespace {

constexpr Duration tick_period = std::chrono::milliseconds(20);
constexpr Duration look_time = std::chrono::seconds(10);          // for what must be there
constexpr Duration look_around = std::chrono::milliseconds(500);  // for what else there is
constexpr Duration max_step = std::chrono::milliseconds(20);      // from one state to the next
constexpr Duration silence = std::chrono::seconds(2);             // of the robot
constexpr Duration refused_time = std::chrono::seconds(3);  // until it must move as it is told
constexpr Duration progress_period = std::chrono::milliseconds(100);
constexpr Duration farewell = std::chrono::milliseconds(300);  // so that all hear how it ended

v1::StepPart to_message(StepPart part) {
  constexpr std::array parts{v1::STEP_APPROACH, v1::STEP_CLOSE,   v1::STEP_LIFT,   v1::STEP_CARRY,
                             v1::STEP_PUT_DOWN, v1::STEP_RELEASE, v1::STEP_RETRACT};
  return parts.at(static_cast<std::size_t>(part));
}

v1::GraspType to_message(const std::string& robot_type) {
  if (robot_type == "power wrap") return v1::GRASP_POWER_WRAP;
  if (robot_type == "circular sphere") return v1::GRASP_CIRCULAR_SPHERE;
  if (robot_type == "precision") return v1::GRASP_PRECISION;
  return v1::GRASP_NONE;
}

/// The part of a text that has room in a message.
template <std::size_t N = 127>
std::string cut(const std::string& text) {
  return text.substr(0, N);
}

class Performing {
 public:
  Performing(service::Shell& shell, const TaskModel& task, const PerformingOptions& options,
             model::Catalogue catalogue, model::GraspTaxonomy taxonomy,
             std::optional<model::ArmModel> arm)
      : shell_(shell),
        task_(task),
        options_(options),
        catalogue_(std::move(catalogue)),
        taxonomy_(std::move(taxonomy)),
        arm_(std::move(arm)),
        hand_name_(shell.config().text("mapping.hand_name")),
        commands_(shell.publish(dds::robot_command)),
        progress_(shell.publish(dds::task_progress)),
        begun_(shell.now()) {
    shell.subscribe(dds::robot_state,
                    Handler<v1::HandState>([this](auto& s, auto& i) { on_state(s, i); }));
    if (arm_)
      shell.subscribe(dds::arm_state,
                      Handler<v1::ArmState>([this](auto& s, auto& i) { on_arm(s, i); }));
    shell.subscribe(dds::robot_gate,
                    Handler<v1::GateState>([this](auto& s, auto& i) { on_gate(s, i); }));
    shell.subscribe(dds::object_state,
                    Handler<v1::ObjectState>([this](auto& s, auto& i) { on_object(s, i); }));
    shell.on_tick(tick_period, [this](Time now) { on_tick(now); });
    shell.status().running();
  }
  ~Performing() {
    if (thinking_.joinable()) thinking_.join();
  }

  Expected<Performed> outcome() const {
    if (error_) return tl::unexpected(*error_);
    if (!made_) return fail("interrupted", task_.name, {}, exit_no);
    return *made_;
  }

 private:
  template <class T>
  using Handler = std::function<void(const T&, const dds::SampleInfo&)>;

  void on_state(const v1::HandState& message, const dds::SampleInfo& info) {
    if (info.gone || message.hand().to_string() != hand_name_) return;
    const auto X_WB = convert::from_message(message.X_WB());
    if (!X_WB) return shell_.status().drop("pose of the robot not usable");
    model_ = message.model().to_string();
    // A world that has too much to do leaves time out, in which nothing moves: our time does so,
    // too.
    const Time stamp = from_ns(message.stamp_ns());
    time_ += std::clamp(stamp - stamp_, Duration::zero(), max_step);
    stamp_ = stamp;
    robot_ = RobotNow{time_, *X_WB, convert::from_message(message.dof()),
                      convert::from_message(message.joint()), posture_};
    heard_ = shell_.now();
    if (performer_ && !made_) advance();
  }

  /// How the arm holds the hand follows from what it says.
  void on_arm(const v1::ArmState& message, const dds::SampleInfo& info) {
    if (info.gone || message.arm().to_string() != shell_.config().text("robot.arm_name")) return;
    const auto X_WA = convert::from_message(message.X_WA());
    const auto X_WB = convert::from_message(message.X_WB());
    const Eigen::VectorXd joint = convert::from_message(message.joint());
    if (!X_WA || !X_WB || !joint.allFinite() ||
        joint.size() != static_cast<Eigen::Index>(arm_->joints.size()))
      return shell_.status().drop("state of the arm not usable");
    posture_ = joint;
    X_WA_ = *X_WA;
    X_EB_ = (*X_WA * arm::end_pose(*arm_, posture_)).inverse() * *X_WB;
  }

  void on_gate(const v1::GateState& message, const dds::SampleInfo& info) {
    if (message.hand().to_string() != hand_name_) return;
    if (info.gone)
      gate_.reset();
    else
      gate_ = message;
  }

  void on_object(const v1::ObjectState& message, const dds::SampleInfo& info) {
    if (info.gone) return;
    const auto X_WO = convert::from_message(message.X_WO());
    if (!X_WO) return shell_.status().drop("pose of an object not usable");
    places_[message.body().to_string()] = *X_WO;
  }

  void on_tick(Time now) {
    if (ended_) {
      if (now - *ended_ > farewell) shell_.stop();
    } else if (performer_) {
      watch(now);
    } else if (thinking_.joinable()) {
      if (thought_) begin(now);
    } else {
      look(now);
    }
  }

  void refuse(Error error) {
    error_ = std::move(error);
    shell_.stop();
  }

  /// What stands between us and the hand, if anything.
  std::optional<Error> obstacle() const {
    if (!gate_) return std::nullopt;
    const std::string leader = gate_->leader().to_string();
    if (gate_->stopped())
      return Error{
          "is stopped by " + gate_->stopped_by().to_string() + ": " + gate_->reason().to_string(),
          hand_name_, "prehend release --reason WHY", exit_no};
    if (gate_->deadman() && !gate_->consent())
      return Error{"waits for consent", hand_name_, "prehend consent", exit_no};
    if (!leader.empty() && leader.find("performer") == std::string::npos)
      return Error{"is led by " + leader, hand_name_, "stop that one first", exit_no};
    return std::nullopt;
  }

  /// Until all that the task needs is there.
  void look(Time now) {
    std::string missing;
    if (!robot_) missing = "robot/state";
    if (arm_ && posture_.size() == 0) missing = "arm/state";
    for (const Step& step : task_.steps)
      for (const std::string& name : {step.object, step.reference})
        if (name != the_table && !places_.contains(name)) missing = name;
    const bool all = missing.empty() && gate_ && now - begun_ > look_around;
    if (all) return think();
    if (now - begun_ < look_time && (places_.empty() || now - begun_ < 4 * look_around || !gate_))
      return;
    if (!robot_) return refuse({"no robot hand is there", hand_name_, "prehend status"});
    if (missing == "arm/state") return refuse({"no arm is there", arm_->name, "prehend status"});
    if (!missing.empty())
      return refuse(
          {"is not in this lab", missing, "the task " + task_.name + " needs it", exit_no});
    refuse({"no gate of a robot answers", hand_name_, "prehend status"});
  }

  /// In a thread of its own, since it takes seconds.
  void think() {
    if (auto error = obstacle()) return refuse(*error);
    const auto folder = model::named_hand(model_);
    if (!folder) return refuse(folder.error());
    auto hand = model::HandModel::load(*folder);
    if (!hand) return refuse(hand.error());
    hand_ = std::make_unique<const model::HandModel>(std::move(*hand));
    if (robot_->dof.size() != static_cast<Eigen::Index>(hand_->dofs().size()) ||
        robot_->joint.size() != static_cast<Eigen::Index>(hand_->joints().size()))
      return refuse({"has other joints than " + model_, hand_name_, "is it the same description?"});
    for (const auto& [name, X_WO] : places_)
      if (const auto* known = catalogue_.find(name))
        things_.push_back(
            {{known->name, known->shape, known->mass, known->material, {}, {}}, X_WO});
      else
        log::warning("{} is not in the catalogue: it is not looked out for", name);
    from_ = {robot_->X_WB, hand_->clamp(robot_->dof)};
    if (arm_) carried_ = planning::Robot{&*arm_, hand_.get(), X_WA_, X_EB_};
    options_.tell("rehearsing");
    thinking_ = std::thread([this, posture = robot_->arm] {
      RehearsalOptions options;
      options.robot = carried_;
      options.posture = posture;
      rehearsal_ = rehearse(*hand_, task_, things_, from_, options);
      thought_ = true;
    });
  }

  void begin(Time now) {
    if (!*rehearsal_) {
      Error error = rehearsal_->error();
      error.exit = exit_no;
      return refuse(error);
    }
    if (options_.only_rehearse) {
      made_ = Performed{model_, true, {}, (*rehearsal_)->verdicts, 0, false};
      return shell_.stop();
    }
    if (auto error = obstacle()) return refuse(*error);
    Places known;
    for (const Thing& thing : things_) known[thing.body.name] = places_.at(thing.body.name);
    auto performer = TaskPerformer::create(*hand_, task_, shapes_of(things_), known,
                                           (*rehearsal_)->grasps, from_, {}, {}, {carried_});
    if (!performer) return refuse(performer.error());
    performer_.emplace(std::move(*performer));
    started_ = now;
    options_.tell("moving");
  }

  /// The next command, as an answer to a state.
  void advance() {
    Places known;
    for (const Thing& thing : things_) known[thing.body.name] = places_.at(thing.body.name);
    const HandGoal goal = performer_->step(*robot_, known);
    command(goal);
    if (performer_->over()) end({});
  }

  void command(const HandGoal& goal) {
    const Step& step = task_.steps[performer_->current()];
    const model::GraspClass* kind = taxonomy_.find(step.grasp);
    v2::HandCommand message;
    message.hand(hand_name_);
    message.model(model_);
    message.sequence_number(++sequence_);
    message.stamp_ns(to_ns(shell_.now()));
    message.dof(convert::to_message(goal.dof));
    message.X_WB(convert::to_message(goal.X_WB));
    message.mode(v1::MODE_INTELLIGENT);
    message.weight(1);
    message.object(step.object);
    message.grasp_type(kind ? to_message(taxonomy_.robot_type(*kind, model_)) : v1::GRASP_NONE);
    commands_.publish(message);
    goal_ = goal;
  }

  void watch(Time now) {
    if (auto error = obstacle(); error && now - started_ > refused_time)
      return end(error->message());
    if (gate_ && gate_->stopped()) return end(obstacle()->message());
    if (now - heard_ > silence) return end("the robot has fallen silent");
    // Who is silent loses the lead.
    if (goal_ && now - heard_ > 2 * tick_period) command(*goal_);
    if (now - told_ >= progress_period) tell(now, v1::TASK_RUNNING, {});
  }

  void tell(Time now, v1::TaskState state, const std::string& reason) {
    told_ = now;
    v1::TaskProgress message;
    message.task(cut<63>(task_.name));
    message.sequence_number(told_count_++);
    message.stamp_ns(to_ns(now));
    message.hand(hand_name_);
    message.state(state);
    message.step(static_cast<std::uint32_t>(performer_->current()));
    message.part(to_message(performer_->part()));
    message.share(performer_->share());
    message.reason(cut(reason));
    if (state != v1::TASK_RUNNING)
      for (const Verdict& verdict : performer_->verdicts()) {
        v1::StepVerdict each;
        each.object(cut<63>(verdict.object));
        each.done(verdict.done);
        each.error(verdict.error);
        each.turn(verdict.turn);
        each.max_tilt(verdict.max_tilt);
        each.reason(cut(verdict.reason));
        if (message.verdicts().size() < 64) message.verdicts().push_back(each);
      }
    progress_.publish(message);
    options_.tell(fmt::format("step {}, {}: {}", performer_->current() + 1,
                              task_.steps[performer_->current()].object,
                              to_string(performer_->part())));
  }

  void end(const std::string& interrupted) {
    const Time now = shell_.now();
    const std::string reason = interrupted.empty() ? performer_->reason() : interrupted;
    made_ = Performed{model_,
                      reason.empty() && performer_->done(),
                      reason,
                      performer_->verdicts(),
                      to_seconds(now - started_),
                      goal_.has_value()};
    tell(now, made_->done ? v1::TASK_DONE : v1::TASK_FAILED, reason);
    ended_ = now;
  }

  service::Shell& shell_;
  const TaskModel& task_;
  const PerformingOptions& options_;
  model::Catalogue catalogue_;
  model::GraspTaxonomy taxonomy_;
  const std::optional<model::ArmModel> arm_;  // that carries the hand, if any
  std::string hand_name_, model_;
  service::Shell::Output<v2::HandCommand> commands_;
  service::Shell::Output<v1::TaskProgress> progress_;
  std::unique_ptr<const model::HandModel> hand_;
  arm::Joints posture_;  // of the arm, once it has said so
  Pose X_WA_ = Pose::Identity(), X_EB_ = Pose::Identity();
  std::optional<planning::Robot> carried_;
  std::optional<RobotNow> robot_;
  std::optional<v1::GateState> gate_;
  Places places_;
  std::vector<Thing> things_;  // known, as they stood when it was rehearsed
  HandGoal from_;
  std::thread thinking_;
  std::atomic<bool> thought_ = false;
  std::optional<Expected<Rehearsal>> rehearsal_;  // of that thread, until it has thought
  std::optional<TaskPerformer> performer_;
  std::optional<HandGoal> goal_;
  std::optional<Performed> made_;
  std::optional<Error> error_;
  std::optional<Time> ended_;
  Time begun_, started_{}, heard_{}, told_{};
  Time stamp_{}, time_{};  // of the newest state, and how much of that time the robot has moved
  std::uint64_t sequence_ = 0, told_count_ = 0;
};

}  // namespace

Expected<Performed> perform(service::Shell& shell, const TaskModel& task,
                            const PerformingOptions& options) {
  auto catalogue = model::Catalogue::load(shell.config().path("lab.catalogue"));
  if (!catalogue) return tl::unexpected(catalogue.error());
  auto taxonomy = model::GraspTaxonomy::of_the_house();
  if (!taxonomy) return tl::unexpected(taxonomy.error());
  std::optional<model::ArmModel> arm;
  if (const std::string& name = shell.config().text("robot.arm"); !name.empty()) {
    auto loaded = model::load_arm(name);
    if (!loaded) return tl::unexpected(loaded.error());
    arm = std::move(*loaded);
  }
  Performing performing(shell, task, options, std::move(*catalogue), std::move(*taxonomy),
                        std::move(arm));
  if (const auto ended = shell.run(); !ended) return tl::unexpected(ended.error());
  return performing.outcome();
}

}  // namespace prehend::demonstration
