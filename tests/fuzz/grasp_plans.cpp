// Damaged plans of grasps, as they lie in a file: refused with a reason, or grasps that the hand
// can make.
#include <google/protobuf/stubs/logging.h>

#include "services/planner/files/plan_store.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"
#include "tests/support/hands.hpp"

using namespace prehend;

namespace {

const grasping::Body object{"thing", {model::ShapeKind::box, {0.03, 0.04, 0.1}}, 0.2, "wood", {},
                            {}};

std::string plan_for(const model::HandModel& hand) {
  grasping::SureGrasp grasp;
  grasp.X_OG = make_pose({0.01, 0.02, 0.03});
  grasp.grasp = {make_pose({0.01, 0.03, 0.03}), hand.postures().at("open"),
                 hand.postures().at("open"),
                 Eigen::VectorXd::Ones(static_cast<Eigen::Index>(hand.dofs().size())), 0.1};
  grasp.room = 0.5;
  return planner::encode({object, {grasp, grasp}, true, ""}, "made for");
}

}  // namespace

int main(int argc, char** argv) {
  google::protobuf::SetLogHandler(nullptr);  // it would report every broken name
  const model::HandModel& hand = test::hand("barrett");
  fuzz::Fuzzer fuzzer;
  fuzzer.seeds = {plan_for(hand)};
  fuzzer.mutate = [](Random& random, std::string bytes) {
    return fuzz::mutate_bytes(random, std::move(bytes));
  };
  fuzzer.target = [&](const std::string& bytes) {
    const auto plan = planner::decode(bytes, hand, object, "made for");
    fuzz::require(plan || !plan.error().what.empty(), "refused without a reason");
    if (!plan) return false;
    for (const grasping::SureGrasp& grasp : plan->grasps) {
      fuzz::require(is_finite(grasp.X_OG) && is_finite(grasp.grasp.X_OG), "a place that is none");
      for (const Eigen::VectorXd* dof : {&grasp.grasp.open, &grasp.grasp.dof})
        fuzz::require(dof->allFinite() && hand.clamp(*dof).isApprox(*dof, 1e-9),
                      "a posture that the hand cannot take");
      fuzz::require(grasp.room >= 0 && grasp.room <= 1, "a room that is no share");
      fuzz::require(grasp.grasp.closing.cwiseAbs().maxCoeff() <= 1, "a direction that is none");
    }
    return true;
  };
  return fuzz::run(fuzzer, argc, argv);
}
