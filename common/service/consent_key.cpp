#include "common/service/consent_key.hpp"

#include "common/base/log.hpp"
#include "common/dds/topics.hpp"

namespace prehend::service {

ConsentKey::ConsentKey(Shell& shell, const std::string& hand)
    : shell_(shell), consents_(shell.publish(dds::operator_consent)) {
  message_.hand(hand.c_str());
}

void ConsentKey::tick(Time now, bool always) {
  const bool held = always || key_.held(now);
  if (held != held_) log::info("consent: {}", held ? "held" : "let go");
  held_ = held;
  say(held, now);
}

void ConsentKey::end() {
  say(false, shell_.now());
}

void ConsentKey::say(bool held, Time now) {
  message_.sequence_number(message_.sequence_number() + 1);
  message_.stamp_ns(to_ns(now));
  message_.held(held);
  consents_.publish(message_);
}

}  // namespace prehend::service
