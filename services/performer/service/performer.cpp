#include "services/performer/service/performer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <optional>
#include <thread>
#include <utility>

#include "common/base/log.hpp"
#include "common/convert/convert.hpp"
#include "common/dds/topics.hpp"
#include "common/grasping/catalogue_bodies.hpp"
#include "common/model/arm_choice.hpp"
#include "common/model/catalogue.hpp"
#include "common/model/grasp_candidates.hpp"
#include "common/model/grasp_taxonomy.hpp"
#include "services/performer/core/rehearsal/rehearsal.hpp"
#include "services/performer/service/planner_ears.hpp"

namespace prehend::performer {

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

/// A task that is being done.
struct Doing {
  tasks::TaskModel task;
  PerformingOptions options;
  Performer::OnEnd on_end;
  Time begun{}, started{}, told{};
  std::optional<std::string> stopped;  // why
  std::unique_ptr<const model::HandModel> hand;
  std::string kind;  // of the hand
  std::optional<planning::Robot> carried;
  std::vector<Thing> things;  // known, as they stood when it was rehearsed
  HandGoal from;
  std::optional<Expected<Rehearsal>> rehearsal;  // of the thread, until it has thought
  std::atomic<bool> thought = false;
  std::optional<TaskPerformer> performer;
  std::optional<HandGoal> goal;
  std::optional<Performed> made;
  std::optional<Time> ended;
  std::thread thinking;  // last: it uses what stands above

  ~Doing() {
    if (thinking.joinable()) thinking.join();
  }
};

}  // namespace

class Performer::State {
 public:
  State(service::Shell& shell, grasping::CatalogueBodies bodies, model::GraspTaxonomy taxonomy,
        std::optional<model::ArmModel> arm)
      : shell_(shell),
        bodies_(std::move(bodies)),
        taxonomy_(std::move(taxonomy)),
        arm_(std::move(arm)),
        hand_name_(shell.config().text("mapping.hand_name")),
        tries_(static_cast<int>(shell.config().integer("performer.tries"))),
        commands_(shell.publish(dds::robot_command)),
        progress_(shell.publish(dds::task_progress)),
        planned_(shell, hand_name_) {
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

  Expected<void> begin(tasks::TaskModel task, const PerformingOptions& options, OnEnd on_end) {
    if (doing_) return fail("is being done", doing_->task.name, "wait until it is over", exit_no);
    doing_ = std::make_unique<Doing>();
    doing_->task = std::move(task);
    doing_->options = options;
    doing_->on_end = std::move(on_end);
    doing_->begun = shell_.now();
    return {};
  }

  void stop(const std::string& reason) {
    if (doing_ && !doing_->stopped) doing_->stopped = reason;
  }

  const tasks::TaskModel* task() const { return doing_ ? &doing_->task : nullptr; }
  bool moves() const { return doing_ && doing_->performer && !doing_->made; }

 private:
  template <class T>
  using Handler = std::function<void(const T&, const dds::SampleInfo&)>;

  // --- what the lab says

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
    if (moves()) advance();
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
    if (info.gone) {
      gate_.reset();
      leader_is_performer_ = false;
    } else {
      gate_ = message;
      leader_is_performer_ = names_a_performer(message.leader().to_string());
    }
  }

  /// The gate tells who leads by its status' name, service@host/process.
  static bool names_a_performer(const std::string& leader) {
    return dds::role_named(leader.substr(0, leader.find('@'))) == dds::Role::performer;
  }

  void on_object(const v1::ObjectState& message, const dds::SampleInfo& info) {
    if (info.gone) return;
    const auto X_WO = convert::from_message(message.X_WO());
    if (!X_WO) return shell_.status().drop("pose of an object not usable");
    places_[message.body().to_string()] = *X_WO;
  }

  // --- the course of a task

  void on_tick(Time now) {
    if (!doing_) return;
    if (doing_->ended) {
      if (now - *doing_->ended > farewell) finish(*doing_->made);
    } else if (doing_->performer) {
      watch(now);
    } else if (doing_->thinking.joinable()) {
      if (doing_->thought) start(now);
    } else if (doing_->stopped) {
      refuse({*doing_->stopped, doing_->task.name, "", exit_no});
    } else {
      look(now);
    }
  }

  void finish(const Expected<Performed>& came_of_it) {
    // Who is told may begin the next one.
    const std::unique_ptr<Doing> over = std::move(doing_);
    over->on_end(came_of_it);
  }

