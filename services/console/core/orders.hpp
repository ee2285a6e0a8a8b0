#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "services/console/core/protocol.hpp"

namespace prehend::console {

enum class OrderKind : std::uint8_t { start, stop, release, set_mode, take_over, place, teach };

/// What an operator asks for by a button of the page.
struct Order {
  OrderKind kind{};
  std::string target;  // service that it is for; empty: all
  std::string argument;
  double x = 0, y = 0;  // m, on the table; of what is placed
};

/// From the body of a request, whose `action` says which. Only what the page has buttons for.
Expected<Order> read_order(std::string_view body);
/// From the request of the service /operator/ACTION.
Expected<Order> read_order(std::string_view action, std::string_view request);

/// What stands before an order's action in the name of its service.
inline constexpr std::string_view order_services = "/operator/";
/// Every order as a service, and consent.
std::vector<ServiceInfo> services_for_orders();

}  // namespace prehend::console
