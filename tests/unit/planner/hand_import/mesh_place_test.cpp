// Where the mesh of a name is looked for: each way in which files of others name theirs, on folders
// made for it. The places and their order are those of ROS, of MuJoCo's URDF, and of a file that
// came without its workspace.
#include "services/planner/tools/hand_import/mesh_place.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

namespace {

using namespace prehend;
using std::filesystem::path;

class MeshPlace : public testing::Test {
 protected:
  void SetUp() override {
    root = path(testing::TempDir()) / (std::to_string(getpid()) + "place");
    std::filesystem::remove_all(root);
    std::filesystem::create_directories(root / "robot");
    unsetenv("AMENT_PREFIX_PATH");
    unsetenv("ROS_PACKAGE_PATH");
  }
  void TearDown() override { std::filesystem::remove_all(root); }

  path put(const std::string& file, const std::string& content = "mesh") const {
    std::filesystem::create_directories((root / file).parent_path());
    std::ofstream(root / file) << content;
    return root / file;
  }

  Expected<path> find(const std::string& name, const std::string& folder = {}) const {
    planner::Solid solid;
    solid.mesh = name;
    solid.mesh_folder = folder;
    return planner::find_mesh(solid, root / "robot" / "robot.urdf", packages);
  }

  void expect_found(const std::string& name, const path& file) const {
    const auto found = find(name);
    ASSERT_TRUE(found) << name << ": " << found.error().message();
    EXPECT_EQ(found->lexically_normal(), file) << name;
  }

  path root;
  planner::Packages packages;
};

TEST_F(MeshPlace, IsBesideTheRobotsFile) {
  const path file = put("robot/meshes/a.stl");
  expect_found("meshes/a.stl", file);
  expect_found(file.string(), file);
  expect_found("file://" + file.string(), file);
}

TEST_F(MeshPlace, IsWhereTheRobotsFileSaysThatMeshesAre) {
  const path flat = put("assets/a.stl"), deep = put("assets/visual/b.stl");
  const auto one = find("x/a.stl", "../assets"), two = find("visual/b.stl", "../assets");
  ASSERT_TRUE(one) << one.error().message();
  ASSERT_TRUE(two) << two.error().message();
  EXPECT_EQ(one->lexically_normal(), flat);  // MuJoCo strips the path
  EXPECT_EQ(two->lexically_normal(), deep);
}

TEST_F(MeshPlace, IsInAPackageThatTheEnvironmentKnows) {
  const path ament = put("install/share/first/meshes/a.stl");
  const path near = put("src/second/meshes/a.stl"), deep = put("src/stack/third/meshes/a.stl");
  const path renamed = put("src/checkout-of-fourth/meshes/a.stl");
  put("src/checkout-of-fourth/package.xml", "<package><name>fourth</name></package>");
  setenv("AMENT_PREFIX_PATH", ("/nowhere:" + (root / "install").string()).c_str(), 1);
  setenv("ROS_PACKAGE_PATH", ((root / "src").string() + ":/nowhere").c_str(), 1);
  for (const std::string beginning : {"package://first/", "model://first/", "$(find first)/",
                                      "file://$(find first)/", "$(find-pkg-share first)/"})
    expect_found(beginning + "meshes/a.stl", ament);
  expect_found("package://second/meshes/a.stl", near);
  expect_found("package://third/meshes/a.stl", deep);
  expect_found("package://fourth/meshes/a.stl", renamed);
  // Somebody's home, in which the package had its name.
  expect_found("/home/somebody/ws/install/first/share/first/meshes/a.stl", ament);
}

TEST_F(MeshPlace, IsInAPackageAboveTheRobotsFile) {
  std::filesystem::create_directories(root / "other");
  const path own = put("robot/meshes/own.stl"), beside = put("beside/meshes/b.stl");
  put("robot/package.xml", "<package format=\"3\"><name>robot_description</name></package>");
  expect_found("package://robot_description/meshes/own.stl", own);
  expect_found("package://robot/meshes/own.stl", own);
  expect_found("package://beside/meshes/b.stl", beside);
}

TEST_F(MeshPlace, IsWhereTheUserSays) {
  const path given = put("given/meshes/a.stl");
  put("robot/hand/meshes/a.stl");
  packages["hand"] = root / "given";
  expect_found("package://hand/meshes/a.stl", given);
}

TEST_F(MeshPlace, IsAtLastTheOnlyFileOfItsName) {
  const path only = put("robot/deep/er/a.stl");
  expect_found("package://nobody/meshes/a.stl", only);
  expect_found("/home/somebody/meshes/a.stl", only);
  put("robot/deep/a.stl");
  const auto either = find("package://nobody/meshes/a.stl");
  ASSERT_FALSE(either);
  EXPECT_NE(either.error().what.find("which one"), std::string::npos) << either.error().what;
}

TEST_F(MeshPlace, HasOtherCapitals) {
  const path file = put("robot/meshes/finger.stl");
  const auto found = find("Meshes/Finger.STL");
  ASSERT_FALSE(found);
  EXPECT_NE(found.error().message().find(file.string()), std::string::npos)
      << found.error().message();
  EXPECT_NE(found.error().message().find("capitals"), std::string::npos);
}

TEST_F(MeshPlace, IsNowhereAndSaysWhereItWasLookedFor) {
  setenv("AMENT_PREFIX_PATH", "/opt/robot", 1);
  const auto found = find("package://hand/meshes/a.stl");
  ASSERT_FALSE(found);
  const std::string message = found.error().message();
  for (const std::string part : {"package://hand/meshes/a.stl", "is not there",
                                 "/opt/robot/share/hand/meshes", "--package hand="})
    EXPECT_NE(message.find(part), std::string::npos) << part << " in " << message;
  for (const std::string name :
       {"package://", "package://hand", "$(find hand", "", "/", "file://", "model:///", "."})
    EXPECT_FALSE(find(name)) << name;
}

}  // namespace