  void refuse(Error error) { finish(tl::unexpected(std::move(error))); }

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
    if (!leader.empty() && !leader_is_performer_)
      return Error{"is led by " + leader, hand_name_, "stop that one first", exit_no};
    return std::nullopt;
  }

  /// Until all that the task needs is there.
  void look(Time now) {
    std::string missing;
    if (!robot_) missing = "robot/state";
    if (arm_ && posture_.size() == 0) missing = "arm/state";
    const auto lacks =
        lacking(doing_->task, [this](const std::string& name) { return places_.contains(name); });
    if (lacks) missing = lacks->where;
    const Duration waited = now - doing_->begun;
    if (missing.empty() && gate_ && waited > look_around) return think();
    if (waited < look_time && (places_.empty() || waited < 4 * look_around || !gate_)) return;
    if (!robot_) return refuse({"no robot hand is there", hand_name_, "prehend status"});
    if (missing == "arm/state") return refuse({"no arm is there", arm_->name, "prehend status"});
    if (lacks) return refuse(*lacks);
    refuse({"no gate of a robot answers", hand_name_, "prehend status"});
  }

  /// In a thread of its own, since it takes seconds.
  void think() {
    if (auto error = obstacle()) return refuse(*error);
    const auto& config = shell_.config();
    const auto folder =
        model::named_hand(model_, {config.text("mapping.hand"), config.text("simulation.hand")});
    if (!folder) return refuse(folder.error());
    auto hand = model::HandModel::load(*folder);
    if (!hand) return refuse(hand.error());
    Doing& doing = *doing_;
    doing.kind = model_;
    doing.hand = std::make_unique<const model::HandModel>(std::move(*hand));
    if (robot_->dof.size() != static_cast<Eigen::Index>(doing.hand->dofs().size()) ||
        robot_->joint.size() != static_cast<Eigen::Index>(doing.hand->joints().size()))
      return refuse({"has other joints than " + model_, hand_name_, "is it the same description?"});
    const model::CandidateBook planned = planned_.of(*doing.hand);
    for (const auto& [name, X_WO] : places_)
      if (const auto* known = bodies_.find(name))
        doing.things.push_back({*known, X_WO, planned.of(name, known->shape)});
      else
        log::warning("{} is not in the catalogue: it is not looked out for", name);
    doing.from = {robot_->X_WB, doing.hand->clamp(robot_->dof)};
    if (arm_) doing.carried = planning::Robot{&*arm_, doing.hand.get(), X_WA_, X_EB_};
    doing.options.tell("rehearsing");
    doing.thinking = std::thread([&doing, tries = tries_, posture = robot_->arm] {
      RehearsalOptions options;
      options.max_tries = tries;
      options.robot = doing.carried;
      options.posture = posture;
      doing.rehearsal = rehearse(*doing.hand, doing.task, doing.things, doing.from, options);
      doing.thought = true;
    });
  }

  /// Places of the things that were rehearsed with, now.
  Places places_now() const {
    Places known;
    for (const Thing& thing : doing_->things) known[thing.body.name] = places_.at(thing.body.name);
    return known;
  }

  void start(Time now) {
    Doing& doing = *doing_;
    if (doing.stopped) return refuse({*doing.stopped, doing.task.name, "", exit_no});
    const Expected<Rehearsal>& rehearsal = *doing.rehearsal;
    if (!rehearsal) {
      Error error = rehearsal.error();
      error.exit = exit_no;
      return refuse(error);
    }
    for (const Verdict& verdict : rehearsal->verdicts) {
      shell_.status().count(verdict.planned ? "planned grasps" : "own grasps");
      log::info("{}: {}", verdict.object,
                verdict.planned ? "grasp of the planner" : "grasp of its own search");
    }
    if (doing.options.only_rehearse)
      return finish(Performed{doing.kind, true, {}, rehearsal->verdicts, 0, false});
    if (auto error = obstacle()) return refuse(*error);
    auto performer =
        TaskPerformer::create(*doing.hand, doing.task, shapes_of(doing.things), places_now(),
                              rehearsal->grasps, doing.from, {}, {}, {doing.carried});
    if (!performer) return refuse(performer.error());
    doing.performer.emplace(std::move(*performer));
    doing.started = now;
    doing.options.tell("moving");
  }

  /// The next command, as an answer to a state.
  void advance() {
    command(doing_->performer->step(*robot_, places_now()));
    if (doing_->performer->over()) end({});
  }

  void command(const HandGoal& goal) {
    const tasks::Step& step = doing_->task.steps[doing_->performer->current()];
    const model::GraspClass* kind = taxonomy_.find(step.grasp);
    v2::HandCommand message;
    message.hand(hand_name_);
    message.model(doing_->kind);
    message.sequence_number(++sequence_);
    message.stamp_ns(to_ns(shell_.now()));
    message.dof(convert::to_message(goal.dof));
    message.X_WB(convert::to_message(goal.X_WB));
    message.mode(v1::MODE_INTELLIGENT);
    message.weight(1);
    message.object(step.object);
    message.grasp_type(kind ? to_message(taxonomy_.robot_type(*kind, doing_->kind))
                            : v1::GRASP_NONE);
    commands_.publish(message);
    doing_->goal = goal;
  }

  void watch(Time now) {
    if (doing_->stopped) return end(*doing_->stopped);
    if (auto error = obstacle(); error && now - doing_->started > refused_time)
      return end(error->message());
    if (gate_ && gate_->stopped()) return end(obstacle()->message());
    if (now - heard_ > silence) return end("the robot has fallen silent");
    // Who is silent loses the lead.
    if (doing_->goal && now - heard_ > 2 * tick_period) command(*doing_->goal);
    if (now - doing_->told >= progress_period) tell(now, v1::TASK_RUNNING, {});
  }

  void tell(Time now, v1::TaskState state, const std::string& reason) {
    const TaskPerformer& performer = *doing_->performer;
    doing_->told = now;
    v1::TaskProgress message;
    message.task(cut<63>(doing_->task.name));
    message.sequence_number(told_count_++);
    message.stamp_ns(to_ns(now));
    message.hand(hand_name_);
    message.state(state);
    message.step(static_cast<std::uint32_t>(performer.current()));
    message.part(to_message(performer.part()));
    message.share(performer.share());
    message.reason(cut(reason));
    if (state != v1::TASK_RUNNING)
      for (const Verdict& verdict : performer.verdicts()) {
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
    doing_->options.tell(fmt::format("step {}, {}: {}", performer.current() + 1,
                                     doing_->task.steps[performer.current()].object,
                                     to_string(performer.part())));
  }

  void end(const std::string& interrupted) {
    const Time now = shell_.now();
    const TaskPerformer& performer = *doing_->performer;
    const std::string reason = interrupted.empty() ? performer.reason() : interrupted;
    doing_->made = Performed{
        doing_->kind,         reason.empty() && performer.done(), reason,
        performer.verdicts(), to_seconds(now - doing_->started),  doing_->goal.has_value()};
    tell(now, doing_->made->done ? v1::TASK_DONE : v1::TASK_FAILED, reason);
    doing_->ended = now;
  }

  service::Shell& shell_;
  grasping::CatalogueBodies bodies_;
  model::GraspTaxonomy taxonomy_;
  const std::optional<model::ArmModel> arm_;  // that carries the hand, if any
  std::string hand_name_, model_;
  const int tries_;
  service::Shell::Output<v2::HandCommand> commands_;
  service::Shell::Output<v1::TaskProgress> progress_;
  arm::Joints posture_;  // of the arm, once it has said so
  Pose X_WA_ = Pose::Identity(), X_EB_ = Pose::Identity();
  std::optional<RobotNow> robot_;
  std::optional<v1::GateState> gate_;
  bool leader_is_performer_ = false;
  Places places_;
  PlannerEars planned_;
  Time heard_{};
  Time stamp_{}, time_{};  // of the newest state, and how much of that time the robot has moved
  std::uint64_t sequence_ = 0, told_count_ = 0;
  std::unique_ptr<Doing> doing_;
};

