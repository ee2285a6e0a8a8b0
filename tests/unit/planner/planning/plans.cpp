#include "tests/unit/planner/planning/plans.hpp"

#include <stdexcept>

#include "common/base/workers.hpp"
#include "tests/support/hands.hpp"

namespace prehend::planner {

grasping::Plan plan(const std::string& hand, const grasping::Body& object,
                    const grasping::PlanOptions& options, unsigned threads) {
  auto planned = grasping::plan_grasps(test::hand(hand), object, options,
                                       [&](std::size_t count, const auto& work) {
                                         share_work(count, threads, work, [](std::size_t) {});
                                       });
  if (!planned) throw std::runtime_error(planned.error().message());
  return std::move(*planned);
}

const grasping::Plan& barrett_on_talc() {
  static const grasping::Plan planned =
      plan("barrett", talc, {.candidates = 16, .seed = 3, .tested = 3, .max_tested = 6});
  return planned;
}

}  // namespace prehend::planner
