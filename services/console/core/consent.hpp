#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/error.hpp"

namespace prehend::console {

/// What a page says of the button that lets a hand move while it is held.
struct Consent {
  std::string hand;
  bool held = false;
};

/// From the body of a request. Who holds a button says with each word what time it was here, as our
/// last answer told: so a word that was long on its way, and may come after the button was let go,
/// is not taken for now. To let go is always in time.
Expected<Consent> read_consent(std::string_view body, std::int64_t now_ns);

/// The answer: what time it is here.
std::string consent_answer(std::int64_t now_ns);

}  // namespace prehend::console
