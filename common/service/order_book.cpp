#include "common/service/order_book.hpp"

#include <fmt/format.h>

#include "common/base/time_between.hpp"

namespace prehend::service {
namespace {

constexpr Duration max_age = std::chrono::seconds(10);

}  // namespace

std::string given_by(const v1::OperatorCommand& order, const std::string& writer) {
  return writer.find('@') == std::string::npos ? order.id().to_string() : writer;
}

Expected<void> meant_now(const v1::OperatorCommand& order, const std::string& by, Time now) {
  const Duration age = between(from_ns(order.stamp_ns()), now);
  if (age > max_age || age < -max_age)
    return fail(fmt::format("the order is of {:.0f} s ago", to_seconds(age)), by);
  if (by.starts_with("replayer@")) return fail("an order that is played is not obeyed", by);
  return {};
}

}  // namespace prehend::service
