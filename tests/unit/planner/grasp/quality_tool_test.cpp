// `prehend grasp quality` as a program: its JSON document, both methods, the picture, and exit
// codes 0 measured, 2 wrong use or file, 3 no picture. Tolerances as in
// analysis/resistance_test.cpp.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "tests/support/paths/paths.hpp"

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

struct Result {
  int code = -1;
  std::string output;
};

/// Runs shell text; standard error goes where the test's goes.
Result answer(const std::string& command) {
  Result result;
  std::FILE* pipe = ::popen(command.c_str(), "r");
  if (!pipe) return result;
  char buffer[4096];
  for (std::size_t n; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;)
    result.output.append(buffer, n);
  const int status = ::pclose(pipe);
  result.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return result;
}

/// `prehend-grasp quality` with these arguments.
Result run(const std::string& arguments, const std::string& before = {}) {
  return answer(before + prehend::test::in_programs("prehend-grasp quality ") + arguments);
}

std::string written(const Json& document) {
  const fs::path file = fs::path(testing::TempDir()) / "quality_tool_test.json";
  std::ofstream(file) << document;
  return file.string();
}

/// A ring of equal contacts about a cylinder of 30 mm, with a load across it.
Json ring(int count, double friction) {
  Json contacts = Json::array();
  for (int i = 0; i < count; ++i) {
    const double a = 2 * std::numbers::pi * i / count;
    contacts.push_back({{"position_m", {0.03 * std::cos(a), 0.03 * std::sin(a), 0}},
                        {"normal", {-std::cos(a), -std::sin(a), 0}},
                        {"friction", friction},
                        {"tangent", {0, 0, 1}}});
  }
  return {{"contacts", contacts}, {"torque_scale_m", 0.06}, {"edges", 8}};
}

TEST(QualityTool, BothMethodsSayTheSame) {
  const std::string file = written(ring(4, 0.6));
  const Result full = run(file + " --json"), fast = run(file + " --json --method fast");
  ASSERT_EQ(full.code, 0);
  ASSERT_EQ(fast.code, 0);
  const Json a = Json::parse(full.output), b = Json::parse(fast.output);
  EXPECT_NEAR(a["epsilon"].get<double>(), b["epsilon"].get<double>(), 1e-9);
  EXPECT_GT(a["epsilon"], 0);
  EXPECT_GT(a["volume"], 0);
  EXPECT_TRUE(b["volume"].is_null());
  EXPECT_EQ(a["force_closure"], true);
  EXPECT_EQ(b["force_closure"], true);
  EXPECT_EQ(b["weakest_direction"].size(), 6u);
  EXPECT_GT(b["epsilon_linf"], b["epsilon"]);
  EXPECT_EQ(b["internal_force_dimension"], 6);
}

TEST(QualityTool, LoadAndApproach) {
  Json grasp = ring(2, 0.5);
  grasp["load"] = {0, 0, -2, 0, 0, 0};
  grasp["approach"] = {0, 1, 1};
  grasp["shape"] = {{"kind", "cylinder"}, {"size_m", {0.03, 0.03, 0.2}}};
  const Result told = run(written(grasp) + " --json --method fast");
  ASSERT_EQ(told.code, 0);
  const Json document = Json::parse(told.output);
  EXPECT_EQ(document["epsilon"], -1);
  EXPECT_NEAR(document["grip"]["largest_normal_force_n"].get<double>(), 2, 1e-7);  // 2 / (2 μ)
  EXPECT_NEAR(document["skewness_rad"].get<double>(), std::numbers::pi / 4, 1e-9);
  grasp["load"] = {0, 0, 0, 1, 0, 0};  // about the line of two points: nothing holds that
  EXPECT_TRUE(Json::parse(run(written(grasp) + " --json").output)["grip"].is_null());
}

TEST(QualityTool, ThousandsOfContactsAreMeasuredOrRefused) {
  Json grasp = ring(3000, 0.6);
  for (std::size_t i = 0; i < 3000; ++i)
    grasp["contacts"][i]["position_m"][2] = 0.02 * std::sin(7.0 * static_cast<double>(i));
  const std::string file = written(grasp);
  const Result full = run(file + " --json 2>&1");
  EXPECT_EQ(full.code, 2);
  EXPECT_NE(full.output.find("--method fast"), std::string::npos);
  const Result fast = run(file + " --json --method fast");
  ASSERT_EQ(fast.code, 0);
  EXPECT_EQ(Json::parse(fast.output)["force_closure"], true);
}

TEST(QualityTool, WrongUseAndFiles) {
  const std::string file = written(ring(3, 0.6));
  EXPECT_EQ(run("/nowhere.json 2>/dev/null").code, 2);
  EXPECT_EQ(run(file + " --method slow 2>/dev/null").code, 2);
  EXPECT_EQ(run("2>/dev/null").code, 2);
  EXPECT_EQ(run("--help >/dev/null").code, 0);
  Json bad = ring(3, 0.6);
  bad["contacts"][1]["friction"] = -0.1;
  const Result refused = run(written(bad) + " --json 2>&1");
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.output.find("contact 1"), std::string::npos);
}

TEST(QualityTool, Picture) {
  const fs::path png = fs::path(testing::TempDir()) / "quality tool's.png";
  fs::remove(png);
  const std::string option = " --method fast --picture \"" + png.string() + "\" >/dev/null";
  const std::string file = written(ring(4, 0.6));
  if (std::system("gnuplot --version >/dev/null 2>&1") == 0) {
    EXPECT_EQ(run(file + option).code, 0);
    std::ifstream stream(png, std::ios::binary);
    std::string start(8, '\0');
    stream.read(start.data(), 8);
    EXPECT_EQ(start, "\x89PNG\r\n\x1a\n");
    EXPECT_GT(fs::file_size(png), 5000u);
    fs::remove(png);
    // A flat wrench space is a picture too.
    EXPECT_EQ(run(written(ring(1, 0.6)) + option).code, 0);
    EXPECT_TRUE(fs::exists(png));
    fs::remove(png);
  }
  EXPECT_EQ(run(file + option + " 2>&1", "PATH=/nowhere ").code, 3);
  EXPECT_FALSE(fs::exists(png));
}

// What `classify` and `taxonomy` are given is no plan, no grasp, of no hand, and no task.
TEST(QualityTool, TheTaxonomysCommandsSayWhatTheyCannotUse) {
  const std::string program = prehend::test::in_programs("prehend-grasp ");
  const std::string file = written(ring(3, 0.6));
  for (const auto& [arguments, says] : std::vector<std::pair<std::string, std::string>>{
           {"taxonomy --task dance", "dance: is no kind of task (there are "},
           {"classify " + file, ".json: names no hand (write it with prehend grasp export"},
           {"classify " + prehend::test::in_sources("README.md"),
            "README.md: is neither a plan nor a grasp as JSON: "}}) {
    const Result refused = answer(program + arguments + " 2>&1");
    EXPECT_EQ(refused.code, 2) << arguments;
    EXPECT_NE(refused.output.find(says), std::string::npos) << refused.output;
  }
}

}  // namespace
