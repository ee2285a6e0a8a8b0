#pragma once

#include <cstddef>
#include <string>

namespace prehend::robot {

/// As much of a text as a bounded string of a message holds; length: as the IDL has it.
template <class Text>
void put(Text& to, const std::string& from, std::size_t length) {
  to = from.substr(0, length).c_str();
}

}  // namespace prehend::robot
