#include "services/mapping/service/service.hpp"

#include <algorithm>
#include <map>
#include <optional>

#include "common/base/log.hpp"
#include "common/convert/convert.hpp"
#include "common/convert/detection.hpp"
#include "common/convert/grasp_candidates.hpp"
#include "common/dds/topics.hpp"
#include "common/service/order_book.hpp"
#include "common/service/writers.hpp"
#include "services/mapping/core/finger_feedback.hpp"
#include "services/mapping/core/glove_lead.hpp"
#include "services/mapping/core/mapping.hpp"
#include "services/mapping/core/mapping_model.hpp"
#include "services/mapping/core/mapping_modes.hpp"
#include "services/mapping/core/mirror.hpp"
#include "services/mapping/files/mapping_model_file.hpp"
#include "services/mapping/service/messages.hpp"
#include "services/mapping/service/other_states.hpp"
#include "services/mapping/service/trained_model.hpp"

namespace prehend::mapping {

namespace {

constexpr Duration patience = std::chrono::milliseconds(300);  // with a silent glove
constexpr Duration start_up = std::chrono::seconds(3);         // until one is there
constexpr Duration camera_patience = std::chrono::seconds(2);  // with objects that are not seen
constexpr std::size_t max_tracks = 1000;

v1::MappingMode to_message(Mode mode) {
  switch (mode) {
    case Mode::direct:
      return v1::MODE_DIRECT;
    case Mode::intelligent:
      return v1::MODE_INTELLIGENT;
    case Mode::hold:
      break;
  }
  return v1::MODE_HOLD;
}

v1::GraspType to_message(GraspType type) {
  switch (type) {
    case GraspType::power_wrap:
      return v1::GRASP_POWER_WRAP;
    case GraspType::circular_sphere:
      return v1::GRASP_CIRCULAR_SPHERE;
    case GraspType::precision:
      return v1::GRASP_PRECISION;
    case GraspType::none:
      break;
  }
  return v1::GRASP_NONE;
}

/// What the mapping is told: to the operator, «direct» leaves the placement alone as well.
MappingModes effective(MappingModes modes) {
  modes.placement = modes.placement && modes.intelligent;
  return modes;
}

}  // namespace

/// The hand as the mapping knows it, with its model. Of a mirror image it is the hand itself, seen
/// in a mirror.
struct Service::Known {
  std::string name;  // of the hand that is led
  std::unique_ptr<const model::HandModel> hand;
  std::unique_ptr<const MappingModel> model;
  std::optional<Mirror> mirror;

  static Expected<Known> load(service::Shell& shell);
};

class Service::Topics {
 public:
  Topics(service::Shell& shell, Known known, Mapping mapping, MappingModes modes)
      : shell_(shell),
        known_(std::move(known)),
        mapping_(std::move(mapping)),
        modes_(modes),
        hand_name_(shell.config().text("mapping.hand_name")),
        wanted_glove_(shell.config().text("mapping.glove")),
        others_(shell.config().names("mapping.other_hands"), shell.config().text("mapping.hand")),
        output_(shell.publish(dds::robot_command)),
        feedback_(shell.publish(dds::glove_feedback)),
        replies_(shell.publish(dds::operator_reply)),
        last_posture_(shell.now() + start_up) {
    message_.hand(hand_name_);
    message_.model(known_.name);
    shell.subscribe(dds::hand_posture,
                    Handler<v1::HandPosture>([this](auto& s, auto& i) { on_posture(s, i); }));
    shell.subscribe(dds::object_detection,
                    Handler<v1::ObjectDetection>([this](auto& s, auto& i) { on_detection(s, i); }));
    shell.subscribe(dds::grasp_candidates, Handler<v2::GraspCandidates>(
                                               [this](auto& s, auto& i) { on_candidates(s, i); }));
    shell.subscribe(dds::robot_state,
                    Handler<v1::HandState>([this](auto& s, auto& i) { on_state(s, i); }));
    shell.subscribe(dds::robot_touch,
                    Handler<v1::HandTouch>([this](auto& s, auto& i) { on_touch(s, i); }));
    // In lockstep there is none.
    if (!shell.lockstep())
      shell.subscribe(dds::robot_gate,
                      Handler<v1::GateState>([this](auto& s, auto& i) { on_gate(s, i); }));
    shell.subscribe(dds::operator_command,
                    Handler<v1::OperatorCommand>([this](auto& s, auto& i) { on_order(s, i); }));
    shell.busy_while([this] { return shell_.now() - last_posture_ < patience; });
    shell.on_tick(std::chrono::milliseconds(20), [this](Time now) {
      if (auto command = mapping_.tick(now)) {
        shell_.status().count("hold commands");
        publish(std::move(*command));
      }
      if (!shell_.lockstep()) look_around(now);
    });
  }

