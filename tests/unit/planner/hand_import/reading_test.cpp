// What strangers bring is read as its writers meant it: meshes, numbers, xacro, and MuJoCo's
// dialect of URDF.
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Core>
#include <cstdlib>
#include <fstream>

#include "common/base/finite_number.hpp"
#include "services/planner/tools/hand_import/mesh.hpp"
#include "services/planner/tools/hand_import/robot_file.hpp"

namespace {

using namespace prehend;
using std::filesystem::path;

class Reading : public testing::Test {
 protected:
  void SetUp() override {
    folder = path(testing::TempDir()) / (std::to_string(getpid()) + "reading");
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  path put(const std::string& file, const std::string& content) const {
    std::ofstream(folder / file) << content;
    return folder / file;
  }

  Expected<std::vector<Eigen::Vector3d>> mesh(const std::string& name) const {
    planner::Solid solid;
    solid.mesh = name;
    return planner::mesh_files(folder / "robot.urdf")(solid);
  }

  path folder;
};

/// A tetrahedron with edges of 12, 16 and 60 units along x, y and z.
std::string collada(const std::string& up, const std::string& unit) {
  return "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
         "version=\"1.4.1\"><asset>" +
         unit + "<up_axis>" + up +
         "</up_axis></asset><library_geometries><geometry id=\"g\"><mesh><source id=\"p\">"
         "<float_array id=\"f\" count=\"12\">0 0 0 12 0 0 0 16 0 0 0 60</float_array>"
         "<technique_common><accessor source=\"#f\" count=\"4\" stride=\"3\">"
         "<param name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/>"
         "<param name=\"Z\" type=\"float\"/></accessor></technique_common></source>"
         "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>"
         "<triangles count=\"4\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>"
         "<p>0 1 2 0 1 3 0 2 3 1 2 3</p></triangles></mesh></geometry></library_geometries>"
         "<library_visual_scenes><visual_scene id=\"s\"><node id=\"n\">"
         "<instance_geometry url=\"#g\"/></node></visual_scene></library_visual_scenes>"
         "<scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>";
}

TEST_F(Reading, ColladaAsItsVerticesAreInItsUnit) {
  const std::string mm = "<unit name=\"millimeter\" meter=\"0.001\"/>";
  for (const std::string up : {"X_UP", "Y_UP", "Z_UP"}) {
    put("finger.dae", collada(up, mm));
    const auto points = mesh("finger.dae");
    ASSERT_TRUE(points) << points.error().message();
    Eigen::Vector3d high = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : *points) high = high.cwiseMax(p);
    EXPECT_LT((high - Eigen::Vector3d(0.012, 0.016, 0.06)).norm(), 1e-8) << up;  // floats
  }
}

TEST_F(Reading, MeshesThatWereNotFetched) {
  put("empty.stl", "");
  put("pointer.stl", "version https://git-lfs.github.com/spec/v1\noid sha256:" +
                         std::string(64, '7') + "\nsize 48384\n");
  EXPECT_NE(mesh("empty.stl").error().message().find("is empty"), std::string::npos);
  const std::string message = mesh("pointer.stl").error().message();
  EXPECT_NE(message.find("is a Git LFS pointer"), std::string::npos) << message;
  EXPECT_NE(message.find("git lfs pull"), std::string::npos) << message;
  put("words.stl", "no mesh");
  put("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  for (const auto& [name, says] :
       {std::pair("words.stl", "is no mesh that can be read"),
        std::pair("nan.obj", "has no vertices, or some that are not finite (export it again)")}) {
    const auto points = mesh(name);
    ASSERT_FALSE(points) << name;
    EXPECT_NE(points.error().message().find(name + std::string(": ") + says), std::string::npos)
        << points.error().message();
  }
}

TEST(ReadingNumbers, TooSmallIsZeroAndTooLargeIsNone) {
  for (const char* tiny : {"5e-400", "-5e-400", "1e-320", "3.1E-312", "0.0e-999", "+1e-9999"})
    EXPECT_EQ(finite_number(tiny), 0.0) << tiny;
  for (const char* wrong : {"1e400", "-1e400", "nan", "inf", "1e", "0x10", "", "+", "1,5", "1 2"})
    EXPECT_FALSE(finite_number(wrong)) << wrong;
  EXPECT_EQ(finite_number("+2.5e-3"), 2.5e-3);
  EXPECT_EQ(finite_numbers(" 1\t2\n-3 "), (std::vector<double>{1, 2, -3}));
  EXPECT_FALSE(finite_numbers("1 2 x"));
}

TEST_F(Reading, TheMeshFolderOfMujocosUrdf) {
  const auto robot = planner::read_robot(
      "<robot name='a'><mujoco><compiler meshdir='../assets'/></mujoco><link name='b'><collision>"
      "<geometry><mesh filename='c.stl'/></geometry></collision></link></robot>");
  ASSERT_TRUE(robot) << robot.error().message();
  EXPECT_EQ(robot->links.at(0).collision.at(0).mesh_folder, "../assets");
}

TEST_F(Reading, AZeroByteIsNoText) {
  EXPECT_EQ(planner::read_robot(std::string("<robot/>\0", 9)).error().message(),
            "holds a zero byte (XML is text)");
}

constexpr const char* xacro_text =
    "<robot name='a' xmlns:xacro='http://www.ros.org/wiki/xacro'><link name='b'>"
    "<xacro:if value='1'/></link></robot>";

TEST_F(Reading, XacroSaysThatItMustBeExpanded) {
  const std::string before = std::getenv("PATH");
  const path file = put("hand.urdf.xacro", xacro_text);
  setenv("PATH", folder.c_str(), 1);
  const auto robot = planner::read_robot_file(file);
  put("xacro", "no program");
  const auto blocked = planner::read_robot_file(file);
  setenv("PATH", before.c_str(), 1);
  ASSERT_FALSE(blocked);
  EXPECT_NE(blocked.error().message().find("hand.urdf.xacro: xacro cannot be run: Permission"),
            std::string::npos)
      << blocked.error().message();
  ASSERT_FALSE(robot);
  EXPECT_NE(robot.error().message().find("is xacro"), std::string::npos);
  EXPECT_NE(robot.error().message().find("xacro FILE > FILE.urdf"), std::string::npos);
}

/// Another program of this name, which tells what it was called with, and refuses `bad`.
TEST_F(Reading, XacroIsExpandedByItsProgram) {
  const std::string before = std::getenv("PATH");
  const path program = put("xacro",
                           "#!/bin/sh\n[ \"$2\" != bad:=1 ] || { echo why not >&2; exit 2; }\n"
                           "echo \"<robot name='$2'><link name='b'/></robot>\"\n");
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  const path file = put("hand.urdf.xacro", xacro_text);
  setenv("PATH", (folder.string() + ":" + before).c_str(), 1);
  const auto robot = planner::read_robot_file(file, {{}, {"side:=left; false"}});
  const auto refused = planner::read_robot_file(file, {{}, {"bad:=1"}});
  setenv("PATH", before.c_str(), 1);
  ASSERT_TRUE(robot) << robot.error().message();
  EXPECT_EQ(robot->name, "side:=left; false");  // no shell has read it
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message().find("why not"), std::string::npos);
}

TEST_F(Reading, AMissingPartOfMujocosFileIsNamed) {
  const auto robot = planner::read_robot_file(
      put("hand.xml",
          "<mujoco><include file='rest.xml'/><worldbody><body name='b'/></worldbody></mujoco>"));
  ASSERT_TRUE(robot) << robot.error().message();
  ASSERT_FALSE(robot->findings.empty());
  EXPECT_NE(robot->findings[0].what.find("there is no such file"), std::string::npos)
      << robot->findings[0].what;
}

}  // namespace
