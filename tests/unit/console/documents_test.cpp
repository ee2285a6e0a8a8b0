// Names that stand in messages stay one string of a document, whatever they are.
#include "services/console/core/documents.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace prehend::console {
namespace {

TEST(Documents, NamesOfFramesStayWhatTheyAre) {
  for (const std::string name :
       {"table", "", "\"", "\"\"", "\\", "\\\\", "a\"b\\c", "\n", "\x1b[2J", "\x7f", "Löffel"}) {
    std::string list;
    add_transform(list, 1, name, name + name, Pose::Identity());
    const auto read = nlohmann::json::parse(list);
    EXPECT_EQ(read["parent_frame_id"], name);
    EXPECT_EQ(read["child_frame_id"], name + name);
  }
}

}  // namespace
}  // namespace prehend::console