 private:
  template <class T>
  using Handler = std::function<void(const T&, const dds::SampleInfo&)>;

  void on_posture(const v1::HandPosture& message, const dds::SampleInfo& info) {
    if (info.gone) return;
    if (!wanted_glove_.empty() && message.glove().to_string() != wanted_glove_) return;
    const Time now = shell_.now();
    service::Status& status = shell_.status();
    heard_.heard(info.participant, now);
    if (!gloves_.admits(info.participant, now)) {
      status.drop("posture of a second glove");
      gloves_.refused(info.participant, now);
      return;
    }
    if (led_ && *led_ != info.participant) mapping_.interrupt();
    const auto posture = posture_from_message(message);
    auto command =
        posture.and_then([&](const Posture& value) { return mapping_.on_posture(value, now); });
    if (!command) {
      status.drop(command.error().what);
      last_reject_ = command.error().what;
      return;
    }
    publish(std::move(*command));
    glove_ = message.glove().to_string();
    gloves_.followed(info.participant, now);
    led_ = info.participant;
    last_posture_ = now;
    last_reject_.clear();
    status.latency("posture hop", now - info.sent);
    status.latency("glove to command", shell_.now() - from_ns(message.origin_ns()));
  }

  void on_detection(const v1::ObjectDetection& message, const dds::SampleInfo& info) {
    if (info.gone) {
      mapping_.on_detection_gone(message.track());
      seen_.erase(message.track());
      return;
    }
    if (seen_.size() < max_tracks) seen_[message.track()] = shell_.now();
    const auto taken = convert::from_message(message).and_then([&](Detection seen) {
      if (known_.mirror) seen = known_.mirror->detection(std::move(seen));
      return mapping_.on_detection(seen);
    });
    if (!taken) shell_.status().drop(taken.error().what);
  }

  void on_candidates(const v2::GraspCandidates& message, const dds::SampleInfo& info) {
    if (message.hand().to_string() != hand_name_) return;
    if (info.gone) return mapping_.on_candidates_gone(message.track());
    const auto taken =
        convert::from_message(message, *known_.hand).and_then([&](model::GraspCandidates planned) {
          if (known_.mirror) planned = known_.mirror->candidates(std::move(planned));
          return mapping_.on_candidates(std::move(planned));
        });
    if (!taken) shell_.status().drop(taken.error().what);
  }

  void on_state(const v1::HandState& message, const dds::SampleInfo& info) {
    if (message.hand() != hand_name_) return on_other_state(message, info);
    if (info.gone) return;
    const auto taken = state_from_message(message).and_then([&](RobotState state) {
      if (known_.mirror) state = known_.mirror->state(std::move(state));
      return mapping_.on_state(state);
    });
    if (!taken) return shell_.status().drop(taken.error().what);
    dof_ = convert::from_message(message.dof());
  }

  void on_other_state(const v1::HandState& message, const dds::SampleInfo& info) {
    const std::string name = message.hand().to_string();
    if (!others_.names(name)) return;
    if (info.gone) return mapping_.on_other_hand_gone(name);
    auto placed = others_.place(message);
    if (!placed) return shell_.status().drop(placed.error().what);
    if (known_.mirror) placed = known_.mirror->capsules(std::move(*placed));
    mapping_.on_other_hand(name, std::move(*placed));
  }

  /// What the hand feels goes to the glove that leads it; while none does, nobody is told.
  void on_touch(const v1::HandTouch& message, const dds::SampleInfo& info) {
    if (info.gone || message.hand() != hand_name_ || glove_.empty() || dof_.size() == 0) return;
    if (shell_.now() - last_posture_ > patience) return;
    const auto felt = feel(*known_.hand, touch_from_message(message), dof_);
    if (!felt) return shell_.status().drop(felt.error().what);
    v1::GloveFeedback feedback = to_message(*felt);
    feedback.glove(glove_);
    feedback.hand(hand_name_);
    feedback.sequence_number(message.sequence_number());
    feedback.stamp_ns(message.stamp_ns());
    feedback.origin_ns(message.origin_ns());
    feedback_.publish(feedback);
  }

