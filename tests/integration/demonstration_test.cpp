// Demonstrations over real DDS: a person who does not exist shows a task to real processes, which
// learn it, keep it and do it again with a simulated hand; and what is wrong is said in one line,
// before anything moves.
#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/base/file_text.hpp"
#include "common/base/paths.hpp"
#include "common/convert/convert.hpp"
#include "common/dds/topics.hpp"
#include "common/model/catalogue.hpp"
#include "common/model/placement.hpp"
#include "common/tasks/files/task_file.hpp"
#include "common/tasks/table.hpp"
#include "tests/integration/rig.hpp"
#include "tests/integration/shown_hand.hpp"

namespace prehend::integration {
namespace {

using nlohmann::json;

constexpr const char* glove_name = "glove";

class DemonstrationLab : public Rig {
 protected:
  std::string tasks() const { return (folder_ / "tasks").string(); }
  Strings sets() const { return {"demonstration.tasks=" + tasks(), "glove.device=topic"}; }

  /// Until the service says of itself that it works.
  void wait_for(const std::string& name) {
    ASSERT_TRUE(hear<v1::ServiceStatus>(statuses_, 30, [&](const v1::ServiceStatus& status) {
      return status.name().to_string() == name && status.state() == v1::STATE_RUNNING;
    })) << name;
  }

  Answer demonstrate(Strings arguments) {
    arguments.insert(arguments.begin(), "demonstrate");
    return run("prehend", with_lab(arguments), 40);
  }

  Answer tasks_run(const std::string& task) {
    Strings arguments = with_lab({"tasks", "run", task, "--json"});
    arguments.insert(arguments.end(), {"--set", "demonstration.tasks=" + tasks()});
    return run("prehend", arguments, 40);
  }

  /// Shows the planner this object, as a camera does, until it has searched all.
  void plan_for(const model::CatalogueObject& object) {
    // What other runs have found is not known here.
    ::setenv("XDG_STATE_HOME", (folder_ / "state").c_str(), 1);
    planner_.emplace(start("planner"));
    v1::ObjectDetection seen;
    seen.track(1);
    seen.name(object.name);
    seen.shape(convert::to_message(object.shape.kind));
    seen.size(convert::to_message(object.shape.size));
    seen.X_WO(convert::to_message(make_pose({0, 0, model::half_extents(object.shape).z()})));
    seen.probability(0.9);
    auto detections = writer(dds::object_detection);
    auto candidates = reader(dds::grasp_candidates);
    // A search lets all others go first.
    EXPECT_TRUE(eventually(240, [&] {
      seen.stamp_ns(now_ns());
      detections.write(seen);
      for (const auto& sample : candidates.take())
        if (!sample.info.gone && sample.data.complete()) return !sample.data.candidates().empty();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      return false;
    }));
    detections_.emplace(std::move(detections));  // what is seen stays
  }

