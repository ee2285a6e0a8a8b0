// The list of topics (topics.hpp) against what has to agree with it: the types of the IDL, the
// table in idl/README.md row by row, and what a stolen key must not be able to do. roles_test.cpp
// compares it with the code of the services.
#include "common/dds/topics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "common/recording/types/idl.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::dds {
namespace {

const recording::types::Structure* structure_of(const TopicInfo& topic) {
  static const recording::types::Library library =
      recording::types::load_idl(test::in_sources("idl")).value();
  return library.find(topic.type_name());
}

/// Names of the key fields in the IDL.
std::vector<std::string> keys_of(const TopicInfo& topic) {
  std::vector<std::string> keys;
  if (const auto* structure = structure_of(topic))
    for (const auto& field : structure->fields)
      if (field.key) keys.push_back(field.name);
  return keys;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// As a cell of the table: all services in one word, else each role.
std::string cell_of(Roles roles, bool open = false) {
  std::vector<std::string> words;
  if (roles == services) {
    words.emplace_back("services");
  } else {
    for (const auto& [role, name] : role_names)
      if (roles.has(role)) words.emplace_back(name);
  }
  if (open) words.emplace_back("anyone");
  return joined(words);
}

std::string depth(int n) {
  return n == 0 ? "all" : "last " + std::to_string(n);
}

std::string remarks(const TopicInfo& topic) {
  std::vector<std::string> words;
  const auto ms = [](auto time) { return std::to_string(time.count()) + " ms"; };
  if (topic.qos.exclusive_ownership) words.emplace_back("exclusive ownership");
  if (topic.qos.deadline.count() > 0) words.push_back("deadline " + ms(topic.qos.deadline));
  if (topic.qos.lifespan.count() > 0) words.push_back("lifespan " + ms(topic.qos.lifespan));
  if (!topic.remark.empty()) words.emplace_back(topic.remark);
  return joined(words);
}

/// The row of the table in idl/README.md, as it should be.
std::string row_of(const TopicInfo& topic) {
  const std::string type = topic.type_name();
  std::string key = joined(keys_of(topic));
  if (key.empty()) key = "–";
  const std::string qos = std::string(topic.qos.reliable ? "reliable" : "best effort") + ", " +
                          (topic.qos.transient_local ? "transient local" : "volatile");
  std::string row = "|";
  for (const std::string& cell :
       {"`" + std::string(topic.name) + "`", type.substr(type.rfind(':') + 1), key, qos,
        depth(topic.qos.writer_depth) + " / " + depth(topic.qos.reader_depth), remarks(topic),
        std::string(topic.rate),
        cell_of(topic.writers) + " → " + cell_of(topic.readers, topic.open)})
    row += cell.empty() ? " |" : " " + cell + " |";
  return row;
}

/// Rows of the page that are about a topic: those that say from where to where it goes.
std::vector<std::string> documented_rows() {
  std::ifstream file(test::in_sources("idl/README.md"));
  std::vector<std::string> rows;
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("| `") && line.find(" → ") != std::string::npos) rows.push_back(line);
  return rows;
}

TEST(Topics, TheTableOfThePageIsTheListInCode) {
  const std::vector<std::string> rows = documented_rows();
  std::string table;
  for (const TopicInfo& topic : topic_table) table += row_of(topic) + "\n";
  for (const TopicInfo& topic : topic_table)
    EXPECT_EQ(std::ranges::count(rows, row_of(topic)), 1)
        << "idl/README.md has no such row; " << topic.name << " should be\n"
        << row_of(topic);
  for (const std::string& row : rows)
    EXPECT_TRUE(std::ranges::any_of(topic_table,
                                    [&](const TopicInfo& topic) { return row_of(topic) == row; }))
        << "idl/README.md has a row that is not in topics.hpp:\n"
        << row;
  EXPECT_TRUE(std::ranges::equal(rows, topic_table, {}, {}, row_of))
      << "the rows of idl/README.md in their order should be\n"
      << table;
}

TEST(Topics, EveryTypeIsInTheIdlWithItsKey) {
  std::set<std::string_view> names;
  for (const TopicInfo& topic : topic_table) {
    EXPECT_TRUE(names.insert(topic.name).second) << topic.name << " is there twice";
    EXPECT_TRUE(structure_of(topic)) << topic.name << ": " << topic.type_name();
    EXPECT_EQ(topic.keyed(), !keys_of(topic).empty()) << topic.name;
  }
}

// Ownership and the newest sample of each instance mean nothing without instances.
TEST(Topics, WhatHasNoKeyKeepsAll) {
  for (const TopicInfo& topic : topic_table) {
    if (topic.keyed()) continue;
    EXPECT_EQ(topic.qos.writer_depth, 0) << topic.name;
    EXPECT_FALSE(topic.qos.exclusive_ownership) << topic.name;
  }
}

// What a stolen key must not be able to do.
TEST(Topics, NobodyButMappingPerformersAndReplayersMovesTheRobot) {
  for (const auto& [role, name] : role_names)
    EXPECT_EQ(may_write(role, robot_command),
              role == Role::mapping || role == Role::performer || role == Role::replayer)
        << name;
  // Who watches a demonstration moves nothing.
  EXPECT_FALSE(may_write(Role::demonstration, robot_command));
  for (const TopicInfo& topic : topic_table)
    EXPECT_FALSE(may_write(Role::viewer, topic)) << topic.name;
  EXPECT_FALSE(may_write(Role::mapping, glove_frame));
}

// `check` feeds inputs and compares outputs: an output that nobody computes could not be compared.
TEST(Topics, EveryServiceTurnsInputsIntoOutputs) {
  for (const Role role :
       {Role::glove, Role::recognition, Role::mapping, Role::simulation, Role::demonstration}) {
    const auto any = [&](auto is) {
      return std::ranges::any_of(topic_table,
                                 [&](const TopicInfo& topic) { return is(role, topic); });
    };
    EXPECT_TRUE(any(is_input)) << name_of(role);
    EXPECT_TRUE(any(is_output)) << name_of(role);
  }
  EXPECT_TRUE(is_input(Role::mapping, operator_command));
  EXPECT_TRUE(is_input(Role::simulation, operator_command)) << "a stop moves the hand otherwise";
  EXPECT_FALSE(is_output(Role::mapping, operator_reply)) << "a reply depends on the wall clock";
  EXPECT_FALSE(is_output(Role::recognition, camera_image)) << "a picture is measured";
  for (const TopicInfo& topic : topic_table)
    if (topic.content == Content::lockstep || topic.content == Content::process)
      for (const auto& [role, name] : role_names) {
        EXPECT_FALSE(is_input(role, topic)) << name << " " << topic.name;
        EXPECT_FALSE(is_output(role, topic)) << name << " " << topic.name;
      }
}

TEST(Topics, EveryStructIsFinalAndEveryStringKeyIsBounded) {
  int structs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::in_sources("idl"))) {
    if (entry.path().extension() != ".idl") continue;
    std::ifstream file(entry.path());
    for (std::string line; std::getline(file, line);) {
      const std::string code = line.substr(0, line.find("//"));
      if (code.find("struct ") != std::string::npos) {
        ++structs;
        EXPECT_TRUE(code.starts_with("@final struct ")) << line;
      }
      if (code.find("@key string") != std::string::npos) {
        EXPECT_NE(code.find("string<"), std::string::npos) << line;
      }
    }
  }
  EXPECT_GE(structs, static_cast<int>(topic_table.size()));
}

}  // namespace
}  // namespace prehend::dds