  void on_gate(const v1::GateState& message, const dds::SampleInfo& info) {
    if (message.hand().to_string() != hand_name_) return;
    // Of a gate that is gone nothing is known.
    if (info.gone) return mapping_.on_gate(true);
    mapping_.on_gate(!message.stopped() && (!message.deadman() || message.consent()),
                     message.placed());
  }

  /// «Set mode» and «take over», for us or for all; other orders are not ours.
  void on_order(const v1::OperatorCommand& message, const dds::SampleInfo& info) {
    const std::string target = message.target().to_string();
    const auto action = message.action();
    if (info.gone || (action != v1::ACTION_SET_MODE && action != v1::ACTION_TAKE_OVER)) return;
    if (!target.empty() && target != "mapping") return;
    if (const auto known = orders_.find(message.id().to_string())) return replies_.publish(*known);
    const auto executed = action == v1::ACTION_SET_MODE ? set_mode(message.argument().to_string())
                                                        : take_over(message, info);
    v1::OperatorReply reply;
    reply.id(message.id());
    reply.stamp_ns(to_ns(shell_.now()));
    reply.service("mapping");
    reply.done(executed.has_value());
    // Long enough for every reason that there is.
    reply.message((executed ? *executed : executed.error().message()).substr(0, 255));
    if (executed) orders_.add(reply);
    replies_.publish(reply);
  }

  Expected<std::string> set_mode(const std::string& words) {
    const auto used =
        changed(modes_, words).and_then([this](const MappingModes& modes) { return use(modes); });
    if (used) return to_string(modes_);
    shell_.status().drop("order not understood");
    return tl::unexpected(used.error());
  }

  /// Another glove leads from now on.
  Expected<std::string> take_over(const v1::OperatorCommand& order, const dds::SampleInfo& info) {
    const std::string by = service::given_by(order, shell_.writer_of(info));
    const Time now = shell_.now();
    if (!shell_.lockstep())
      if (const auto meant = service::meant_now(order, by, shell_.role_of(info), now); !meant)
        return tl::unexpected(meant.error());
    const auto chosen = heard_.named(
        order.argument().to_string(), gloves_.followed(), now,
        [this](const auto& writer) { return name_of(writer); }, dds::hand_posture.name);
    if (!chosen) return tl::unexpected(chosen.error());
    gloves_.take_over(*chosen, now);
    log::warning("{} leads, by order of {}", name_of(*chosen), by);
    return name_of(*chosen) + " leads";
  }

  std::string name_of(const dds::GuidPrefix& writer) const {
    return shell_.writer_of({.participant = writer});
  }

  Expected<void> use(const MappingModes& modes) {
    auto used = mapping_.use(effective(modes));
    if (!used) return used;
    modes_ = modes;
    log::info("mode: {}", to_string(modes));
    return {};
  }

  /// Says what is missing; that the hand holds still then is the mapping's own doing.
  void look_around(Time now) {
    std::string missing;
    if (now - last_posture_ > patience)
      missing = last_reject_.empty() ? "nobody sends hand/posture; the hand stays as it is"
                                     : "no hand/posture is usable: " + last_reject_;
    // A recognition that works says of each object that it is gone.
    else if (std::any_of(seen_.begin(), seen_.end(),
                         [&](const auto& track) { return now - track.second > camera_patience; }))
      missing = "recognition has fallen silent; objects are no longer known";
    else if (const auto second = gloves_.second(now))
      missing = "hand/posture of " + name_of(*second) + " is refused, for " +
                name_of(*gloves_.followed()) + " leads";
    if (missing == missing_) return;
    missing_ = missing;
    if (missing.empty()) {
      log::info("nothing is missing any more");
      return shell_.status().running();
    }
    log::warning("{}", missing);
    shell_.status().degraded(missing);
  }

  void publish(Command command) {
    if (known_.mirror) command = known_.mirror->command(std::move(command));
    message_.sequence_number(sequence_number_++);
    message_.stamp_ns(to_ns(command.stamp));
    message_.origin_ns(command.origin ? to_ns(*command.origin) : 0);
    message_.dof(convert::to_message(command.dof));
    message_.X_WB(convert::to_message(command.X_WB));
    message_.mode(to_message(command.mode));
    message_.weight(command.weight);
    message_.object(command.object);
    message_.grasp_type(to_message(command.grasp_type));
    message_.extrapolating(command.extrapolating);
    output_.publish(message_);
  }

