// Who writes and reads a topic is true: the calls publish(dds::X), subscribe(dds::X),
// writer(dds::X) and reader(dds::X) in the sources of each role are exactly its topics in
// topics.hpp.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/dds/topics.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::dds {
namespace {

namespace fs = std::filesystem;

/// Whose code lies where; the longest path counts.
const std::map<std::string, Roles> roles_of_path{
    {"services/glove", Role::glove},
    {"services/recognition", Role::recognition},
    {"services/mapping", Role::mapping},
    {"services/mapping/tools/teach", Role::operator_},
    {"services/planner", Role::planner},
    {"services/simulation", Role::simulation},
    {"services/demonstration", Role::demonstration},
    {"services/demonstration/tools/demonstrate", Role::operator_},
    {"services/demonstration/tools/person/hand_output.cpp", Role::glove},
    {"services/demonstration/tools/person/object_output.cpp", Role::recognition},
    {"services/performer/service", Role::performer},
    {"services/performer/tools", Role::viewer},
    {"services/performer/tools/tasks/order_command.cpp", Role::operator_},
    {"services/recorder", Role::recorder | Role::replayer},
    {"services/recorder/service/player_service.cpp", Role::replayer},
    {"services/recorder/service/recorder_service.cpp", Role::recorder},
    {"services/recorder/tools/record", Role::recorder},
    {"services/recorder/tools/replay", Role::replayer},
    {"services/recorder/tools/check", Role::replayer},
    {"services/console", Role::console},
    {"services/robot", Role::robot},
    {"services/robot/tools/twin", Role::mapping},  // twin.cpp and twin_command.cpp
    {"services/ros/tools/lead", Role::performer},
    {"services/cli", Role::viewer},
    {"services/cli/tools/orders", Role::operator_},
    {"common/robot", Role::simulation | Role::robot},  // the gate before a hand
    {"common/service", services},                      // the shell, which every service has
    {"common/stage/conductor.cpp", Role::replayer},
    {"common/service/consent_key.cpp", Role::operator_},
};

Roles roles_of(const std::string& file) {
  Roles roles;
  std::size_t longest = 0;
  for (const auto& [path, owners] : roles_of_path)
    if (file.starts_with(path) && path.size() > longest) {
      longest = path.size();
      roles = owners;
    }
  return roles;
}

/// A call that makes an end of a topic.
struct Call {
  std::string file;
  std::string verb;
  const TopicInfo* topic;
  bool writes() const { return verb == "publish" || verb == "writer"; }
  /// By the Shell, in the role of its process. Other readers in the services are those of tools
  /// that only look.
  bool in_role() const {
    return verb == "publish" || verb == "subscribe" || file.starts_with("common/service") ||
           file.starts_with("common/stage");
  }
};

/// dds::robot_command is robot/command.
const TopicInfo* topic_of(std::string variable) {
  if (const auto at = variable.find('_'); at != std::string::npos) variable[at] = '/';
  return find_topic(variable);
}

std::vector<Call> calls_in(const fs::path& path) {
  std::ifstream stream(path);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const std::string file = fs::relative(path, test::in_sources("")).string();
  static const std::regex call(R"(\b(publish|subscribe|writer|reader)\(\s*(prehend::)?dds::(\w+))");
  std::vector<Call> calls;
  for (std::sregex_iterator at(text.begin(), text.end(), call), end; at != end; ++at) {
    const TopicInfo* topic = topic_of((*at)[3]);
    EXPECT_TRUE(topic) << file << ": dds::" << (*at)[3] << " is not the name of a topic";
    if (topic) calls.push_back({file, (*at)[1], topic});
  }
  return calls;
}

const std::vector<Call>& all_calls() {
  static const std::vector<Call> calls = [] {
    std::vector<Call> found;
    for (const char* top : {"/services", "/common/robot", "/common/service", "/common/stage"})
      for (const auto& entry : fs::recursive_directory_iterator(test::in_sources("") + top))
        if (entry.path().extension() == ".cpp")
          std::ranges::copy(calls_in(entry.path()), std::back_inserter(found));
    return found;
  }();
  return calls;
}

using Names = std::set<std::string_view>;

Names in_code(Role role, bool writes) {
  Names names;
  for (const Call& call : all_calls())
    if (call.in_role() && call.writes() == writes && roles_of(call.file).has(role))
      names.insert(call.topic->name);
  return names;
}

Names in_list(Role role, bool writes) {
  Names names;
  for (const TopicInfo& topic : topic_table)
    if ((writes ? topic.writers : topic.readers).has(role)) names.insert(topic.name);
  return names;
}

TEST(Roles, AreTheCallsOfEachService) {
  for (const Role role :
       {Role::glove, Role::recognition, Role::mapping, Role::simulation, Role::demonstration,
        Role::performer, Role::planner, Role::recorder, Role::replayer, Role::console}) {
    EXPECT_EQ(in_code(role, true), in_list(role, true)) << name_of(role) << " writes";
    EXPECT_EQ(in_code(role, false), in_list(role, false)) << name_of(role) << " reads";
  }
}

// Not all programs of an operator are ours, as those of a robot are not.
TEST(Roles, OfAnOperatorAllowWhatTeachDoes) {
  EXPECT_THAT(in_list(Role::operator_, true),
              ::testing::IsSupersetOf(in_code(Role::operator_, true)));
  EXPECT_THAT(in_list(Role::operator_, false),
              ::testing::IsSupersetOf(in_code(Role::operator_, false)));
  EXPECT_TRUE(in_code(Role::operator_, true).contains("operator/command"));
}

// Ends that are made without a shell, in the services, belong to tools that join as a viewer. The
// twins of robots, real or emulated, command a hand of their own, in labs without keys alone.
TEST(Roles, OfToolsThatLookWriteNothing) {
  int looks = 0;
  for (const Call& call : all_calls()) {
    EXPECT_NE(roles_of(call.file), Roles()) << call.file << " belongs to no role";
    if (call.file.starts_with("services/robot/tools/twin")) continue;
    if (call.in_role() && roles_of(call.file) != Roles(Role::viewer)) continue;
    EXPECT_FALSE(call.writes()) << call.file << " writes " << call.topic->name;
    ++looks;
  }
  EXPECT_GT(looks, 0);
}

}  // namespace
}  // namespace prehend::dds
