#include "services/mapping/tools/study/finding.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/named_values.hpp"

namespace prehend::mapping {

namespace {
constexpr auto verdict_names =
    named_values<Reproduction>({{Reproduction::reproduced, "reproduced"},
                                {Reproduction::not_reproduced, "not reproduced"},
                                {Reproduction::undecided, "undecided"}});
}  // namespace

std::string_view to_string(Reproduction verdict) {
  return verdict_names.name(verdict);
}

Reproduction above_zero(const statistics::Interval& interval, double least) {
  if (interval.low > 0) return Reproduction::reproduced;
  if (interval.high < 0 || interval.high < least) return Reproduction::not_reproduced;
  return Reproduction::undecided;
}

Reproduction above_one(const statistics::Interval& ratio, double least) {
  return above_zero({ratio.mean - 1, ratio.low - 1, ratio.high - 1, ratio.count}, least - 1);
}

Reproduction all_of(std::span<const Reproduction> parts) {
  const auto any = [&](Reproduction verdict) {
    return std::find(parts.begin(), parts.end(), verdict) != parts.end();
  };
  if (parts.empty() || any(Reproduction::undecided))
    return any(Reproduction::not_reproduced) ? Reproduction::not_reproduced
                                             : Reproduction::undecided;
  return any(Reproduction::not_reproduced) ? Reproduction::not_reproduced
                                           : Reproduction::reproduced;
}

std::string to_text(const statistics::Interval& interval) {
  return fmt::format("{:.3g} [{:.3g}, {:.3g}]", interval.mean, interval.low, interval.high);
}

}  // namespace prehend::mapping