  service::Shell& shell_;
  Known known_;  // the mapping refers to it
  Mapping mapping_;
  GloveLead gloves_;
  service::Writers heard_;                // of postures
  std::optional<GloveLead::Writer> led_;  // whose posture was answered last
  service::OrderBook orders_;
  MappingModes modes_;
  std::string hand_name_, wanted_glove_;
  OtherStates others_;
  service::Shell::Output<v2::HandCommand> output_;
  service::Shell::Output<v1::GloveFeedback> feedback_;
  service::Shell::Output<v1::OperatorReply> replies_;
  v2::HandCommand message_;  // reused, so that a command costs no allocation
  std::uint64_t sequence_number_ = 0;
  Time last_posture_;  // that was answered
  std::string last_reject_, missing_;
  std::string glove_;                   // that leads; empty: none has
  Eigen::VectorXd dof_;                 // rad, of the robot hand; empty: not known
  std::map<std::uint32_t, Time> seen_;  // tracks, when they last came
};

Expected<Service::Known> Service::Known::load(service::Shell& shell) {
  const service::Config& config = shell.config();
  const std::string& kind = config.text("mapping.hand");
  if (kind.empty()) return wrong_use("names no hand", "mapping.hand", model::hand_hint());
  const auto folder = model::hand_directory(kind), files = model::hand_files(folder);
  auto hand = model::HandModel::load(files);
  if (!hand) return tl::unexpected(hand.error());
  Known known{hand->name(), nullptr, nullptr, std::nullopt};
  if (files != folder) {
    known.name = model::mirror_name(hand->name());
    const auto& X_WT = config.numbers("tracker.X_WT");
    if (X_WT.size() != 7)
      return wrong_use("needs seven numbers: x y z in m, then the quaternion w x y z",
                       "tracker.X_WT");
    known.mirror.emplace(X_WT[0]);
  }
  const std::filesystem::path file = config.path("mapping.model");
  auto model = file.empty() ? trained_model(files == folder ? kind : files.string(), *hand,
                                            [&shell] { return shell.stopping(); })
                            : load_mapping_model(file, *hand);
  if (!model) return tl::unexpected(model.error());
  known.hand = std::make_unique<const model::HandModel>(std::move(*hand));
  known.model = std::make_unique<const MappingModel>(std::move(*model));
  return known;
}

Service::Service(std::unique_ptr<Topics> topics) : topics_(std::move(topics)) {}
Service::~Service() = default;

Expected<std::unique_ptr<Service>> Service::create(service::Shell& shell) {
  const service::Config& config = shell.config();
  auto known = Known::load(shell);
  if (!known) return tl::unexpected(known.error());
  MappingModes modes;
  const std::string& mode = config.text("mapping.mode");
  const auto fingers =
      mode.empty() ? std::optional(finger_modes.rows.front().value) : finger_modes.value(mode);
  if (!fingers) return wrong_use("there is no «" + mode + "»", "mapping.mode", finger_modes.list());
  modes.fingers = *fingers;
  modes.intelligent = config.flag("mapping.intelligent");
  modes.placement = config.flag("mapping.placement");
  MappingOptions options;
  options.modes = effective(modes);
  options.start_slowly = !shell.lockstep();
  options.clutch.speed = config.number("mapping.clutch_speed");
  options.clutch.turn_speed = config.number("mapping.clutch_turn_speed");
  options.clutch.finger_speed = config.number("mapping.clutch_finger_speed");
  const auto& clutch = options.clutch;
  if (!(clutch.speed > 0 && clutch.turn_speed > 0 && clutch.finger_speed > 0))
    return wrong_use("must be above 0", "mapping.clutch_speed, _turn_speed, _finger_speed");
  auto mapping = Mapping::create(*known->hand, *known->model, options);
  if (!mapping) return tl::unexpected(mapping.error());

  log::info("{}, {}, {}", known->name, known->model->traits().scheme, to_string(modes));
  std::unique_ptr<Service> made(
      new Service(std::make_unique<Topics>(shell, std::move(*known), std::move(*mapping), modes)));
  shell.status().running();
  return made;
}

}  // namespace prehend::mapping
