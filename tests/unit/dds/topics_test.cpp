// The table of topics in idl/README.md says what the code does, and the types keep their rules.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <prehend/dds/topics.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace prehend::dds {
namespace {

/// Cells of the table's rows by topic name.
std::map<std::string, std::vector<std::string>> documented() {
  std::ifstream file(PREHEND_SOURCE "/idl/README.md");
  std::map<std::string, std::vector<std::string>> rows;
  for (std::string line; std::getline(file, line);) {
    if (!rows.empty() && !line.starts_with("|")) break;  // the page's first table
    if (!line.starts_with("| `")) continue;
    std::vector<std::string> cells;
    std::istringstream stream(line.substr(1));
    for (std::string cell; std::getline(stream, cell, '|');) {
      cell.erase(0, cell.find_first_not_of(" `"));
      cell.erase(cell.find_last_not_of(" `") + 1);
      cells.push_back(cell);
    }
    rows[cells[0]] = cells;
  }
  return rows;
}

std::string depth(int n) {
  return n == 0 ? "all" : "last " + std::to_string(n);
}

TEST(Topics, TheDocumentedTableIsTheOneInCode) {
  const auto rows = documented();
  EXPECT_EQ(rows.size(), topic_table.size());
  for (const TopicQos& topic : topic_table) {
    const auto found = rows.find(std::string(topic.name));
    ASSERT_NE(found, rows.end()) << topic.name;
    const auto& cells = found->second;
    EXPECT_EQ(cells[3], std::string(topic.reliable ? "reliable" : "best effort") + ", " +
                            (topic.transient_local ? "transient local" : "volatile"))
        << topic.name;
    EXPECT_EQ(cells[4], depth(topic.writer_depth) + " / " + depth(topic.reader_depth))
        << topic.name;
    const auto says = [&](const std::string& what) {
      return cells[5].find(what) != std::string::npos;
    };
    EXPECT_EQ(says("exclusive"), topic.exclusive) << topic.name;
    EXPECT_EQ(says("deadline " + std::to_string(topic.deadline.count()) + " ms"),
              topic.deadline.count() > 0);
    EXPECT_EQ(says("lifespan " + std::to_string(topic.lifespan.count()) + " ms"),
              topic.lifespan.count() > 0);
  }
}

/// Names of roles, as they stand in the table.
Roles roles_in(const std::string& text) {
  Roles roles;
  std::istringstream stream(text);
  for (std::string name; std::getline(stream, name, ',');) {
    name.erase(0, name.find_first_not_of(' '));
    name.erase(name.find_last_not_of(' ') + 1);
    const Roles before = roles;
    if (name == "services") roles = roles | services;
    if (name == "anyone") roles = roles | anyone;
    for (const auto& [role, word] : role_names)
      if (word == name) roles = roles | role;
    EXPECT_NE(roles, before) << "no role: " << name;
  }
  return roles;
}

TEST(Topics, TheDocumentedWritersAndReadersAreThoseInCode) {
  const std::string arrow = "→";
  const auto rows = documented();
  for (const TopicQos& topic : topic_table) {
    const std::string cell = rows.at(std::string(topic.name)).at(7);
    const std::size_t at = cell.find(arrow);
    ASSERT_NE(at, std::string::npos) << topic.name;
    EXPECT_EQ(roles_in(cell.substr(0, at)), topic.from) << topic.name;
    EXPECT_EQ(roles_in(cell.substr(at + arrow.size())), topic.to) << topic.name;
  }
}

// What a stolen key must not be able to do.
TEST(Topics, NobodyButMappingAndReplayersMovesTheRobot) {
  for (const auto& [role, name] : role_names) {
    EXPECT_EQ(may_write(role, *find_topic("robot/command")),
              role == Role::mapping || role == Role::replayer)
        << name;
  }
  for (const TopicQos& topic : topic_table)
    EXPECT_FALSE(may_write(Role::viewer, topic)) << topic.name;
  EXPECT_FALSE(may_write(Role::mapping, *find_topic("glove/frame")));
}

TEST(Topics, EveryStructIsFinalAndEveryStringKeyIsBounded) {
  for (const char* family : {"Geometry", "Glove", "Perception", "Robot", "World", "Operation"}) {
    std::ifstream file(std::string(PREHEND_SOURCE "/idl/") + family + ".idl");
    ASSERT_TRUE(file) << family;
    for (std::string line; std::getline(file, line);) {
      const std::string code = line.substr(0, line.find("//"));
      if (code.find("struct ") != std::string::npos) {
        EXPECT_TRUE(code.starts_with("@final struct ")) << line;
      }
      if (code.find("@key string") != std::string::npos) {
        EXPECT_NE(code.find("string<"), std::string::npos) << line;
      }
    }
  }
}

}  // namespace
}  // namespace prehend::dds
