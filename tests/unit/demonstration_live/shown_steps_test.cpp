// What phases and sightings leave open is said, by the name of the object.
#include "services/demonstration/core/observation/shown_steps.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

namespace prehend::demonstration {
namespace {

/// A hand that carries a cup by 30 cm between 1 and 2 s; the cup is seen then and then, s.
std::string steps_said(const std::vector<double>& cup_seen, std::optional<std::size_t> held) {
  Seen seen;
  for (int n = 0; n <= 30; ++n) {
    const double t = 0.1 * n, x = 0.3 * std::clamp(t - 1, 0.0, 1.0);
    seen.scene.push_back({t, {x, 0, 0.1}, 0.05, {}});
    seen.X_WG.push_back(make_pose({x, 0, 0.1}));
  }
  seen.kinds.resize(seen.scene.size());
  seen.objects = {"Cup"};
  seen.sightings.resize(1);
  for (const double t : cup_seen)
    seen.sightings[0].emplace_back(t, make_pose({t < 1.5 ? 0 : 0.3, 0, 0.1}));
  const auto made = shown_steps(
      seen,
      {{Phase::close, 0.8, 1, held}, {Phase::hold, 1, 2, held}, {Phase::release, 2, 2.2, held}});
  return made ? std::to_string(made->size()) : made.error().message();
}

TEST(ShownSteps, SayWhichSightOfAnObjectIsMissing) {
  EXPECT_EQ(steps_said({0.5, 2.5}, 0), "1");
  EXPECT_EQ(steps_said({2.5}, 0),
            "Cup: was not seen before it was taken (show it to the camera first)");
  EXPECT_EQ(steps_said({0.5}, 0),
            "Cup: was not seen again after it was put down (leave it where the camera sees it, and "
            "end a second later)");
  EXPECT_EQ(steps_said({0.5, 2.5}, std::nullopt),
            "something was taken that was never recognised (are its model and its light right? "
            "prehend objects detect)");
}

}  // namespace
}  // namespace prehend::demonstration
