#include "services/glove/service/service.hpp"

#include "common/base/log.hpp"
#include "services/glove/files/user_file.hpp"
#include "services/glove/service/options.hpp"

namespace prehend::glove {
namespace {

constexpr Duration tick_period = std::chrono::milliseconds(100);
constexpr Duration silence =
    std::chrono::milliseconds(300);  // longer means that something is wrong
constexpr Duration start_up = std::chrono::milliseconds(3000);  // a tracker takes its time

}  // namespace

Expected<std::unique_ptr<Service>> Service::create(service::Shell& shell) {
  auto kind = find_device(shell.config().text("glove.device"));
  if (!kind) return wrong_use(kind.error().what, kind.error().where, kind.error().hint);
  if (shell.lockstep() && kind->line != Line::topic) {
    log::info("in lockstep, frames come on glove/frame; {} is left alone", kind->name);
    kind = topic_device();
  }
  const std::string& side = shell.config().text("glove.hand");
  if (side != "right" && side != "left")
    return wrong_use("'" + side + "' is no hand", "glove.hand", "choose right or left");
  auto options = device_options(shell.config());
  if (!options) return tl::unexpected(options.error());
  const std::string& user = shell.config().text("glove.user");
  UserCalibration wearer{.user = user, .scale = options->hand_scale};
  model::HumanHand hand(options->hand_scale);
  if (const auto file = shell.config().path("glove.calibration"); !file.empty()) {
    const auto loaded = load_user(file);
    if (!loaded) return tl::unexpected(loaded.error());
    wearer = *loaded;
    hand = wearer.hand();
    options->joint_gains = {wearer.gain, wearer.offset};
    log::info("{}'s hand, scale {:.2f}, from {}", wearer.user, wearer.scale, file.string());
  }
  auto device = kind->create(*options);
  if (!device) return tl::unexpected(device.error());
  std::unique_ptr<Service> made(
      new Service(shell, *kind, *options, {wearer.user, wearer.scale}, hand));
  if (shell.config().text("glove.calibration").empty() && !kind->synthetic)
    log::warning(
        "{} has not been calibrated: a hand of scale {:.2f} is assumed (prehend glove "
        "calibrate)",
        wearer.user, wearer.scale);
  made->connect(std::move(*device));
  return made;
}

Service::Service(service::Shell& shell, const DeviceKind& kind, const DeviceOptions& options,
                 Wearer wearer, const model::HumanHand& hand)
    : shell_(shell),
      kind_(kind),
      glove_(shell.config().text("glove.name")),
      left_to_right_T_(left_to_right(options.X_WT)),
      wearer_(std::move(wearer)),
      processor_({.X_WT = options.X_WT, .hand = hand}),
      postures_(shell.publish(dds::hand_posture)),
      buttons_(shell.publish(dds::glove_button)),
      started_(shell.now()) {
  if (kind.synthetic && shell.config().text("glove.calibration").empty())
    wearer_.user = options.scene.demonstrator.user;
  if (kind.line == Line::topic)
    shell.subscribe(dds::glove_frame, std::function([this](const v1::GloveFrame& message,
                                                           const dds::SampleInfo& info) {
                      if (info.gone) return;
                      if (message.glove().to_string() == glove_)
                        on_frame(from_message(message));
                      else
                        shell_.status().drop("another glove");
                    }));
  else
    frames_ = shell.publish(dds::glove_frame);
  // Somebody may be led by it.
  shell.busy_while([this] { return shell_.now() - last_posture_ < silence; });
  shell.on_tick(tick_period, [this](Time now) { on_tick(now); });
}

void Service::connect(std::unique_ptr<Device> device) {
  device_ = std::move(device);
  if (shell_.lockstep()) return;
  if (kind_.feels)
    shell_.subscribe(dds::glove_feedback, std::function([this](const v1::GloveFeedback& message,
                                                               const dds::SampleInfo& info) {
                       on_feedback(message, info);
                     }));
  const bool left = shell_.config().text("glove.hand") == "left";
  if (left) log::info("the left hand is mirrored into a right one");
  device_->start({.frame =
                      [this, left](Frame frame) {
                        // A recording knows by itself which hand it is.
                        if (left && !frame.left)
                          frame = mirrored(std::move(frame), left_to_right_T_);
                        shell_.exclusively([this, &frame] {
                          on_frame(frame);  // first: somebody's hand waits for it
                          if (frame.held) buttons_.publish(button_message(frame, glove_));
                          frames_.publish(to_message(frame, glove_, std::string(kind_.name)));
                        });
                      },
                  .degraded =
                      [this](std::string line) {
                        shell_.post([this, line = std::move(line)] {
                          complaint_ = line;
                          degrade(line);
                        });
                      },
                  .drop = [this](std::string_view reason,
                                 std::uint64_t count) { shell_.status().drop(reason, count); },
                  .felt =
                      [this](Time stamp) {
                        shell_.status().latency("touch to glove", shell_.now() - stamp);
                      }});
}

void Service::on_frame(const Frame& frame) {
  const Time now = shell_.now();
  const auto begin = std::chrono::steady_clock::now();
  shell_.status().count("frames");
  if (frame.left) shell_.status().count("frames of a left hand, mirrored");
  // Frames that begin to come get their time to become a posture.
  if (now - last_frame_ > silence) last_posture_ = now;
  last_frame_ = now;
  complaint_.clear();
  const Processed processed = processor_.process(frame, now);
  for (const std::string_view reason : processed.rejects) {
    shell_.status().drop(reason);
    last_reject_ = reason;
  }
  if (!processed.posture) return;
  postures_.publish(to_message(*processed.posture, glove_, wearer_));
  last_posture_ = now;
  shell_.status().latency("acquisition", now - frame.stamp);
  shell_.status().latency("process", std::chrono::steady_clock::now() - begin);
  if (!degraded_.empty()) log::info("frames come again");
  degraded_.clear();
  shell_.status().running();
}

/// Touch never blocks motion, and what is late is felt no more.
void Service::on_feedback(const v1::GloveFeedback& message, const dds::SampleInfo& info) {
  if (info.gone || message.glove().to_string() != glove_) return;
  const auto feedback = from_message(message);
  if (!feedback) return shell_.status().drop(feedback.error().what);
  if (shell_.now() - feedback->stamp > feedback_holds) return shell_.status().drop("late feedback");
  device_->feel(*feedback);
}

void Service::on_tick(Time now) {
  if (last_frame_ == Time{} && now - started_ < start_up) return;
  if (now - last_posture_ <= silence) return;
  if (!complaint_.empty())
    degrade(complaint_);
  else if (now - last_frame_ > silence)
    degrade(fmt::format("no frames from {}; the hand stays as it is", kind_.name));
  else
    degrade(fmt::format("no frame from {} is usable: {}", kind_.name, last_reject_));
}

void Service::degrade(const std::string& line) {
  if (line == degraded_) return;
  degraded_ = line;
  log::warning("{}", line);
  shell_.status().degraded(line);
}

}  // namespace prehend::glove
