// What the controller of an arm costs a frame, and inverse kinematics a pose. One thread; times of
// single frames, so that the slow ones show.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "common/arm/controller.hpp"
#include "common/arm/inverse.hpp"
#include "tests/support/arms/arms.hpp"
#include "tests/support/arms/operators.hpp"

using namespace prehend;

namespace {

using SteadyClock = std::chrono::steady_clock;

template <class Call>
double microseconds(const Call& call) {
  const auto begin = SteadyClock::now();
  call();
  return std::chrono::duration<double, std::micro>(SteadyClock::now() - begin).count();
}

void tell(const std::string& arm, const char* what, std::vector<double> times) {
  std::sort(times.begin(), times.end());
  const auto at = [&](double share) {
    return times[static_cast<std::size_t>(share * static_cast<double>(times.size() - 1))];
  };
  fmt::print("{:<14}{:<22}{:>8.1f}{:>10.1f}{:>10.1f}{:>10.1f}\n", arm, what, at(0.5), at(0.99),
             at(0.999), times.back());
}

void measure(const std::string& name) {
  const model::ArmModel& model = test::arm(name);
  arm::ControllerOptions options;
  const Pose X_LF = model.X_LE * model.X_EF;
  options.surroundings = {
      0.0, {{X_LF * Eigen::Vector3d(0, 0, 0.05), X_LF * Eigen::Vector3d(0, 0, 0.15), 0.04}}};
  std::vector<double> frames, poses;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    arm::Controller controller(model, options);
    test::Operator operating(model, seed);
    for (int k = 0; k < 250; ++k) {
      const auto [wish, dt] = operating.next();
      frames.push_back(microseconds([&] { controller.step(wish, dt); }));
    }
  }
  const arm::Inverse inverse(model);
  Random random(1);
  for (int k = 0; k < (inverse.has_closed_form() ? 10'000 : 100); ++k) {
    const arm::Joints q = test::random_posture(model, random);
    const Pose X_AE = arm::end_pose(model, q);
    poses.push_back(microseconds([&] {
      model.redundant < 0 ? inverse.branches(X_AE) : inverse.branches(X_AE, q[model.redundant]);
    }));
  }
  tell(name, "a frame", frames);
  tell(name, "all branches", poses);
}

}  // namespace

int main() {
  fmt::print("{:<14}{:<22}{:>8}{:>10}{:>10}{:>10}\n", "us", "", "p50", "p99", "p99.9", "worst");
  for (const std::string& name : test::arm_names()) measure(name);
}
