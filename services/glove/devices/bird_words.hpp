#pragma once

#include <cstdint>
#include <string>
#include <string_view>

/// What a tracker answers to examine commands, in words.
namespace prehend::glove::bird {

/// Of the error code (parameter 10) of a unit.
std::string_view error_in_words(std::uint8_t code);

/// Of the status word (parameter 0), whose layout agrees with the real captures: "master,
/// initialised, running, position_angles, point".
std::string status_in_words(std::uint16_t status);

/// Two bytes, as "3.60".
std::string revision_in_words(std::string_view bytes);

}  // namespace prehend::glove::bird
