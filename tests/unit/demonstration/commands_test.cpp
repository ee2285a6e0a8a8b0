// `prehend demonstration` as a user calls it: exit codes, JSON alone on standard output, one clear
// line for what cannot be done.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/base/file_text.hpp"
#include "tests/support/command_test.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/support/takes/made_takes.hpp"

namespace prehend::demonstration {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

using test::Answer;

class DemonstrationCommand : public test::CommandTest {
 protected:
  DemonstrationCommand() : CommandTest(test::in_programs("prehend demonstration")) {}

  /// A folder with one file of takes.
  std::string takes(const std::string& name, const std::string& csv) const {
    std::filesystem::create_directories(folder / name);
    EXPECT_TRUE(write_file(folder / name / "task1.csv", csv));
    return in(name);
  }
};

TEST_F(DemonstrationCommand, DrawsPeopleWhoAreTheSameForASeed) {
  const Answer answer = run("draw " + in("a") + " --people 2 --takes 1 --seed 7 --json");
  ASSERT_EQ(answer.code, 0) << answer.complaint;
  const Json document = Json::parse(answer.output);
  EXPECT_EQ(document["people"], 2);
  EXPECT_EQ(document["kinds"], 10);
  EXPECT_EQ(document["takes"], 20);
  const auto text = read_file(document["file"].get<std::string>());
  ASSERT_TRUE(text);
  ASSERT_EQ(run("draw " + in("b") + " --people 2 --takes 1 --seed 7").code, 0);
  EXPECT_EQ(read_file(folder / "b/task_kinds.csv").value(), *text);
  ASSERT_EQ(run("draw " + in("c") + " --people 2 --takes 1 --seed 8").code, 0);
  EXPECT_NE(read_file(folder / "c/task_kinds.csv").value(), *text);
  EXPECT_EQ(run("draw " + in("d") + " --people 0").code, 2);
}

// People who were drawn are learnt from, and others judged: the object makes fewer errors, and the
// model that is written says the same of them.
TEST_F(DemonstrationCommand, LearnsFromDrawnPeopleAndJudgesOthers) {
  ASSERT_EQ(run("draw " + in("learnt") + " --people 6 --takes 4 --seed 7").code, 0);
  ASSERT_EQ(run("draw " + in("judged") + " --people 4 --takes 3 --seed 8").code, 0);
  const Answer trained = run("train " + in("learnt") + " --model " + in("m.model") + " --json");
  ASSERT_EQ(trained.code, 0) << trained.complaint;
  const Json learnt = Json::parse(trained.output)["tasks"]["kinds"];
  EXPECT_EQ(learnt["people"], 6);
  EXPECT_EQ(learnt["takes"], 240);
  EXPECT_EQ(learnt["classes"].size(), 10u);
  EXPECT_EQ(learnt["objects"], true);

  const Answer judged =
      run("evaluate " + in("judged") + " --train " + in("learnt") + " --with-object --json");
  ASSERT_EQ(judged.code, 0) << judged.complaint;
  const Answer by_model = run("evaluate " + in("judged") + " --model " + in("m.model") + " --json");
  ASSERT_EQ(by_model.code, 0) << by_model.complaint;
  const Json task = Json::parse(judged.output)["tasks"]["kinds"];
  EXPECT_EQ(task["count"], 120);
  for (const char* method : {"hybrid", "posture", "trajectory", "hmm"}) {
    const Json& own = task["methods"][method];
    EXPECT_EQ(own["accuracy"],
              Json::parse(by_model.output)["tasks"]["kinds"]["methods"][method]["accuracy"])
        << "the same people with the same seed";
    EXPECT_GT(own["accuracy"], 0.2) << method << ": chance is 0.1";
    EXPECT_GE(own["brier"], 0);
    EXPECT_LE(own["brier"], 2);
    const Json& told = own["with_object"];
    EXPECT_LE(told["errors"], 120);
    EXPECT_NEAR(told["accuracy"].get<double>(), 1 - told["errors"].get<double>() / 120, 1e-9);
  }
  const Json& hybrid = task["methods"]["hybrid"];
  EXPECT_LT(hybrid["with_object"]["errors"], hybrid["with_object"]["errors_without"]);
  int answers = 0;
  for (const Json& row : hybrid["confusion"])
    for (const Json& count : row) answers += count.get<int>();
  EXPECT_EQ(answers, 120);
}

// Folds by person, and no column of an object.
TEST_F(DemonstrationCommand, JudgesEachPersonByAllOthers) {
  const std::string real =
      takes("real", test::to_csv(test::made_takes({.people = 3, .trials = 3})));
  const Answer answer = run("evaluate " + real + " --json");
  ASSERT_EQ(answer.code, 0) << answer.complaint;
  const Json document = Json::parse(answer.output);
  EXPECT_EQ(document["tasks"]["1"]["methods"].size(), 4u);
  EXPECT_FALSE(document["tasks"]["1"]["methods"]["hybrid"].contains("with_object"));
  EXPECT_EQ(document["rows_left_out"], 0);
  const Answer told = run("evaluate " + real + " --with-object --json");
  EXPECT_THAT(told.complaint, HasSubstr("no object was measured"));
}

// Kinds that nobody taught were counted as errors without a word; one task that cannot be learnt
// cost the others; a great number of threads ended the program.
TEST_F(DemonstrationCommand, StrangersMayBringOtherKindsAndTasks) {
  auto known = test::made_takes({.people = 3, .trials = 2});
  auto strange = test::made_takes({.people = 2, .trials = 2, .seed = 5});
  const std::string kind = strange.front().label;
  for (Take& take : strange) {
    take.user += " too";
    if (take.label == kind) take.label = "teapot";
  }
  const std::string learnt = takes("learnt", test::to_csv(known));
  const std::string judged = takes("judged", test::to_csv(strange));
  const Answer answer =
      run("evaluate " + judged + " --train " + learnt + " --json --threads 99999");
  ASSERT_EQ(answer.code, 0) << answer.complaint;
  EXPECT_EQ(Json::parse(answer.output)["tasks"]["1"]["not_learnt"], Json::array({"teapot"}));
  EXPECT_THAT(answer.complaint, HasSubstr("nobody else showed teapot"));

  for (Take& take : strange) take.task = "2";
  const std::string other = takes("other", test::to_csv(strange));
  const Answer apart = run("evaluate " + other + " --train " + learnt);
  EXPECT_EQ(apart.code, 3);
  EXPECT_THAT(apart.complaint, HasSubstr("task 2: nobody shows it in the folder to learn from"));

  for (Take& take : strange) take.user = "alone";
  EXPECT_TRUE(write_file(std::filesystem::path(learnt) / "task2.csv", test::to_csv(strange)));
  const Answer trained = run("train " + learnt + " --model " + in("m") + " --json");
  ASSERT_EQ(trained.code, 0) << trained.complaint;
  EXPECT_EQ(Json::parse(trained.output)["tasks"].size(), 1u);
  EXPECT_THAT(trained.complaint, HasSubstr("task 2: fewer than two people"));
}

TEST_F(DemonstrationCommand, SaysInOneLineWhatCannotBeDone) {
  const std::string empty = takes("empty", "");
  const std::string lonely = takes("lonely", test::to_csv(test::made_takes({.people = 1})));
  std::filesystem::create_directories(folder / "bare");
  EXPECT_TRUE(write_file(folder / "torn.model", "half a mod"));
  for (const auto& [arguments, what] :
       {std::pair("evaluate " + in("nowhere"), "nowhere"),
        std::pair("evaluate " + empty + " --json", "is empty"),
        std::pair("evaluate " + in("bare"), "has no file task*.csv (name the folder"),
        std::pair("train " + lonely + " --model " + in("m"), "fewer than two people"),
        std::pair("evaluate " + lonely + " --model " + in("torn.model"), "torn.model"),
        std::pair("evaluate " + lonely + " --train " + in("nowhere"), "nowhere")}) {
    const Answer answer = run(arguments);
    EXPECT_NE(answer.code, 0) << arguments;
    EXPECT_TRUE(answer.output.empty()) << arguments << ": " << answer.output;
    EXPECT_THAT(answer.complaint, HasSubstr(what)) << arguments;
    EXPECT_LE(std::count(answer.complaint.begin(), answer.complaint.end(), '\n'), 2)
        << answer.complaint;
  }
}

}  // namespace
}  // namespace prehend::demonstration
