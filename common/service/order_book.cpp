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

bool means(std::optional<dds::Role> role, const dds::TopicInfo& topic) {
  return role && topic.writers.has(*role) && *role != dds::Role::replayer;
}

Expected<void> meant_now(const v1::OperatorCommand& order, const std::string& by,
                         std::optional<dds::Role> role, Time now) {
  const Duration age = between(from_ns(order.stamp_ns()), now);
  if (age > max_age || age < -max_age)
    return fail(fmt::format("the order is of {:.0f} s ago", to_seconds(age)), by);
  if (role == dds::Role::replayer) return fail("an order that is played is not obeyed", by);
  if (!means(role, dds::operator_command))
    return fail(fmt::format("an order of {} is not obeyed",
                            role ? "a " + std::string(dds::name_of(*role)) : "somebody unknown"),
                by, "operators and consoles give orders: `prehend stop`, `release`, `takeover`");
  return {};
}

}  // namespace prehend::service