Expected<std::unique_ptr<Performer>> Performer::create(service::Shell& shell) {
  auto catalogue = model::Catalogue::load(shell.config().path("lab.catalogue"));
  if (!catalogue) return tl::unexpected(catalogue.error());
  auto bodies = grasping::CatalogueBodies::create(*catalogue);
  if (!bodies) return tl::unexpected(bodies.error());
  auto taxonomy = model::GraspTaxonomy::of_the_house();
  if (!taxonomy) return tl::unexpected(taxonomy.error());
  std::optional<model::ArmModel> arm;
  if (const std::string& name = shell.config().text("robot.arm"); !name.empty()) {
    auto loaded = model::load_arm(name);
    if (!loaded) return tl::unexpected(loaded.error());
    arm = std::move(*loaded);
  }
  return std::unique_ptr<Performer>(new Performer(
      std::make_unique<State>(shell, std::move(*bodies), std::move(*taxonomy), std::move(arm))));
}

Performer::Performer(std::unique_ptr<State> state) : state_(std::move(state)) {}
Performer::~Performer() = default;

Expected<void> Performer::begin(tasks::TaskModel task, const PerformingOptions& options,
                                OnEnd on_end) {
  return state_->begin(std::move(task), options, std::move(on_end));
}
void Performer::stop(const std::string& reason) {
  state_->stop(reason);
}
const tasks::TaskModel* Performer::task() const {
  return state_->task();
}
bool Performer::moves() const {
  return state_->moves();
}

}  // namespace prehend::performer
