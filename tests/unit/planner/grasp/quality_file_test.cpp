// Files for `prehend grasp quality`: contacts become the same wrenches as given ones, and whatever
// is wrong in them is refused with the file and the place.
#include "services/planner/tools/grasp/quality_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "common/analysis/wrench_space.hpp"

namespace {

using namespace prehend;

std::filesystem::path written(const std::string& text) {
  const auto file = std::filesystem::path(testing::TempDir()) / "quality_test.json";
  std::ofstream(file) << text;
  return file;
}

TEST(QualityFile, CrossPolytope) {
  const auto grasp = planner::read_grasp(written(
      R"({"wrenches":[[1,0,0,0,0,0],[0,1,0,0,0,0],[0,0,1,0,0,0],[0,0,0,1,0,0],[0,0,0,0,1,0],
          [0,0,0,0,0,1],[-1,0,0,0,0,0],[0,-1,0,0,0,0],[0,0,-1,0,0,0],[0,0,0,-1,0,0],
          [0,0,0,0,-1,0],[0,0,0,0,0,-1]]})"));
  ASSERT_TRUE(grasp) << grasp.error().message();
  const auto quality = analysis::wrench_quality(grasp->wrenches);
  ASSERT_TRUE(quality);
  EXPECT_NEAR(quality->epsilon, 1 / std::sqrt(6.0), 1e-9);
}

TEST(QualityFile, EdgesOfAContact) {
  const auto grasp = planner::read_grasp(
      written(R"({"contacts":[{"position_m":[0.03,0,0.01],"normal":[-2,0,0],"friction":0.5,
                 "tangent":[0,1,0]}],"center_of_mass_m":[0,0,0.01],"torque_scale_m":0.03,"edges":4})"));
  ASSERT_TRUE(grasp) << grasp.error().message();
  ASSERT_EQ(grasp->wrenches.cols(), 4);
  Eigen::Matrix<double, 6, 4> expected;  // n = -x, t1 = y, t2 = n × t1 = -z; torque = x × f
  expected.col(0) << -1, 0.5, 0, 0, 0, 0.5;
  expected.col(1) << -1, 0, -0.5, 0, 0.5, 0;
  expected.col(2) << -1, -0.5, 0, 0, 0, -0.5;
  expected.col(3) << -1, 0, 0.5, 0, -0.5, 0;
  EXPECT_LT((grasp->wrenches - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(QualityFile, WhatElseMayBeSaid) {
  const auto grasp = planner::read_grasp(written(
      R"({"contacts":[{"position_m":[0.03,0,0.01],"normal":[-2,0,0],"friction":0.5,
          "torsion_m":0.002}],"torque_scale_m":0.03,"load":[0,0,-1,0,0,0.1],"approach":[0,0,-3],
          "shape":{"kind":"cylinder","size_m":[0.03,0.03,0.1]}})"));
  ASSERT_TRUE(grasp) << grasp.error().message();
  EXPECT_EQ(grasp->wrenches.cols(), 26);  // three rings of eight and two poles
  EXPECT_EQ(grasp->contacts[0].torsion, 0.002);
  EXPECT_EQ(grasp->contacts[0].normal_O, Eigen::Vector3d(-1, 0, 0));
  EXPECT_EQ((*grasp->load_O)[5], 0.1);
  EXPECT_EQ(grasp->approach_O->z(), -3);
  EXPECT_EQ(grasp->shape->kind, model::ShapeKind::cylinder);
}

TEST(QualityFile, ReadsWhatExportWrites) {
  // Wrenches as given, contacts for the rest, and the hand about the centre of mass.
  const auto grasp = planner::read_grasp(written(
      R"({"hand":"barrett","joints":[0,0.5,1],"X_OB":{"position_m":[0.1,0,0.2],
          "orientation_wxyz":[2,0,0,0]},"center_of_mass_m":[0,0,0.05],"torque_scale_m":0.03,
          "contacts":[{"link":"tip","position_m":[0,0,0.05],"normal":[1,0,0],"friction":1}],
          "wrenches":[[1,2,3,4,5,6]]})"));
  ASSERT_TRUE(grasp) << grasp.error().message();
  EXPECT_EQ(grasp->wrenches.cols(), 1);
  EXPECT_EQ(grasp->contacts[0].link, "tip");
  EXPECT_EQ(grasp->contacts[0].p_OC, Eigen::Vector3d(0, 0, 0));
  ASSERT_TRUE(grasp->hand);
  EXPECT_EQ(grasp->hand->joints.size(), 3);
  EXPECT_LT((grasp->hand->X_OB.translation() - Eigen::Vector3d(0.1, 0, 0.15)).norm(), 1e-12);
}

