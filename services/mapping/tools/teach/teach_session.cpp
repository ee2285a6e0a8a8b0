#include "services/mapping/tools/teach/teach_session.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <functional>

#include "common/base/log.hpp"
#include "services/mapping/service/messages.hpp"

namespace prehend::mapping {

TeachSession::TeachSession(service::Shell& shell, Teacher& teacher, Duration limit, bool consents)
    : shell_(shell),
      teacher_(teacher),
      begun_(shell.now()),
      limit_(limit),
      orders_(shell.publish(dds::operator_command)) {
  shell.subscribe(dds::hand_posture,
                  std::function<void(const v1::HandPosture&, const dds::SampleInfo&)>(
                      [this](const auto& message, const auto& info) {
                        if (!info.gone) see(message);
                      }));
  if (consents) {
    keyboard_.emplace();
    consent_.emplace(shell, shell.config().text("mapping.hand_name"));
  }
  shell.on_tick(consents ? service::ConsentKey::period : std::chrono::milliseconds(100),
                [this](Time now) { tick(now); });
  log::info("keys{}: r shows the last one again, q gives up",
            consents ? "; hold the space bar for consent" : ", each with Enter");
  prompt();
}

void TeachSession::prompt() {
  const auto* asked = teacher_.asked();
  if (!asked) return shell_.stop();
  log::info("{}: show «{}»", teacher_.shown().size() + 1, label_of(*asked));
}

void TeachSession::see(const v1::HandPosture& message) {
  const auto hand = posture_from_message(message);
  if (!hand) return shell_.status().drop(hand.error().what);
  const auto seen = features(hand->fingertips, hand->hand_scale);
  if (!seen) return shell_.status().drop(seen.error().what);
  const auto shown = teacher_.see(*seen, hand->stamp);
  if (!shown) return hint();
  log::info(
      "   taken: quality {:.0f} %, moved {:.1f} mm{}", 100 * shown->quality, 1000 * shown->wobble,
      shown->nearest_name.empty()
          ? std::string()
          : fmt::format(", {:.0f} mm from «{}»", 1000 * shown->separation, shown->nearest_name));
  tell(*shown, hand->stamp);
  prompt();
}

// So that a recording of the session can be used instead of it.
void TeachSession::tell(const Shown& shown, Time stamp) {
  v1::OperatorCommand order;
  order.id(fmt::format("teach-{}-{}", ::getpid(), ++told_));
  order.stamp_ns(to_ns(stamp));
  order.action(v1::ACTION_TEACH);
  order.target("teach");
  order.argument(label_of(shown.pair));
  orders_.publish(order);
}

// Each reason once, when it has lasted.
void TeachSession::hint() {
  const std::string& reason = teacher_.waiting_for();
  if (reason != reason_) {
    reason_ = reason;
    since_ = shell_.now();
    hinted_ = false;
  } else if (!hinted_ && shell_.now() - since_ > std::chrono::seconds(3)) {
    log::info("   {}", reason);
    hinted_ = true;
  }
}

void TeachSession::tick(Time now) {
  if (now - begun_ > limit_) {
    log::error("gave up after {:.0f} s, at «{}»", to_seconds(limit_),
               teacher_.asked() ? label_of(*teacher_.asked()) : "the end");
    return shell_.stop(exit_no);
  }
  if (consent_) {
    while (const auto key = keyboard_->key()) on_key(*key, now);
    return consent_->tick(now);
  }
  pollfd input{STDIN_FILENO, POLLIN, 0};
  if (closed_ || ::poll(&input, 1, 0) <= 0) return;
  char key = 0;
  if (::read(STDIN_FILENO, &key, 1) <= 0)
    closed_ = true;
  else
    on_key(key, now);
}

void TeachSession::on_key(int key, Time now) {
  if (key == ' ' && consent_) {
    consent_->press(now);
  } else if (key == 'q') {
    if (consent_) consent_->end();
    shell_.stop(exit_no);
  } else if (key == 'r' && teacher_.redo()) {
    prompt();
  }
}

}  // namespace prehend::mapping
