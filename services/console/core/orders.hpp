#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/error.hpp"

namespace prehend::console {

enum class OrderKind : std::uint8_t { start, stop, release, set_mode, take_over, place };

/// What an operator asks for by a button of the page.
struct Order {
  OrderKind kind{};
  std::string target;  // service that it is for; empty: all
  std::string argument;
  double x = 0, y = 0;  // m, on the table; of what is placed
};

/// From the body of a request. Only what the page has buttons for.
Expected<Order> read_order(std::string_view body);

}  // namespace prehend::console
