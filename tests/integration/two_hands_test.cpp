// Two hands in one world, each led by its own glove: together they carry what is too wide for one.
// Who loses its glove stays where it is, alone, unless both hold something up; a stop stops both.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "common/base/file_text.hpp"
#include "common/convert/convert.hpp"
#include "tests/integration/rig.hpp"

namespace prehend::integration {
namespace {

using Eigen::Vector3d;
using json = nlohmann::json;

class TwoHands : public Rig {
 protected:
  /// A crate of 0.3 m that a person carries by 0.3 m.
  void SetUp() override {
    write_text("catalogue.toml",
               "[[object]]\nname = \"Crate\"\nshape = \"box\"\nsize = [0.3, 0.25, 0.25]\n"
               "mass = 0.6\nmaterial = \"wood\"\n[object.appearance]\ncolours = [[0.6, 0.4, 0.2]]\n"
               "pattern = \"plain\"\nseed = 1\n");
    write_text("scene.toml",
               "[demonstrator]\ntarget = \"Crate\"\ncarry_W = [0.3, 0.0, 0.0]\n"
               "X_OG = [0.084, 0.0, 0.0375, 1.0, 0.0, -1.0, 0.0]\n\n"
               "[[object]]\nname = \"Crate\"\nX_WO = [-0.1, 0.0, 0.125, 1.0, 0.0, 0.0, 0.0]\n");
    simulation_.emplace(start("simulation", sets({"simulation.hands=[\"left:barrett_left\", "
                                                  "\"right:barrett\"]"})));
    for (const std::string side : {"left", "right"}) {
      const std::string hand = side == "left" ? "barrett_left" : "barrett";
      mappings_.emplace(side,
                        start("mapping", sets({"mapping.hand=" + hand, "mapping.hand_name=" + side,
                                               "mapping.glove=" + side + "_glove"})));
    }
  }
  void start_glove(const std::string& side) { start_glove(side, side); }
  /// worn: on which hand the one of that side is.
  void start_glove(const std::string& side, const std::string& worn) {
    gloves_.emplace(side, start("glove", sets({"glove.device=synthetic", "glove.hand=" + worn,
                                               "glove.name=" + side + "_glove"})));
  }
  /// Until every hand has been heard anew so often.
  bool hear_states(int count) {
    for (auto& [name, heard] : heard_) heard = 0;
    return eventually(20, [&] {
      poll();
      return heard_["left"] >= count && heard_["right"] >= count;
    });
  }
  void poll() {
    for (auto& sample : states_.take()) {
      const std::string hand = sample.data.hand().to_string();
      bases_[hand] = convert::from_message(sample.data.X_WB().position());
      models_[hand] = sample.data.model().to_string();
      ++heard_[hand];
    }
    for (auto& sample : objects_.take())
      if (const auto X_WO = convert::from_message(sample.data.X_WO())) X_WO_ = *X_WO;
  }
  /// Of a hand's base while both are heard so often, m.
  std::map<std::string, double> moved(int count) {
    EXPECT_TRUE(hear_states(3));
    const auto before = bases_;
    EXPECT_TRUE(hear_states(count));
    std::map<std::string, double> by;
    for (const auto& [name, p] : bases_) by[name] = (p - before.at(name)).norm();
    return by;
  }
  static bool names_both(const v1::GraspReport& report) {
    const std::string other = report.hand() == "left" ? "right/" : "left/";
    const auto is_other = [&](const v1::Contact& contact) {
      return contact.link().to_string().starts_with(other);
    };
    const auto others = std::ranges::count_if(report.contacts(), is_other);
    return others > 0 && others < std::ssize(report.contacts());
  }
  Answer order(Strings words) { return run("prehend", with_lab(std::move(words)), 30); }

  std::map<std::string, Vector3d> bases_;
  std::map<std::string, std::string> models_;
  Pose X_WO_ = Pose::Identity();  // of the crate
  dds::Reader<v1::GraspReport> reports_ = reader(dds::grasp_report);

