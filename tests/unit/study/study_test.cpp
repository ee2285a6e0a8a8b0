// The study as a user calls it: a JSON document that keeps its contract, files that say the same,
// and the same answer however the work is divided. What is found is not judged here: it is what the
// study is for.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "tests/support/paths/paths.hpp"
#include "tests/support/shared_data.hpp"

namespace {

using Json = nlohmann::json;

struct Answer {
  int code = -1;
  std::string out;
};

Answer run(const std::string& arguments) {
  Answer answer;
  FILE* pipe = popen(
      (prehend::test::in_programs("prehend-study") + " 2>/dev/null " + arguments).c_str(), "r");
  if (!pipe) return answer;
  char buffer[4096];
  while (const auto count = std::fread(buffer, 1, sizeof buffer, pipe))
    answer.out.append(buffer, count);
  answer.code = WEXITSTATUS(pclose(pipe));
  return answer;
}

std::filesystem::path scratch() {
  return std::filesystem::path(testing::TempDir()) / ("study" + std::to_string(getpid()));
}

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

TEST(Study, PrintsItsFindingsAndWritesItsFiles) {
  const auto folder = scratch();
  const Answer answer = run("--quick --json --only 5.18,6.2 --out " + folder.string());
  ASSERT_EQ(answer.code, 0);
  const Json document = Json::parse(answer.out);
  EXPECT_TRUE(document.at("grasp_benchmark").empty());
  std::map<std::string, int> findings;
  for (const Json& finding : document.at("findings")) {
    ++findings[finding.at("figure")];
    for (const char* key : {"claim", "measured", "reason"})
      EXPECT_FALSE(finding.at(key).get<std::string>().empty()) << finding;
    EXPECT_EQ(finding.at("reproduced").get<bool>(), finding.at("verdict") == "reproduced");
    EXPECT_TRUE(std::set<std::string>({"reproduced", "not reproduced", "undecided"})
                    .contains(finding.at("verdict")));
  }
  EXPECT_EQ(findings, (std::map<std::string, int>{{"5.18", 3}, {"6.2", 1}}));

  const std::string html = text_of(folder / "report.html");
  for (const Json& finding : document.at("findings"))
    EXPECT_NE(html.find(finding.at("claim").get<std::string>()), std::string::npos);
  for (const std::string figure : {"5.18", "6.2"}) {
    EXPECT_EQ(text_of(folder / (figure + ".png")).substr(1, 3), "PNG");
    // The mean and interval of every point, in this order.
    std::istringstream csv(text_of(folder / (figure + ".csv")));
    std::string line;
    std::getline(csv, line);
    EXPECT_EQ(line, "series,x,mean,ci95_low,ci95_high,count");
    int points = 0;
    for (; std::getline(csv, line); ++points) {
      double mean = 0, low = 0, high = 0;
      ASSERT_EQ(std::sscanf(line.c_str(), "%*[^,],%*[^,],%lf,%lf,%lf", &mean, &low, &high), 3);
      EXPECT_LE(low, mean);
      EXPECT_LE(mean, high);
    }
    EXPECT_GT(points, 1);
    const std::string all = text_of(folder / (figure + "-repetitions.csv"));
    EXPECT_EQ(std::count(all.begin(), all.end(), '\n'), 101);
  }
  std::filesystem::remove_all(folder);
}

TEST(Study, IsTheSameForASeedHoweverTheWorkIsDivided) {
  const auto findings = [](const std::string& arguments) {
    return Json::parse(run("--quick --json --only 6.2 " + arguments).out).at("findings");
  };
  const Json one = findings("--threads 1");
  EXPECT_EQ(one, findings("--threads 3"));
  EXPECT_NE(one, findings("--seed 2"));
}

// The fingers of real hands, on which nobody was trained: the robot hand closes where they close.
TEST(Study, FollowsRealFingers) {
  const std::string recordings = (prehend::shared_data() / "leap_hand_recordings").string();
  if (!std::filesystem::exists(recordings)) GTEST_SKIP() << "no " << recordings;
  const auto folder = scratch();
  const Answer answer =
      run("--quick --json --only real --recordings " + recordings + " --out " + folder.string());
  ASSERT_EQ(answer.code, 0);
  EXPECT_EQ(Json::parse(answer.out).at("findings").size(), 6u);
  std::istringstream csv(text_of(folder / "real.csv"));
  std::string line;
  std::getline(csv, line);
  int series = 0;
  while (std::getline(csv, line)) {
    char measure[64] = "";
    double mean = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%*[^,],%63[^,],%lf", measure, &mean), 2) << line;
    EXPECT_LE(mean, 1) << line;  // shares and correlations
    if (std::string(measure) != "grab") continue;
    EXPECT_GT(mean, 0) << line << ": who grabs closes the hand";
    ++series;
  }
  EXPECT_EQ(series, 6);  // three hands, direct and intelligent
  std::filesystem::remove_all(folder);
}

TEST(Study, LeavesRealFingersOutWhereThereAreNone) {
  const Answer answer = run("--quick --json --only real --recordings /nowhere");
  EXPECT_EQ(answer.code, 0);
  EXPECT_TRUE(Json::parse(answer.out).at("findings").empty());
}

// The machines that share a benchmark come to what one of them would, byte for byte, also when one
// was broken off.
TEST(Study, IsTheSameInShards) {
  const auto folder = scratch();
  const std::string asked =
      "--only benchmark --hands barrett --modes direct --trials 3 --threads 2";
  const auto shards = (folder / "shards").string();
  const Answer one = run(asked + " --out " + (folder / "one").string());
  ASSERT_EQ(one.code, 0);
  ASSERT_EQ(run(asked + " --shard 2/2 --out " + shards).code, 0);
  EXPECT_EQ(run("--progress " + shards).code, 1);
  // A file of another seed is not gone on with.
  EXPECT_EQ(run(asked + " --seed 2 --shard 2/2 --out " + shards).code, 3);
  // Nor is one of another part.
  std::filesystem::copy(shards + "/shard-2-of-2.shard", shards + "/shard-1-of-2.shard");
  const Answer foreign = run(asked + " --shard 1/2 --out " + shards + " 2>&1 1>/dev/null");
  EXPECT_EQ(foreign.code, 3);
  EXPECT_NE(foreign.out.find("is another shard: 2/2 (move it away to begin anew)"),
            std::string::npos)
      << foreign.out;
  std::filesystem::remove(shards + "/shard-1-of-2.shard");
  ASSERT_EQ(run(asked + " --shard 1/2 --out " + shards).code, 0);
  const Answer progress = run("--json --progress " + shards);
  EXPECT_EQ(progress.code, 0);
  EXPECT_EQ(Json::parse(progress.out).at("shards").at(0).at("takes"), 4);
  const std::string files = shards + "/shard-1-of-2.shard " + shards + "/shard-2-of-2.shard";
  const Answer merged = run("--merge " + files + " --out " + (folder / "merged").string());
  ASSERT_EQ(merged.code, 0);
  EXPECT_EQ(merged.out, one.out);
  for (const char* file : {"benchmark.csv", "report.html"})
    EXPECT_EQ(text_of(folder / "merged" / file), text_of(folder / "one" / file)) << file;
  std::filesystem::remove_all(folder);
}

TEST(Study, RefusesWrongUse) {
  EXPECT_EQ(run("--shard 1/2 --out x").code, 2);
  EXPECT_EQ(run("--only benchmark --shard 1/2").code, 2);
  EXPECT_EQ(run("--only benchmark --shard 3/2 --out x").code, 2);
  EXPECT_EQ(run("--merge /nowhere/a.shard").code, 3);

  EXPECT_EQ(run("--only 7.1").code, 2);
  EXPECT_EQ(run("--threads many").code, 2);
  EXPECT_EQ(run("--quick --only 6.2 --out /proc/nowhere").code, 3);
  EXPECT_EQ(run("--help").code, 0);
}

}  // namespace
