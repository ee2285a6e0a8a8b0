// `prehend grasp plan`, `export`, `picture` and `table` as a user calls them: wrong use is exit
// code 2, no grasp is 1, what one command writes the next one reads.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/paths/paths.hpp"

namespace {

using Json = nlohmann::json;

std::filesystem::path scratch(const std::string& name) {
  return std::filesystem::path(testing::TempDir()) / (std::to_string(getpid()) + name);
}

struct Answer {
  int code = -1;
  std::string output, complaint;
};

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  std::filesystem::remove(file);
  return text.str();
}

Answer run(const std::string& arguments, const std::string& before = {}) {
  const auto output = scratch("out"), complaint = scratch("err");
  const std::string command = before + prehend::test::in_programs("prehend-grasp") + " " +
                              arguments + " >" + output.string() + " 2>" + complaint.string();
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(output), text_of(complaint)};
}

TEST(GraspTool, WrongUseIsTwoAndSaysWhy) {
  for (const auto& [arguments, says] : std::vector<std::pair<std::string, std::string>>{
           {"plan --hand nobody --object Talc", "barrett"},
           {"plan --hand barrett --object Nothing", "Talc"},
           {"plan --hand barrett --object Talc --candidates 0", "candidates"},
           {"plan --object Talc", "--hand"},
           {"export /nowhere/at.all", "at.all"},
           {"export", "FILE"},
           {"picture /nowhere/at.all -o x.png", "at.all"},
           {"table --objects Nothing", "Talc"},
           {"table --most 0", "--most"},
           {"table --resume", "--save"}}) {
    const Answer answer = run(arguments);
    EXPECT_EQ(answer.code, 2) << arguments;
    EXPECT_NE(answer.complaint.find(says), std::string::npos) << arguments << answer.complaint;
    EXPECT_TRUE(answer.output.empty()) << arguments;
  }
}

// Guards objects of a user's own, which only the shipped catalogue was asked for.
TEST(GraspTool, ObjectsAreThoseOfTheLabsCatalogue) {
  const auto catalogue = scratch("mine.toml"), lab = scratch("lab.toml");
  std::ofstream(catalogue) << "[[object]]\nname = \"Mine\"\nshape = \"cylinder\"\n"
                              "size = [0.024, 0.024, 0.105]\nmass = 0.15\nmaterial = \"plastic\"\n";
  std::ofstream(lab) << "[lab]\ncatalogue = \"" << catalogue.string() << "\"\n";
  const std::string by_file = " --catalogue " + catalogue.string();
  for (const auto& [before, named] :
       {std::pair(std::string(), by_file), std::pair(std::string(), " --config " + lab.string()),
        std::pair("PREHEND_LAB_CATALOGUE=" + catalogue.string() + " ", std::string())}) {
    const Answer made = run("taxonomy --json --object Mine" + named, before);
    EXPECT_EQ(made.code, 0) << before << named << made.complaint;
    for (const char* command :
         {"plan --hand barrett --object Talc", "taxonomy --object Talc",
          "candidates --hand barrett --object Talc", "table --objects Talc"}) {
      const Answer other = run(command + named, before);
      EXPECT_EQ(other.code, 2) << command << named;
      EXPECT_NE(other.complaint.find("mine.toml has Mine"), std::string::npos) << other.complaint;
    }
  }
  const Answer planned = run("plan --hand barrett --object Mine --candidates 4 --seed 3" + by_file);
  EXPECT_LE(planned.code, 1) << planned.complaint;
  std::filesystem::remove(catalogue);
  std::filesystem::remove(lab);
}

TEST(GraspTool, WhatIsPlannedIsExportedDrawnAndJudgedAlike) {
  const std::string file = scratch("talc.grasps").string();
  const Answer planned =
      run("plan --hand barrett --object Talc --candidates 8 --seed 3 --json -o " + file);
  ASSERT_EQ(planned.code, 0) << planned.complaint;
  const Json plan = Json::parse(planned.output);
  EXPECT_EQ(plan["candidates"], 8);
  ASSERT_FALSE(plan["grasps"].empty());
  // Three fingers that close on a cylinder meet nothing of each other when they open.
  EXPECT_EQ(plan["grasps"][0]["blocking"], "");

  const Answer exported = run("export --index 0 " + file);
  ASSERT_EQ(exported.code, 0);
  const auto grasp = scratch("grasp.json");
  std::ofstream(grasp) << exported.output;
  const Answer judged = run("quality --json " + grasp.string());
  ASSERT_EQ(judged.code, 0) << judged.complaint;
  EXPECT_NEAR(Json::parse(judged.output)["epsilon"].get<double>(),
              plan["grasps"][0]["epsilon"].get<double>(), 1e-9);
  EXPECT_EQ(run("export --format csv --table contacts " + file).code, 0);
  EXPECT_EQ(run("export --index 99 " + file).code, 2);

  const auto picture = scratch("grasp.png");
  EXPECT_EQ(run("picture --width 160 --height 120 -o " + picture.string() + " " + file).code, 0);
  EXPECT_GT(std::filesystem::file_size(picture), 1000u);
  EXPECT_EQ(run("picture -o /nowhere/at/all.png --width 64 --height 64 " + file).code, 3);
  for (const auto& made : {std::filesystem::path(file), grasp, picture})
    std::filesystem::remove(made);
}

// What does not fit (Pringles are wider than the Rutgers hand) is tried again with four times as
// many candidates; resumed, the same answer is read from the file.
TEST(GraspTool, ATableTriesLongerWhereNothingHeld) {
  const auto folder = scratch("plans");
  std::filesystem::create_directory(folder);
  const std::string asked =
      "table --hands rutgers --objects Pringles --candidates 1 --most 5 "
      "--json --save " +
      folder.string();
  const Answer made = run(asked);
  ASSERT_EQ(made.code, 0) << made.complaint;
  const Json cell = Json::parse(made.output)["grasps"][0];
  EXPECT_EQ(cell["held"], false);
  EXPECT_NE(cell["reason"].get<std::string>().find("wider"), std::string::npos);
  EXPECT_NE(made.complaint.find("4 of 4"), std::string::npos) << made.complaint;
  const Answer resumed = run(asked + " --resume");
  EXPECT_EQ(resumed.code, 0);
  EXPECT_EQ(resumed.complaint.find("closing"), std::string::npos) << resumed.complaint;
  EXPECT_EQ(Json::parse(resumed.output)["grasps"][0], cell);
  std::filesystem::remove_all(folder);
}

}  // namespace