TEST(QualityFile, RefusesNonsense) {
  EXPECT_FALSE(planner::read_grasp("/nowhere/at/all.json"));
  const std::string good = R"({"position_m":[0,0,0],"normal":[1,0,0],"friction":1})";
  for (
      const std::string& text : std::vector<std::string>{
          "",
          "[]",
          "{",
          "{}",
          R"({"wrenches":3})",
          R"({"wrenches":[[1,2,3]]})",
          R"({"wrenches":[[1,2,3,4,5,"x"]]})",
          R"({"wrenches":[[1,2,3,4,5,1e999]]})",
          R"({"contacts":[)" + good + "]}",
          R"({"contacts":[)" + good + R"(],"torque_scale_m":0})",
          R"({"contacts":[)" + good + R"(],"torque_scale_m":1,"edges":2})",
          R"({"contacts":[)" + good + R"(],"torque_scale_m":1,"edges":1000000000})",
          R"({"contacts":[{"position_m":[0,0],"normal":[1,0,0],"friction":1}],"torque_scale_m":1})",
          R"({"contacts":[{"position_m":[0,0,0],"normal":[0,0,0],"friction":1}],"torque_scale_m":1})",
          R"({"contacts":[{"position_m":[0,0,0],"normal":[1,0,0],"friction":-1}],"torque_scale_m":1})",
          R"({"contacts":[7],"torque_scale_m":1})",
          R"({"contacts":[{"position_m":[0,0,0],"normal":[1e300,1e300,0],"friction":1}],"torque_scale_m":1})",
          R"({"contacts":[{"position_m":[1e300,0,0],"normal":[0,0,1],"friction":1e300}],"torque_scale_m":1e-9})",
          R"({"contacts":[{"position_m":[0,0,0],"normal":[1,0,0],"friction":1,"torsion_m":-1}],"torque_scale_m":1})",
          R"({"contacts":[)" + good + R"(],"torque_scale_m":1,"load":[1,2,3]})",
          R"({"contacts":[)" + good + R"(],"torque_scale_m":1,"approach":[0,0,0]})",
          R"({"contacts":[)" + good +
              R"(],"torque_scale_m":1,"shape":{"kind":"cloud","size_m":[1,1,1]}})",
          R"({"contacts":[)" + good +
              R"(],"torque_scale_m":1,"shape":{"kind":"box","size_m":[1,-1,1]}})",
          R"({"contacts":[)" + good +
              R"(],"torque_scale_m":1,"hand":"barrett","joints":["x"],"X_OB":{}})",
          R"({"contacts":[)" + good + R"(],"torque_scale_m":1,"wrenches":[[1]]})"}) {
    const auto grasp = planner::read_grasp(written(text));
    EXPECT_FALSE(grasp) << text;
    if (!grasp) {
      EXPECT_NE(grasp.error().message().find("quality_test.json"), std::string::npos);
    }
  }
}

TEST(QualityFile, SaysWhatIsWrong) {
  const auto with = [](const std::string& contact, const std::string& more) {
    return R"({"contacts":[{"position_m":[0,0,0],"normal":[1,0,0],"friction":1)" + contact +
           R"(}],"torque_scale_m":1)" + more + "}";
  };
  for (const auto& [text, says] : std::vector<std::pair<std::string, std::string>>{
           {with(R"(,"tangent":[0,1])", ""), "contact 0: \"tangent\" is not three finite numbers"},
           {with("", R"(,"hand":"barrett","joints":["x"],"X_OB":{"position_m":[0,0,0],
                      "orientation_wxyz":[1,0,0,0]})"),
            "\"joints\" are not finite numbers"},
           {R"({"contacts":3})", "\"contacts\" must be a list of at most "}}) {
    const auto grasp = planner::read_grasp(written(text));
    ASSERT_FALSE(grasp) << says;
    EXPECT_NE(grasp.error().message().find(says), std::string::npos) << grasp.error().message();
  }
}

}  // namespace
