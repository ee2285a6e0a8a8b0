// Saved plans: what is written is read back (poses go through quaternions, so to 1e-12), damaged
// files are refused and never crash, and what is exported is what `prehend grasp quality` reads.
#include "services/planner/tools/planning/grasp_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/base/random.hpp"
#include "common/proto/grasp.pb.h"
#include "services/planner/tools/grasp/quality_file.hpp"
#include "services/planner/tools/planning/export.hpp"
#include "tests/unit/planner/planning/plans.hpp"

namespace prehend::planner {
namespace {

using grasping::Plan;
using grasping::PlannedGrasp;

std::filesystem::path scratch(const std::string& name) {
  return std::filesystem::path(testing::TempDir()) / (std::to_string(getpid()) + name);
}

TEST(GraspFile, IsReadBackAsItWasWritten) {
  const Plan& plan = barrett_on_talc();
  const auto file = scratch("plan.grasps");
  ASSERT_TRUE(save(file, plan));
  const auto read = load_plan(file);
  ASSERT_TRUE(read) << read.error().message();
  std::filesystem::remove(file);
  EXPECT_EQ(read->hand, plan.hand);
  EXPECT_EQ(read->object.name, plan.object.name);
  EXPECT_EQ(read->object.shape, plan.object.shape);
  EXPECT_EQ(read->options.seed, plan.options.seed);
  EXPECT_EQ(read->refused, plan.refused);
  EXPECT_EQ(read->closed, plan.closed);
  ASSERT_EQ(read->grasps.size(), plan.grasps.size());
  ASSERT_FALSE(plan.grasps.empty());
  for (std::size_t i = 0; i < plan.grasps.size(); ++i) {
    const PlannedGrasp &a = plan.grasps[i], &b = read->grasps[i];
    EXPECT_TRUE(a.X_OB.isApprox(b.X_OB, 1e-12));
    EXPECT_EQ(a.dof, b.dof);
    EXPECT_EQ(a.joints, b.joints);
    EXPECT_EQ(a.preshape, b.preshape);
    EXPECT_EQ(a.wrenches, b.wrenches);
    EXPECT_EQ(a.quality.epsilon, b.quality.epsilon);
    EXPECT_EQ(a.quality.weakest_direction, b.quality.weakest_direction);
    EXPECT_EQ(a.hold.held, b.hold.held);
    EXPECT_EQ(a.hold.shake, b.hold.shake);
    ASSERT_EQ(a.contacts.size(), b.contacts.size());
    for (std::size_t k = 0; k < a.contacts.size(); ++k) {
      EXPECT_EQ(a.contacts[k].link, b.contacts[k].link);
      EXPECT_EQ(a.contacts[k].p_OC, b.contacts[k].p_OC);
      EXPECT_EQ(a.contacts[k].normal_O, b.contacts[k].normal_O);
    }
  }
}

TEST(GraspFile, MutationsAreRefusedOrReadAsSoundPlans) {
  // The seal notices damage to the file; here the bytes behind the seal are mutated as well.
  const std::string bytes = serialise(barrett_on_talc());
  const int rounds = std::getenv("PREHEND_LONG") ? 10'000 : 300;
  Random random(1);
  int refused = 0;
  for (int i = 0; i < rounds; ++i) {
    std::string mutated = bytes;
    for (std::size_t k = random.index(4) + 1; k-- > 0;)
      mutated[random.index(mutated.size())] = static_cast<char>(random.bits());
    if (random.uniform() < 0.2) mutated.resize(random.index(mutated.size()));
    const auto read = parse_plan(mutated);
    if (!read) {
      EXPECT_FALSE(read.error().what.empty());
      ++refused;
      continue;
    }
    EXPECT_TRUE(model::is_valid(read->object.shape));
    for (const PlannedGrasp& grasp : read->grasps) {
      EXPECT_TRUE(is_finite(grasp.X_OB) && grasp.dof.allFinite() && grasp.wrenches.allFinite());
      EXPECT_EQ(grasp.dof.size(), grasp.preshape.size());
    }
  }
  EXPECT_GT(refused, rounds / 10);
}

TEST(GraspFile, AnotherFileIsRefusedWithAReason) {
  EXPECT_FALSE(load_plan("/nowhere/at.all"));
  const auto file = scratch("nothing.grasps");
  std::ofstream(file) << "{}";
  const auto read = load_plan(file);
  std::filesystem::remove(file);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message().find("nothing.grasps"), std::string::npos);
}

// Each fault in what is behind the seal has its own words.
TEST(GraspFile, WhatIsSpoiltIsNamed) {
  using Saved = messages::SavedPlan;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<void (*)(Saved&), std::string>> faults{
      {[](Saved& p) { p.add_size(1); }, "size of the object: wrong number of values"},
      {[](Saved& p) { p.set_size(0, nan); }, "size of the object: values are not finite"},
      {[](Saved& p) { p.set_shape("cloud"); }, "object: is of no known shape"},
      {[](Saved& p) { p.set_size(2, -1); }, "object: has no valid shape"},
      {[](Saved& p) { p.set_mass(0); }, "object: mass must be positive"},
      {[](Saved& p) { p.set_material("air"); }, "object: unknown material"},
      {[](Saved& p) { p.set_closed(1u << 31); }, "plan: counts are out of range"},
      {[](Saved& p) { p.mutable_grasps(0)->set_volume(nan); }, "grasp: quality is not finite"},
      {[](Saved& p) { p.mutable_grasps(0)->mutable_hold()->set_slip(-1); },
       "hold test: values must be 0 or more"},
      {[](Saved& p) { p.mutable_grasps(0)->mutable_contacts(0)->set_force(-1); },
       "contact: values must be 0 or more"},
      {[](Saved& p) { p.mutable_grasps(0)->mutable_contacts(0)->set_normal(0, 9); },
       "contact: normal is not of unit length"},
      {[](Saved& p) {
         for (int i = 0; i < 1001; ++i) p.mutable_grasps(0)->add_contacts();
       },
       "grasp: too many contacts"}};
  const std::string bytes = serialise(barrett_on_talc());
  for (const auto& [spoil, says] : faults) {
    Saved plan;
    ASSERT_TRUE(plan.ParseFromString(bytes));
    spoil(plan);
    const auto read = parse_plan(plan.SerializeAsString());
    ASSERT_FALSE(read) << says;
    EXPECT_EQ(read.error().message(), says);
  }
}

TEST(Export, JsonIsWhatQualityReads) {
  const Plan& plan = barrett_on_talc();
  const auto file = scratch("grasp.json");
  for (const PlannedGrasp& grasp : plan.grasps)
    for (const bool by_contacts : {false, true}) {
      nlohmann::ordered_json document = to_json(plan, grasp);
      if (by_contacts) document.erase("wrenches");
      std::ofstream(file) << document;
      const auto read = read_grasp(file);
      ASSERT_TRUE(read) << read.error().message();
      const auto quality = analysis::wrench_quality(read->wrenches);
      ASSERT_TRUE(quality);
      // Normals are made unit once more on the way, which rounds.
      EXPECT_NEAR(quality->epsilon, grasp.quality.epsilon, 1e-9);
    }
  std::filesystem::remove(file);
}

TEST(Export, TablesHaveARowForEverything) {
  const Plan& plan = barrett_on_talc();
  std::size_t contacts = 0, wrenches = 0;
  for (const PlannedGrasp& grasp : plan.grasps) {
    contacts += grasp.contacts.size();
    wrenches += static_cast<std::size_t>(grasp.wrenches.cols());
  }
  const auto rows = [&](Table table) {
    const std::string text = to_csv(plan, table);
    const auto commas = [](const std::string& line) {
      return std::count(line.begin(), line.end(), ',');
    };
    std::istringstream stream(text);
    std::string header, line;
    std::getline(stream, header);
    std::size_t count = 0;
    for (; std::getline(stream, line); ++count) EXPECT_EQ(commas(line), commas(header)) << line;
    return count;
  };
  EXPECT_EQ(rows(Table::grasps), plan.grasps.size());
  EXPECT_EQ(rows(Table::contacts), contacts);
  EXPECT_EQ(rows(Table::wrenches), wrenches);
  EXPECT_EQ(rows(Table::dof), 4 * plan.grasps.size());
}

}  // namespace
}  // namespace prehend::planner