  Strings sets(Strings own) const {
    own.push_back("lab.catalogue=" + (folder_ / "catalogue.toml").string());
    own.push_back("lab.scene=" + (folder_ / "scene.toml").string());
    return own;
  }

 private:
  void write_text(const std::string& name, const std::string& text) {
    ASSERT_TRUE(write_file(folder_ / name, text));
  }

  dds::Reader<v1::HandState> states_ = reader(dds::robot_state);
  dds::Reader<v1::ObjectState> objects_ = reader(dds::object_state);
  std::map<std::string, int> heard_;
  std::optional<stage::Process> simulation_;
  std::map<std::string, stage::Process> mappings_;

 protected:
  std::map<std::string, stage::Process> gloves_;
};

// Who did not start them tells what they do as well.
TEST_F(TwoHands, CarryWhatIsTooWideForOne) {
  Strings look{"demo", "--hands", "left:barrett,right:barrett", "--attach", "--json"};
  for (const std::string& set : sets({})) look.insert(look.end(), {"--set", set});
  auto attached = start_program("prehend", with_lab(look));
  start_glove("left");
  start_glove("right");
  const auto crate = [&](const auto& holds) {
    return eventually(60, [&] {
      poll();
      return holds(X_WO_.translation());
    });
  };
  ASSERT_TRUE(crate([](const Vector3d& p) { return p.z() > 0.125 + 0.10; })) << "is not lifted";
  double tilt = 0;
  EXPECT_TRUE(crate([&](const Vector3d& p) {
    tilt = std::max(tilt, std::acos(std::clamp(X_WO_.linear()(2, 2), -1.0, 1.0)));
    return p.x() > 0.2 - 0.03 && p.z() < 0.125 + 0.005;
  })) << "is not set down aside, but at "
      << X_WO_.translation().transpose();
  EXPECT_LT(tilt, 10 * M_PI / 180);
  EXPECT_EQ(models_["left"], "barrett_left");
  EXPECT_EQ(models_["right"], "barrett");
  const auto exit = attached.wait(seconds(30));
  ASSERT_TRUE(exit);
  EXPECT_EQ(exit->code, 0) << stage::last_lines(attached.log(), 5);

  // What both press together is judged of each, with the contacts of both.
  std::set<std::string> judged;
  EXPECT_TRUE(eventually(20,
                         [&] {
                           for (const auto& sample : reports_.take())
                             if (sample.data.held() && names_both(sample.data))
                               judged.insert(sample.data.hand().to_string());
                           return judged.size() == 2;
                         }))
      << judged.size() << " hands have a report that names the other";

  // What is for the other hand is no mistake, and of two mappings it is said whose each is.
  std::multiset<std::string> whose;
  const json document = json::parse(order({"status", "--once", "--json"}).output);
  for (const json& service : document["services"]) {
    if (service["name"] == "mapping") whose.insert(service["instance"].get<std::string>());
    EXPECT_FALSE(service["dropped"].contains("command for another hand")) << service;
  }
  EXPECT_EQ(whose, (std::multiset<std::string>{"left", "right"}));
}

TEST_F(TwoHands, WhoLooksMustKnowWhatIsCarried) {
  const Answer none = order({"demo", "--hands", "left:barrett,right:barrett", "--attach"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.log.find("lab.scene: tells nothing that two hands could carry"), std::string::npos)
      << none.log;
  Strings words{"demo", "--hands", "left:barrett,right:barrett", "--task", "hand-over", "--attach"};
  for (const std::string& set : sets({})) words.insert(words.end(), {"--set", set});
  const Answer other = order(words);
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_NE(other.log.find("scene.toml: shows another --task"), std::string::npos) << other.log;
  const Answer half = order({"scene", "--hands", "left:barrett,right:barrett"});
  EXPECT_EQ(half.exit_code, 2);
  EXPECT_NE(half.log.find("--hands requires --output"), std::string::npos) << half.log;
}

TEST_F(TwoHands, NeedAGloveThatSomebodyCarriesWith) {
  const Answer answer =
      order({"demo", "--hands", "left:barrett,right:barrett", "--glove", "topic"});
  EXPECT_EQ(answer.exit_code, 2);
  EXPECT_NE(answer.log.find("--glove topic: has nobody who carries an object"), std::string::npos)
      << answer.log;
}

// It would move its robot hand as in a mirror, and nothing else would tell.
TEST_F(TwoHands, TheDoctorNamesAGloveOfTheWrongSide) {
  const auto hands = [this] {
    const json document = json::parse(order({"doctor", "--json", "--listen", "1.5"}).output);
    for (const json& check : document["checks"])
      if (check["name"] == "hands") return check["detail"].get<std::string>();
    return std::string();
  };
  start_glove("right");
  start_glove("left", "right");
  ASSERT_TRUE(hear_states(3));
  EXPECT_TRUE(eventually(30, [&] {
    return hands() == "left_glove is on a right hand and leads left, a barrett_left";
  })) << hands();
  gloves_.at("left").stop(seconds(5));
  gloves_.erase("left");
  start_glove("left");
  EXPECT_TRUE(eventually(30, [&] {
    return hands() == "left_glove leads left, right_glove leads right";
  })) << hands();
}

TEST_F(TwoHands, WhoLosesItsGloveInTheMiddleMakesTheOtherWait) {
  start_glove("left");
  start_glove("right");
  ASSERT_TRUE(eventually(60, [&] {
    poll();
    return X_WO_.translation().z() > 0.125 + 0.08;
  })) << "is not lifted";
  gloves_.at("left").signal(SIGKILL);
  ASSERT_TRUE(eventually(10, [&] {
    const auto by = moved(20);
    return by.at("left") < 3e-3 && by.at("right") < 3e-3;
  })) << "both stay";
  const Vector3d held = X_WO_.translation();
  const auto by = moved(300);  // meanwhile the right hand is told to go on, by 0.3 m
  // Both push as hard as they may, so nothing holds the crate at a place along the line of the
  // push: 26 mm were seen.
  EXPECT_LT(by.at("left"), 0.05);
  EXPECT_LT(by.at("right"), 0.05);
  EXPECT_LT((X_WO_.translation() - held).norm(), 0.05) << "what they hold stays";
  EXPECT_NEAR(X_WO_.translation().z(), held.z(), 3e-3);
  EXPECT_GT(held.z(), 0.125 + 0.07);
}

TEST_F(TwoHands, EachFollowsItsOwnGloveAndAStopStopsBoth) {
  start_glove("right");
  ASSERT_TRUE(eventually(40, [&] {
    const auto by = moved(50);
    return by.at("right") > 0.02 && by.at("left") < 1e-3;
  })) << "the right hand alone follows";
  start_glove("left");
  ASSERT_TRUE(eventually(40, [&] {
    const auto by = moved(50);
    return by.at("right") > 0.02 && by.at("left") > 0.02;
  })) << "both follow";
  gloves_.at("right").signal(SIGKILL);
  ASSERT_TRUE(eventually(40, [&] {
    const auto by = moved(50);
    return by.at("right") < 1e-3 && by.at("left") > 0.02;
  })) << "the right one stays, the left one goes on";

  const Answer answer = order({"stop", "--reason", "a test", "--json"});
  EXPECT_EQ(answer.exit_code, 0) << answer.log;
  std::map<std::string, bool> stopped;
  const json told = json::parse(answer.output);
  for (const json& gate : told["gates"])
    stopped[gate["hand"].get<std::string>()] = gate["stopped"].get<bool>();
  EXPECT_EQ(stopped, (std::map<std::string, bool>{{"left", true}, {"right", true}}));
  const auto by = moved(100);
  EXPECT_LT(by.at("left"), 1e-3);
  EXPECT_LT(by.at("right"), 1e-3);
}

}  // namespace
}  // namespace prehend::integration
