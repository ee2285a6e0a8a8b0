#include "services/simulation/service/service.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "common/base/log.hpp"
#include "common/base/paths.hpp"
#include "common/convert/convert.hpp"
#include "common/dds/topics.hpp"
#include "services/simulation/service/messages.hpp"

namespace prehend::simulation {
namespace {

constexpr std::size_t max_waiting = 4;  // closures for the judge
constexpr Duration partner_silence = std::chrono::milliseconds(100);

}  // namespace

Expected<std::unique_ptr<Service>> Service::create(service::Shell& shell) {
  const service::Config& config = shell.config();
  if (!(config.number("simulation.state_rate") > 0))
    return wrong_use("must be positive", "simulation.state_rate");
  auto hands = hands_of(config);
  if (!hands) return tl::unexpected(hands.error());
  auto catalogue = model::Catalogue::load(config.path("lab.catalogue"));
  if (!catalogue) return tl::unexpected(catalogue.error());
  auto bodies = grasping::CatalogueBodies::create(*catalogue);
  if (!bodies) return tl::unexpected(bodies.error());
  std::unique_ptr<Service> made(
      new Service(shell, std::move(*hands), std::move(*catalogue), std::move(*bodies)));
  if (auto started = made->start(); !started) return tl::unexpected(started.error());
  return made;
}

/// Of simulation.hands, or the one of simulation.hand.
Expected<std::deque<Service::Hand>> Service::hands_of(const service::Config& config) {
  std::vector<std::string> entries = config.names("simulation.hands");
  const char* key = "simulation.hands";
  if (entries.empty()) {
    key = "simulation.hand";
    entries = {config.text("simulation.hand_name") + ":" + config.text(key)};
  }
  std::deque<Hand> hands;
  for (const std::string& entry : entries) {
    const std::size_t colon = entry.find(':');
    const std::string name = entry.substr(0, colon);
    const std::string kind = colon == std::string::npos ? "" : entry.substr(colon + 1);
    if (kind.empty())
      return wrong_use("names no hand", entries.size() > 1 ? key + (": " + entry) : key,
                       model::hand_hint());
    for (const Hand& other : hands)
      if (other.name == name)
        return wrong_use("two hands are named " + name, key, "as left:barrett_left");
    auto hand = model::HandModel::load(model::hand_directory(kind));
    if (!hand) return tl::unexpected(hand.error());
    hands.push_back({name, std::move(*hand)});
  }
  return hands;
}

Service::Service(service::Shell& shell, std::deque<Hand> hands, model::Catalogue catalogue,
                 grasping::CatalogueBodies bodies)
    : shell_(shell),
      hands_(std::move(hands)),
      catalogue_(std::move(catalogue)),
      bodies_(std::move(bodies)),
      hand_state_(shell.publish(dds::robot_state)),
      hand_touch_(shell.publish(dds::robot_touch)),
      object_state_(shell.publish(dds::object_state)),
      scene_state_(shell.publish(dds::scene_state)),
      reports_(shell.publish(dds::grasp_report)),
      replies_(shell.publish(dds::operator_reply)),
      state_period_(seconds(1.0 / shell.config().number("simulation.state_rate"))) {}

Service::~Service() {
  {
    const std::scoped_lock lock(mutex_);
    stopping_ = true;
  }
  waiting_.notify_all();
  if (judge_.joinable()) judge_.join();
}

Expected<void> Service::start() {
  const service::Config& config = shell_.config();
  const double rate = config.number("simulation.rate");
  const grasping::BrakeLimits brake{config.number("simulation.brake"),
                                    config.number("simulation.brake_turn")};
  if (!(brake.acceleration > 0 && brake.turn_acceleration > 0))
    return wrong_use("must be positive", "simulation.brake, simulation.brake_turn");
  auto arm = arm_of(config, hands_.front().model);
  if (!arm) return tl::unexpected(arm.error());
  Options options{.rate = rate, .brake = brake};
  if (hands_.size() > 1) options.push = push_of_several;
  auto simulation = Simulation::create(hands_.front().model, options, std::move(*arm));
  if (!simulation) return tl::unexpected(simulation.error());
  simulation_ = std::move(*simulation);
  for (std::size_t i = 1; i < hands_.size(); ++i)
    if (auto added = simulation_->add_hand(hands_[i].model); !added)
      return tl::unexpected(added.error());
  if (simulation_->arm()) arm_.emplace(shell_, *simulation_->arm());
  if (auto built = build(); !built) return built;
  for (int hand = 0; hand < static_cast<int>(hands_.size()); ++hand)
    if (auto opened = open_gate(hand); !opened) return opened;
  if (!from_scene_)
    shell_.subscribe(dds::object_detection, std::function([this](const v1::ObjectDetection& message,
                                                                 const dds::SampleInfo& info) {
                       if (!info.gone) on_detection(message);
                     }));
  shell_.subscribe(dds::operator_command, std::function([this](const v1::OperatorCommand& order,
                                                               const dds::SampleInfo& info) {
                     if (!info.gone) on_order(order, info);
                   }));
  shell_.on_tick(seconds(1.0 / rate), [this](Time now) { on_tick(now); });
  if (!shell_.lockstep()) judge_ = std::thread([this] { judge_queued(); });
  shell_.status().running();
  return {};
}

Expected<void> Service::build() {
  const auto file = shell_.config().path("lab.scene");
  if (file.empty()) return {};
  const auto scene = model::load_scene(file, catalogue_);
  if (!scene) return tl::unexpected(scene.error());
  from_scene_ = true;
  return simulation_->build(*scene, bodies_);
}

/// Each hand has its own; a stop is for all.
Expected<void> Service::open_gate(int hand) {
  robot::Robot robot;
  robot.obey = [this, hand](const v2::HandCommand& message, const gate::Place& place, Time now) {
    return obey(message, place, now, hand);
  };
  robot.where = [this, hand] { return where(hand); };
  robot.is_placed = [this, hand] { return simulation_->command(hand).has_value(); };
  robot.hold = [this, hand] { simulation_->hold(hand); };
  robot.rests = [this, hand] { return !simulation_->is_braking(hand); };
  robot.go = [this, hand](const gate::Place& place, Time now) { go(place, now, hand); };
  Hand& own = hands_[static_cast<std::size_t>(hand)];
  for (const Hand& other : hands_)
    if (&other != &own) robot.beside.push_back(other.name);
  auto gate = robot::Gatekeeper::create(shell_, own.model, own.name, std::move(robot));
  if (!gate) return tl::unexpected(gate.error());
  own.gate = std::move(*gate);
  return {};
}

/// Who holds something up together with a hand that nobody leads any more, or that is stopped,
/// waits for it, and presses on as it does.
Expected<void> Service::obey(const v2::HandCommand& message, const gate::Place& place, Time now,
                             int hand) {
  if (message.mode() != v1::MODE_HOLD) hands_[static_cast<std::size_t>(hand)].led = now;
  for (int other = 0; other < static_cast<int>(hands_.size()); ++other) {
    const Hand& partner = hands_[static_cast<std::size_t>(other)];
    if (other != hand && now - partner.led > partner_silence &&
        simulation_->hold_together(hand, other))
      return fail("waits for the other hand", partner.name, "which is not led");
  }
  return simulation_->accept(from_message(message, place), now, hand);
}

/// What the hand is told at the moment, which after a silence is to stay; before any command it may
/// be put anywhere, unless an arm carries it.
std::optional<gate::Place> Service::where(int hand) const {
  if (!simulation_->command(hand) && !simulation_->arm()) return std::nullopt;
  const grasping::World& world = simulation_->world();
  return gate::Place{world.commanded_dof(hand), world.commanded_base(hand)};
}

/// As a command that answers no glove frame.
void Service::go(const gate::Place& place, Time now, int hand) {
  Command command = simulation_->command(hand).value_or(Command{});
  command.model = simulation_->world().hand(hand).name();
  command.stamp = now;
  command.origin = {};
  command.mode = static_cast<int>(v1::MODE_HOLD);
  command.dof = place.dof;
  command.effort = place.effort;
  command.X_WB = place.X_WB;
  if (auto went = simulation_->accept(command, now, hand); !went)
    shell_.status().drop(went.error().what);
}

void Service::on_detection(const v1::ObjectDetection& message) {
  const auto sighting = from_message(message, bodies_);
  if (!sighting) {
    shell_.status().drop("detection not finite");
    return;
  }
  const auto changed = simulation_->see(sighting->body, sighting->X_WO);
  if (!changed) {
    shell_.status().drop("detection: " + changed.error().what);
    return;
  }
  scene_changed_ |= *changed;
}

/// «Place object», for us or for all; other orders are the gate's.
void Service::on_order(const v1::OperatorCommand& order, const dds::SampleInfo& info) {
  const std::string target = order.target().to_string();
  if (order.action() != v1::ACTION_PLACE_OBJECT) return;
  if (!target.empty() && target != "simulation") return;
  if (const auto known = orders_.find(order.id().to_string())) return replies_.publish(*known);
  const auto placed = place(order, info);
  v1::OperatorReply reply;
  reply.id(order.id());
  reply.stamp_ns(to_ns(shell_.now()));
  reply.service("simulation");
  reply.done(placed.has_value());
  reply.message((placed ? *placed : placed.error().message()).substr(0, 255));
  if (placed) orders_.add(reply);
  replies_.publish(reply);
}

Expected<std::string> Service::place(const v1::OperatorCommand& order,
                                     const dds::SampleInfo& info) {
  const std::string by = service::given_by(order, shell_.writer_of(info));
  if (!shell_.lockstep())
    if (const auto meant = service::meant_now(order, by, shell_.role_of(info), shell_.now());
        !meant)
      return tl::unexpected(meant.error());
  const std::string name = order.argument().to_string();
  const grasping::Body* object = bodies_.find(name);
  if (!object) return fail("is not in the catalogue", name);
  const auto X_WO = convert::from_message(order.X_WO());
  if (!X_WO) return tl::unexpected(X_WO.error());
  const auto changed = simulation_->place(*object, *X_WO);
  if (!changed) return tl::unexpected(changed.error());
  scene_changed_ |= *changed;
  log::info("{} is placed, by order of {}", name, by);
  return name + " stands there";
}

void Service::on_tick(Time now) {
  if (const Duration dropped = simulation_->follow(now, shell_.lockstep()); dropped.count() > 0)
    shell_.status().drop("time (ms)",
                         static_cast<std::uint64_t>(std::max(1.0, 1e3 * to_seconds(dropped))));
  for (Hand& hand : hands_) hand.gate->tick(now);
  if (scene_changed_) publish_scene();
  while (simulation_->step()) {
    shell_.status().count("steps");
    while (auto closure = simulation_->take_closure()) judge_soon(std::move(*closure));
    if (simulation_->time() >= next_state_) publish_state();
  }
}

void Service::publish_state() {
  const Time time = simulation_->time();
  // On a grid of its own, but never trying to make up for time that was dropped.
  next_state_ = std::max(next_state_ + state_period_, time + state_period_ / 2);
  for (int hand = 0; hand < static_cast<int>(hands_.size()); ++hand) publish_hand(hand);
  for (int i = 0; i < simulation_->world().body_count(); ++i) {
    v1::ObjectState object =
        to_message(simulation_->world().body(i), simulation_->world().body_motion(i));
    object.sequence_number(sequence_);
    object.stamp_ns(to_ns(time));
    object_state_.publish(object);
  }
  if (arm_) arm_->tell(*simulation_->arm_motion(), simulation_->command(), time);
  ++sequence_;
}

void Service::publish_hand(int hand) {
  const Hand& own = hands_[static_cast<std::size_t>(hand)];
  v1::HandState state = to_message(simulation_->world().hand_motion(hand));
  state.hand(own.name);
  state.model(own.model.name());
  state.sequence_number(sequence_);
  state.stamp_ns(to_ns(simulation_->time()));
  if (const auto& command = simulation_->command(hand)) state.origin_ns(to_ns(command->origin));
  hand_state_.publish(state);
  v1::HandTouch touch = to_message(simulation_->touch(hand), own.model);
  touch.hand(own.name);
  touch.sequence_number(sequence_);
  touch.stamp_ns(state.stamp_ns());
  touch.origin_ns(state.origin_ns());
  hand_touch_.publish(touch);
}

void Service::publish_scene() {
  v1::SceneState scene;
  scene.scene("table");
  scene.sequence_number(scene_sequence_++);
  scene.stamp_ns(to_ns(simulation_->time()));
  for (int i = 0; i < simulation_->world().body_count(); ++i)
    scene.bodies().push_back(to_message(simulation_->world().body(i)));
  scene_state_.publish(scene);
  scene_changed_ = false;
}

void Service::judge_soon(Closure closure) {
  shell_.status().count("closures");
  if (shell_.lockstep()) {
    const GraspVerdict verdict = judge(closure);
    publish_report(closure, verdict);
    return;
  }
  {
    const std::scoped_lock lock(mutex_);
    if (queue_.size() >= max_waiting) {
      shell_.status().drop("closure not judged");
      return;
    }
    queue_.push_back(std::move(closure));
  }
  waiting_.notify_one();
}

void Service::judge_queued() {
  std::unique_lock lock(mutex_);
  while (true) {
    waiting_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
    if (stopping_) return;
    // A task must be copyable, a closure is not.
    const auto closure = std::make_shared<Closure>(std::move(queue_.front()));
    queue_.pop_front();
    lock.unlock();
    const GraspVerdict verdict = judge(*closure);
    shell_.post([this, closure, verdict] { publish_report(*closure, verdict); });
    lock.lock();
  }
}

void Service::publish_report(const Closure& closure, const GraspVerdict& verdict) {
  std::vector<std::string> names;
  for (const Hand& hand : hands_) names.push_back(hand.name);
  reports_.publish(to_message(closure, verdict, names));
  log::info("{}: {} contacts, epsilon {:.4f}, {}", closure.object.name, closure.contacts.size(),
            verdict.quality.epsilon, verdict.hold.held ? "held" : verdict.hold.reason);
  if (verdict.blocking.empty()) return;
  shell_.status().count("fingers_blocked");
  log::warning("fingers keep each other from opening: {}", verdict.blocking);
}

}  // namespace prehend::simulation
