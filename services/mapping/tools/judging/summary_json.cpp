#include "services/mapping/tools/judging/summary_json.hpp"

#include <nlohmann/json.hpp>

namespace prehend::mapping {

namespace {

using Json = nlohmann::ordered_json;

Json bounds(const statistics::Interval& interval) {
  return {interval.low, interval.high};
}

}  // namespace

Json to_json(const ModeSummary& one) {
  Json made{{"hand", one.hand},
            {"mode", to_string(one.mode.mode)},
            {"placement", one.mode.placement},
            {"trials", one.held.count},
            {"held_rate", one.held.mean},
            {"held_ci95", bounds(one.held)},
            {"demonstrated_trials", one.held_of_demonstrated.count},
            {"demonstrated_held_rate", nullptr},
            {"demonstrated_held_ci95", bounds(one.held_of_demonstrated)},
            {"above_direct", nullptr},
            {"above_direct_ci95", nullptr},
            {"joint_error", one.joint_error.mean},
            {"fingertip_error_m", one.fingertip_error.mean},
            {"epsilon", one.epsilon.mean},
            {"penetration_m", one.penetration.mean}};
  if (one.held_of_demonstrated.count > 0)
    made["demonstrated_held_rate"] = one.held_of_demonstrated.mean;
  if (one.real_held.count > 0) {
    made["real_trials"] = one.real_held.count;
    made["real_held_rate"] = one.real_held.mean;
    made["real_held_ci95"] = bounds(one.real_held);
  }
  if (one.above_direct.count > 1) {
    made["above_direct"] = one.above_direct.mean;
    made["above_direct_ci95"] = bounds(one.above_direct);
  }
  return made;
}

}  // namespace prehend::mapping
