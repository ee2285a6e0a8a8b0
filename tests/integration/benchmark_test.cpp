// `prehend benchmark`: somebody else's mapping, judged as a process of its own by takes that are
// the same for all. Our own mapping serves as the other one, since of it is known what it must come
// to: in lockstep the same as without topics, to the last bit.
#include <algorithm>
#include <fstream>
#include <sstream>

#include "tests/integration/rig.hpp"

namespace prehend::integration {
namespace {

class Benchmark : public Rig {
 protected:
  Answer benchmark(Strings more, double limit_s = 120) {
    Strings arguments{"benchmark", "--hand", "barrett", "--domain", std::to_string(domain_)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run("prehend", arguments, limit_s);
  }
  /// What came of each take (from its number on), without who answered.
  std::vector<std::string> results(const std::string& folder) {
    std::ifstream csv(folder_ / folder / "benchmark.csv");
    std::vector<std::string> rows;
    std::string line;
    std::getline(csv, line);
    while (std::getline(csv, line)) {
      std::istringstream cells(line);
      std::string cell;
      for (int i = 0; i < 3; ++i) std::getline(cells, cell, ',');
      std::getline(cells, cell);
      rows.push_back(cell);
    }
    return rows;
  }
  std::string in(const std::string& name) { return (folder_ / name).string(); }
  static std::string own(const std::string& more) {
    return program("prehend-mapping") + " --set mapping.hand=barrett" + more;
  }
};

TEST_F(Benchmark, JudgesAnotherProcessInLockstepAsItsOwnMapping) {
  // In a lab in which nobody else is, meanwhile.
  stage::Process lonely = start_program(
      "prehend",
      with_lab({"benchmark", "--hand", "barrett", "--trials", "1", "--mapping", "external"}));
  const Answer mine =
      benchmark({"--trials", "2", "--mapping", "intelligent+placement", "--out", in("mine")});
  ASSERT_EQ(mine.exit_code, 0) << mine.log;
  const Answer other = benchmark({"--trials", "2", "--mapping", "external", "--lockstep", "--run",
                                  own(""), "--out", in("other")});
  ASSERT_EQ(other.exit_code, 0) << other.log;
  ASSERT_EQ(results("mine").size(), 2u);
  EXPECT_EQ(results("other"), results("mine"));
  EXPECT_NE(other.output.find("| external |"), std::string::npos) << other.output;
  // Another mode is judged otherwise: the table is not that of whoever sits in this program.
  const Answer direct = benchmark({"--trials", "2", "--mapping", "external", "--lockstep", "--run",
                                   own(" --set mapping.intelligent=false"), "--out", in("direct")});
  ASSERT_EQ(direct.exit_code, 0) << direct.log;
  EXPECT_NE(results("direct"), results("mine"));
  const auto gone = lonely.wait(seconds(60));
  ASSERT_TRUE(gone);
  EXPECT_EQ(gone->code, 3);
  const std::string said = stage::last_lines(folder_ / "prehend.log", 3);
  EXPECT_NE(said.find(name_ + ": nobody reads hand/posture and writes robot/command (does it run"),
            std::string::npos)
      << said;
}

TEST_F(Benchmark, JudgesByObjectsThatNobodyHasTrainedWith) {
  std::ofstream(in("beakers.toml"))
      << "[[object]]\nname = \"Beaker\"\nshape = \"cone\"\nsize = [0.03, 0.04, 0.13]\n"
         "mass = 0.15\nmaterial = \"plastic\"\n";
  const Answer judged = benchmark({"--trials", "2", "--objects", in("beakers.toml"), "--mapping",
                                   "direct,intelligent+placement", "--out", in("beakers")});
  ASSERT_EQ(judged.exit_code, 0) << judged.log;
  std::ifstream csv(in("beakers") + "/benchmark.csv");
  std::string line;
  std::getline(csv, line);
  int rows = 0;
  for (; std::getline(csv, line); ++rows) EXPECT_NE(line.find("Beaker"), std::string::npos);
  EXPECT_EQ(rows, 4);
  EXPECT_EQ(benchmark({"--objects", in("absent.toml")}).exit_code, 2);
  EXPECT_EQ(benchmark({"--objects", "drawn:many"}).exit_code, 2);
}

// The world has the mesh, not what bounds it.
TEST_F(Benchmark, JudgesByMeshesAsTheyAre) {
  std::ofstream mesh(in("block.obj"));  // 40 x 60 x 140 mm
  for (int corner = 0; corner < 8; ++corner)
    mesh << "v " << (corner & 1 ? 0.02 : -0.02) << " " << (corner & 2 ? 0.03 : -0.03) << " "
         << (corner & 4 ? 0.07 : -0.07) << "\n";
  mesh << "f 1 3 4\nf 1 4 2\nf 5 6 8\nf 5 8 7\nf 1 2 6\nf 1 6 5\n"
          "f 3 7 8\nf 3 8 4\nf 1 5 7\nf 1 7 3\nf 2 4 8\nf 2 8 6\n";
  mesh.close();
  const auto judged = [&](const std::string& name, const std::string& more) {
    std::ofstream(in(name + ".toml"))
        << "[[object]]\nname = \"Block\"\nshape = \"box\"\nsize = [0.04, 0.06, 0.14]\n"
           "mass = 0.2\nmaterial = \"wood\"\n"
        << more;
    return benchmark({"--trials", "2", "--objects", in(name + ".toml"), "--mapping",
                      "intelligent+placement", "--out", in(name)});
  };
  const Answer box = judged("box", ""), meshed = judged("meshed", "mesh = \"block.obj\"\n");
  ASSERT_EQ(box.exit_code, 0) << box.log;
  ASSERT_EQ(meshed.exit_code, 0) << meshed.log;
  EXPECT_EQ(results("box").size(), 2u);
  // The same block, of triangles: as good to hold, and not the same to the last bit.
  EXPECT_EQ(results("meshed").size(), 2u);
  EXPECT_NE(results("meshed"), results("box"));
  EXPECT_EQ(judged("none", "mesh = \"nowhere.obj\"\n").exit_code, 3);
}

TEST_F(Benchmark, JudgesByTakesFromFilesAsByThoseItMakes) {
  ASSERT_EQ(benchmark({"--trials", "2", "--seed", "5", "--export", in("takes")}).exit_code, 0);
  const Answer made = benchmark(
      {"--trials", "2", "--seed", "5", "--mapping", "direct,intelligent", "--out", in("made")});
  ASSERT_EQ(made.exit_code, 0) << made.log;
  const Answer read =
      benchmark({"--takes", in("takes"), "--mapping", "direct,intelligent", "--out", in("read")});
  ASSERT_EQ(read.exit_code, 0) << read.log;
  EXPECT_EQ(read.output, made.output);
  EXPECT_EQ(results("read"), results("made"));
  // They are recordings as others are, made for a hand.
  EXPECT_EQ(run("prehend", {"recording", "verify", in("takes/take-0000.mcap")}, 20).exit_code, 0);
  const Answer foreign = run("prehend", {"benchmark", "--hand", "dlr", "--takes", in("takes")}, 20);
  EXPECT_EQ(foreign.exit_code, 3);
  EXPECT_NE(foreign.log.find("holds grasps of the hand «barrett», not of this «dlr»"),
            std::string::npos)
      << foreign.log;
}

// Nearly the same as in lockstep: commands come when they come.
TEST_F(Benchmark, JudgesLiveWhoIsThere) {
  // Of the first takes the fourth is held, however little commands come late.
  ASSERT_EQ(benchmark({"--trials", "4", "--export", in("takes")}).exit_code, 0);
  for (const char* other : {"take-0000.mcap", "take-0001.mcap", "take-0002.mcap"})
    ASSERT_TRUE(std::filesystem::remove(folder_ / "takes" / other));
  const auto mapping = start("mapping", {"mapping.hand=barrett"});
  const Answer live = run("prehend",
                          with_lab({"benchmark", "--hand", "barrett", "--takes", in("takes"),
                                    "--mapping", "external", "--json"}),
                          60);
  ASSERT_EQ(live.exit_code, 0) << live.log;
  EXPECT_NE(live.output.find("\"trials\": 1"), std::string::npos) << live.output;
  EXPECT_NE(live.output.find("\"held_rate\": 1"), std::string::npos) << live.output;
}

TEST_F(Benchmark, SaysWhyNobodyCanBeJudged) {
  const Answer ends = benchmark({"--trials", "1", "--run", "echo no licence; exit 7"});
  EXPECT_EQ(ends.exit_code, 3);
  EXPECT_NE(ends.log.find("no licence"), std::string::npos) << ends.log;
  EXPECT_NE(ends.log.find("ended with code 7"), std::string::npos) << ends.log;
  EXPECT_EQ(benchmark({"--mapping", "telepathy"}).exit_code, 2);
  const Answer nobody = run("prehend", {"benchmark", "--set", "mapping.hand="}, 20);
  EXPECT_EQ(nobody.exit_code, 2);
  EXPECT_NE(nobody.log.find("--hand: names no hand"), std::string::npos) << nobody.log;
  std::ofstream(in("vast.toml")) << "[[object]]\nname = \"Globe\"\nshape = \"sphere\"\n"
                                    "size = [0.5, 0.5, 0.5]\nmass = 1\nmaterial = \"plastic\"\n";
  const Answer vast = benchmark({"--objects", in("vast.toml")});
  EXPECT_EQ(vast.exit_code, 3);
  EXPECT_NE(vast.log.find("barrett: there is no grasp to repeat"), std::string::npos) << vast.log;
  EXPECT_EQ(benchmark({"--takes", in("nowhere")}).exit_code, 3);
}

}  // namespace
}  // namespace prehend::integration