  dds::Reader<v1::ServiceStatus> statuses_ = reader(dds::service_status);
  std::optional<stage::Process> planner_;
  std::optional<dds::Writer<v1::ObjectDetection>> detections_;
};

TEST_F(DemonstrationLab, AShownTaskIsUnderstoodToldAndKept) {
  auto segments = reader(dds::demonstration_segment);
  auto grasps = reader(dds::demonstration_grasp);
  auto models = reader(dds::task_model);
  Strings lab = sets();
  lab.push_back("lab.scene=" + scene(3));
  auto glove = start("glove", lab);
  auto service = start("demonstration", lab);
  wait_for("demonstration");
  ASSERT_EQ(demonstrate({"--name", "TEA", "--begin"}).exit_code, 0);
  // The object that the scene of this seed is about.
  const std::string text = read_file(folder_ / "scene-3.toml").value();
  const std::size_t at = text.find("target = \"") + 10;
  const std::string target = text.substr(at, text.find('"', at) - at);
  const Answer person = run(
      "prehend-person",
      [&] {
        Strings arguments = with_lab({"--put", target + "=0.24,0.20"});
        arguments.insert(arguments.end(), {"--set", lab.back()});
        return arguments;
      }(),
      60);
  ASSERT_EQ(person.exit_code, 0) << person.log;
  const Answer end = demonstrate({"--end", "--json"});
  ASSERT_EQ(end.exit_code, 0) << end.output << end.log;
  EXPECT_EQ(json::parse(end.output)["done"], true);

  const auto task = hear<v1::TaskModel>(models, 10, [](auto&) { return true; });
  ASSERT_TRUE(task);
  EXPECT_EQ(task->task().to_string(), "TEA");
  ASSERT_EQ(task->steps().size(), 1u);
  EXPECT_EQ(task->steps()[0].object().to_string(), target);
  std::vector<v1::HandPhase> phases;
  for (const auto& sample : segments.take()) phases.push_back(sample.data.phase());
  EXPECT_EQ(phases,
            (std::vector{v1::PHASE_REST, v1::PHASE_APPROACH, v1::PHASE_CLOSE, v1::PHASE_HOLD,
                         v1::PHASE_RELEASE, v1::PHASE_RETRACT, v1::PHASE_REST}));
  EXPECT_TRUE(hear<v1::DemonstratedGrasp>(grasps, 20, [](auto&) { return true; }));
  const auto kept = tasks::load_record(std::filesystem::path(tasks()) / "TEA.task");
  ASSERT_TRUE(kept) << kept.error().message();
  EXPECT_EQ(kept->shown.size(), 1u);
}

TEST_F(DemonstrationLab, WhatIsWrongIsSaidInOneLineAndNothingIsLost) {
  auto service = start("demonstration", sets());
  wait_for("demonstration");
  const auto said = [&](const Strings& arguments) {
    const Answer answer = demonstrate(arguments);
    EXPECT_EQ(answer.exit_code, 1) << answer.log;
    EXPECT_EQ(std::count(answer.log.begin(), answer.log.end(), '\n'), 1) << answer.log;
    return answer.log;
  };
  EXPECT_NE(said({"--end"}).find("no demonstration has begun"), std::string::npos);
  EXPECT_NE(said({"--name", "../TEA", "--begin"}).find("cannot be the name of a task"),
            std::string::npos);
  ASSERT_EQ(demonstrate({"--name", "TEA", "--begin"}).exit_code, 0);
  EXPECT_NE(said({"--name", "COFFEE", "--begin"}).find("TEA: is being shown already"),
            std::string::npos);
  EXPECT_NE(
      said({"--name", "COFFEE", "--end"}).find("COFFEE: is not being shown; what is shown is TEA"),
      std::string::npos);
  EXPECT_NE(said({"--end"}).find("no hand was seen"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::path(tasks()) / "TEA.task"));
}

TEST_F(DemonstrationLab, WhatCannotBeMeantIsSaidAtOnce) {
  const auto expect = [](int code, const std::string& words, const Answer& answer) {
    EXPECT_EQ(answer.exit_code, code) << answer.log;
    EXPECT_NE(answer.log.find(words), std::string::npos) << answer.log;
  };
  expect(2, "--name: needs a name", demonstrate({"--begin"}));
  expect(2, "demonstration.objects: there is no «smelt» (choose seen or simulated)",
         run("prehend-demonstration", lab_arguments({"demonstration.objects=smelt"}), 20));
  const std::string home = std::getenv("HOME") ? std::getenv("HOME") : "/";
  for (const char* name : {"HOME", "XDG_STATE_HOME", "STATE_DIRECTORY"}) ::unsetenv(name);
  expect(3, "demonstration.tasks: there is no folder for tasks (name one)",
         run("prehend-demonstration", lab_arguments(), 20));
  ::setenv("HOME", home.c_str(), 1);
  const std::string table = "lab.scene=" + scene(3);
  for (const auto& [put, words] : {std::pair("Talc", "Talc: is no OBJECT=x,y or OBJECT=x,y,z"),
                                   std::pair("Talc=here", "Talc=here: is no OBJECT=x,y"),
                                   std::pair("Teapot=0,0", "Teapot: is not in the catalogue")})
    expect(2, words, run("prehend-person", with_lab({"--put", put, "--set", table}), 20));
}

// Pressed once it begins, pressed again it ends; another button does nothing.
TEST_F(DemonstrationLab, TheTrackersButtonBeginsAndEnds) {
  auto service = start("demonstration", sets());
  wait_for("demonstration");
  auto replies = reader(dds::operator_reply);
  auto buttons = writer(dds::glove_button);
  auto shown =
      start_program("prehend", with_lab({"demonstrate", "--name", "TEA", "--button", "2"}));
  meet(buttons);
  const auto say = [&](const std::vector<std::uint8_t>& held) {
    v1::GloveButton message;
    message.glove(glove_name);
    message.stamp_ns(now_ns());
    message.held(held);
    buttons.write(message);
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
  };
  for (int i = 0; i < 5; ++i) {
    say({});
    say({1});
  }
  EXPECT_TRUE(replies.take().empty()) << "that is another button";
  ASSERT_TRUE(eventually(30, [&] {
    say({1});
    say({1, 2});
    return shown.exit().has_value();
  }));
  EXPECT_EQ(shown.exit()->code, 1) << "no hand was there to show anything";
  std::vector<std::string> said;
  for (const auto& sample : replies.take())
    if (said.empty() || said.back() != sample.data.message().to_string())
      said.push_back(sample.data.message().to_string());
  ASSERT_EQ(said.size(), 2u);
  EXPECT_EQ(said[0], "watching TEA");
  EXPECT_NE(said[1].find("no hand was seen"), std::string::npos) << said[1];
}

// Two gloves of one name: the lab goes on with the first, and says so in one line.
TEST_F(DemonstrationLab, ASecondHandIsNotFollowedAndTheLabSaysSo) {
  auto service = start("demonstration", sets());
  wait_for("demonstration");
  auto hand = writer(dds::hand_posture);
  meet(hand);
  auto other_lab = dds::Participant::create(
      {.name = "other", .domain = domain_, .rig = name_, .network = network_});
  ASSERT_TRUE(other_lab);
  auto other = other_lab->writer(dds::hand_posture);
  ASSERT_TRUE(other);
  meet(*other);
  std::uint64_t frame = 0;
  std::string line;
  EXPECT_TRUE(eventually(30, [&] {
    hand.write(shown_hand({}, ++frame));
    other->write(shown_hand({}, frame));
    for (const auto& sample : statuses_.take())
      if (!sample.info.gone && sample.data.state() == v1::STATE_DEGRADED)
        line = sample.data.message().to_string();
    return !line.empty();
  }));
  EXPECT_EQ(line, "a second hand is shown; the first one is followed");
  EXPECT_FALSE(service.exit());
}

TEST_F(DemonstrationLab, ATaskThatCannotBeDoneMovesNothing) {
  auto commands = reader(dds::robot_command);
  std::filesystem::create_directories(tasks());
  tasks::TaskModel task{"TEA", 1, {{.object = "Teapot"}}};
  ASSERT_TRUE(tasks::save_task(tasks() + "/TEA.task", task));
  auto simulation = start("simulation", {"lab.scene=" + scene(1)});
  wait_for("simulation");
  const Answer strange = tasks_run("TEA");
  EXPECT_EQ(strange.exit_code, 1);
  EXPECT_NE(strange.log.find("Teapot: is not in this lab"), std::string::npos) << strange.log;
  ASSERT_TRUE(write_file(tasks() + "/BAD.task", "no task"));
  const Answer damaged = tasks_run("BAD");
  EXPECT_NE(damaged.exit_code, 0);
  EXPECT_NE(damaged.log.find("BAD.task"), std::string::npos) << damaged.log;
  EXPECT_TRUE(commands.take().empty());
}

// The performer as a service: an operator orders by name, and hears on task/progress how it goes.
// It takes the object as prehend-planner says.
TEST_F(DemonstrationLab, APerformerDoesWhatIsOrderedAndEndsIt) {
  const auto catalogue =
      model::Catalogue::load(share_directory() / "models/objects/catalogue.toml").value();
  const double height = model::half_extents(catalogue.find("Talc")->shape).z();
  const auto table =
      tasks::drawn_table(catalogue, 3, {.objects = {"Talc"}, .free = {Eigen::Vector2d(0.2, -0.1)}});
  ASSERT_TRUE(table);
  const std::string file = (folder_ / "table.toml").string();
  ASSERT_TRUE(write_file(file, model::to_toml(*table)));
  tasks::TaskModel task{"TEA", 1, {{.object = "Talc", .via_height = 0.1}}};
  task.steps[0].X_OG = make_pose(
      {0, 0, 0.01}, model::grasp_axes(Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitX()));
  task.steps[0].X_RO = make_pose({0.2, -0.1, height});
  std::filesystem::create_directories(tasks());
  ASSERT_TRUE(tasks::save_task(tasks() + "/TEA.task", task));
  auto simulation = start("simulation", {"lab.scene=" + file});
  auto performer = start("performer", {"demonstration.tasks=" + tasks()});
  wait_for("simulation");
  wait_for("performer");
  plan_for(*catalogue.find("Talc"));
  auto progress = reader(dds::task_progress);
  const auto order = [&](Strings words) {
    words.insert(words.begin(), {"tasks", "order"});
    return run("prehend", with_lab(words), 30);
  };
  EXPECT_EQ(order({"COFFEE"}).exit_code, 1);
  EXPECT_EQ(order({tasks() + "/TEA.task"}).exit_code, 1) << "that is no name";
  const Answer begun = order({"TEA"});
  ASSERT_EQ(begun.exit_code, 0) << begun.output << begun.log;
  const Answer again = order({"TEA"});
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_NE(again.output.find("is being done"), std::string::npos) << again.output;
  const auto done = hear<v1::TaskProgress>(
      progress, 120, [](const auto& said) { return said.state() != v1::TASK_RUNNING; });
  ASSERT_TRUE(done);
  EXPECT_EQ(done->state(), v1::TASK_DONE) << done->reason().to_string();
  EXPECT_TRUE(hear<v1::ServiceStatus>(statuses_, 10, [](const v1::ServiceStatus& status) {
    return std::any_of(status.rates().begin(), status.rates().end(), [](const v1::Rate& rate) {
      return rate.name().to_string() == "planned grasps" && rate.total() == 1;
    });
  })) << "its status says by whose grasp";
  EXPECT_TRUE(eventually(10, [&] {
    const auto record = tasks::load_record(tasks() + "/TEA.task");
    return record && record->runs.size() == 1 && record->runs[0].done;
  })) << "success is kept with the task";

  ASSERT_TRUE(eventually(10, [&] { return order({"TEA"}).exit_code == 0; }));
  const Answer foreign = order({"COFFEE", "--end"});
  EXPECT_EQ(foreign.exit_code, 1);
  EXPECT_NE(foreign.output.find("COFFEE: is not being done; what is done is TEA"),
            std::string::npos)
      << foreign.output;
  ASSERT_EQ(order({"TEA", "--end"}).exit_code, 0);
  EXPECT_TRUE(eventually(60, [&] {
    return order({"TEA", "--end"}).exit_code == 1;
  })) << "it has ended";
}

TEST_F(DemonstrationLab, ShownOnceDoneAgainElsewhere) {
  const Answer answer =
      run("prehend",
          {"demo", "--task", "pick-and-place", "--json", "--domain", std::to_string(domain_)}, 120);
  ASSERT_EQ(answer.exit_code, 0) << answer.output << answer.log;
  const json document = json::parse(answer.output);
  EXPECT_EQ(document["task"]["done"], true);
  ASSERT_EQ(document["task"]["steps"].size(), 1u);
  EXPECT_LT(document["task"]["steps"][0]["error_m"].get<double>(), 0.02);
  EXPECT_LT(document["task"]["steps"][0]["error_rad"].get<double>(), 0.1745);
  EXPECT_EQ(document["object"]["name"], "Talc");
  EXPECT_LT(document["object"]["position_error_m"].get<double>(), 0.01);
  EXPECT_EQ(document["understood"]["phases"].size(), 7u);
}

// As on a busy machine: for a while the lab saw no hand, and refused what was shown.
TEST_F(DemonstrationLab, WhatTheLabRefusesIsShownAgain) {
  stage::Process demo = start_program(
      "prehend", {"demo", "--task", "pick-and-place", "--domain", std::to_string(domain_)});
  const auto said = [&] { return read_file(demo.log()).value_or(""); };
  ASSERT_TRUE(eventually(60, [&] { return said().find("approach") != std::string::npos; }))
      << said();
  const auto ours = processes_with("lab.rig=demo-" + std::to_string(demo.pid()) + "-");
  std::vector<pid_t> people = processes_with(program("prehend-person"));
  std::erase_if(people, [&](pid_t one) { return !std::count(ours.begin(), ours.end(), one); });
  ASSERT_EQ(people.size(), 1u);
  ::kill(people[0], SIGSTOP);
  std::this_thread::sleep_for(std::chrono::milliseconds(700));  // a hand may be away for 500
  ::kill(people[0], SIGCONT);
  const auto exit = demo.wait(seconds(120));
  ASSERT_TRUE(exit) << said();
  EXPECT_EQ(exit->code, 0) << said();
  EXPECT_NE(said().find("it is shown again, since: demonstrate: "), std::string::npos) << said();
}

// Nobody grasps the crate.
TEST_F(DemonstrationLab, WhatThePersonSaysEndsTheDemo) {
  const std::string objects = (folder_ / "objects.toml").string();
  ASSERT_TRUE(write_file(
      objects, read_file(share_directory() / "models/objects/catalogue.toml").value() +
                   "\n[[object]]\nname = \"Crate\"\nshape = \"box\"\nsize = [0.15, 0.15, 0.1]\n"
                   "mass = 0.5\nmaterial = \"wood\"\n"));
  const Answer answer = run("prehend",
                            {"demo", "--task", "pick-and-place", "--object", "Crate", "--set",
                             "lab.catalogue=" + objects, "--domain", std::to_string(domain_)},
                            120);
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_NE(answer.log.find("'Crate' is too large for the person's hand"), std::string::npos)
      << answer.log;
}

/// Three objects, each to a place of its own on the table.
tasks::TaskModel tidying() {
  tasks::TaskModel task{"TIDY", 1, {}};
  const auto put = [&](const char* object, double x, double y, double z) {
    task.steps.push_back(
        {.object = object,
         .X_OG = make_pose({0, 0, 0.01},
                           model::grasp_axes(Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitX())),
         .X_RO = make_pose({x, y, z}),
         .via_height = 0.1,
         .upright = true});
  };
  put("Talc", 0.24, -0.2, 0.0525);
  put("Cup", -0.24, -0.2, 0.05);
  put("Pringles", 0.0, -0.22, 0.12);
  return task;
}

TEST_F(DemonstrationLab, AnArmMovesThreeObjectsOfATaskFile) {
  if (!std::getenv("PREHEND_LONG"))
    GTEST_SKIP() << "PREHEND_LONG=1 moves three objects by an arm (a minute and a half)";
  const auto catalogue =
      model::Catalogue::load(share_directory() / "models/objects/catalogue.toml").value();
  tasks::TaskModel task = tidying();
  for (tasks::Step& step : task.steps)
    step.X_RO.translation().z() = model::half_extents(catalogue.find(step.object)->shape).z();
  const std::string file = (folder_ / "TIDY.task").string();
  ASSERT_TRUE(tasks::save_task(file, task));
  const Answer answer = run("prehend",
                            {"demo", "--arm", "puma560", "--task", file, "--json", "--timeout",
                             "280", "--domain", std::to_string(domain_)},
                            300);
  ASSERT_EQ(answer.exit_code, 0) << answer.output << answer.log;
  const json document = json::parse(answer.output);
  EXPECT_EQ(document["arm"]["name"], "puma560");
  EXPECT_LE(document["arm"]["worst_joint_speed"].get<double>(), 1.001);
  ASSERT_EQ(document["task"]["steps"].size(), 3u);
  for (const json& step : document["task"]["steps"]) {
    EXPECT_EQ(step["done"], true) << step;
    EXPECT_LT(step["error_m"].get<double>(), 0.02);
    EXPECT_LT(step["error_rad"].get<double>(), 0.1745);
  }
  const Answer strange = run("prehend", {"demo", "--arm", "claw", "--task", file, "--json"}, 30);
  EXPECT_EQ(strange.exit_code, 2);
  EXPECT_NE(strange.log.find("there is no such arm"), std::string::npos) << strange.log;
}

}  // namespace
}  // namespace prehend::integration
