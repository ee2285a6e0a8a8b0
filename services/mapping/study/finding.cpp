#include "finding.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace prehend::mapping {

std::string_view to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::reproduced:
      return "reproduced";
    case Verdict::not_reproduced:
      return "not reproduced";
    case Verdict::undecided:
      break;
  }
  return "undecided";
}

Verdict above_zero(const Interval& interval, double least) {
  if (interval.low > 0) return Verdict::reproduced;
  if (interval.high < 0 || interval.high < least) return Verdict::not_reproduced;
  return Verdict::undecided;
}

Verdict above_one(const Interval& ratio, double least) {
  return above_zero({ratio.mean - 1, ratio.low - 1, ratio.high - 1, ratio.count}, least - 1);
}

Verdict all_of(std::span<const Verdict> parts) {
  const auto any = [&](Verdict verdict) {
    return std::find(parts.begin(), parts.end(), verdict) != parts.end();
  };
  if (parts.empty() || any(Verdict::undecided))
    return any(Verdict::not_reproduced) ? Verdict::not_reproduced : Verdict::undecided;
  return any(Verdict::not_reproduced) ? Verdict::not_reproduced : Verdict::reproduced;
}

std::string to_text(const Interval& interval) {
  return fmt::format("{:.3g} [{:.3g}, {:.3g}]", interval.mean, interval.low, interval.high);
}

}  // namespace prehend::mapping
