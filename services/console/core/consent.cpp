#include "services/console/core/consent.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace prehend::console {
namespace {

constexpr std::size_t max_name = 63;           // of the contract
constexpr std::int64_t ns_per_ms = 1'000'000;  // browsers count no more digits than those of ms
constexpr std::int64_t max_age_ms = 200;

}  // namespace

Expected<Consent> read_consent(std::string_view body, std::int64_t now_ns) {
  const auto wrong = [](const char* what) { return wrong_use(what, "consent"); };
  const auto said = nlohmann::json::parse(body, nullptr, false);
  if (!said.is_object()) return wrong("is no JSON object");
  const auto field = [&](const char* name) { return said.value(name, nlohmann::json()); };
  const auto hand = field("hand"), held = field("held"), told = field("now_ms");
  if (!hand.is_string() || hand.get<std::string>().empty()) return wrong("names no hand");
  Consent made{hand.get<std::string>(), held == true};
  if (made.hand.size() > max_name ||
      std::any_of(made.hand.begin(), made.hand.end(),
                  [](unsigned char c) { return c < 0x20 || c >= 0x7f; }))
    return wrong("names a hand that is none");
  if (!held.is_boolean()) return wrong("is neither held nor let go");
  if (!made.held) return made;
  if (!told.is_number_integer()) return wrong("does not say what time it was");
  const std::int64_t now_ms = now_ns / ns_per_ms, then_ms = told.get<std::int64_t>();
  if (then_ms > now_ms || then_ms < now_ms - max_age_ms)
    return wrong("was too long on its way; is it still held?");
  return made;
}

std::string consent_answer(std::int64_t now_ns) {
  return nlohmann::json{{"now_ms", now_ns / ns_per_ms}}.dump();
}

}  // namespace prehend::console
