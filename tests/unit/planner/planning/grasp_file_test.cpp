// Saved plans: what is written is read back (poses go through quaternions, so to 1e-12), damaged
// files are refused and never crash, and what is exported is what `prehend grasp quality` reads.
#include "services/planner/tools/planning/grasp_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/base/random.hpp"
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
