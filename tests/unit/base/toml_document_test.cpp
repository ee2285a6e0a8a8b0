// TOML has nan and inf; no document of ours does, whoever reads it.
#include "common/base/toml_document.hpp"

#include <gtest/gtest.h>

namespace prehend {
namespace {

TEST(TomlDocument, NumbersAreFiniteWhereverTheyStand) {
  for (const char* text :
       {"a = 1\nb = nan", "a = 1\nb = inf", "a = 1\nb = -inf", "a = 1\nb = +nan",
        "a = 1\nb = [1, [2.0, nan]]", "a = 1\n[t.u]\nv = -inf", "a = 1\n[[t]]\nu = {v = inf}"}) {
    const auto root = parse_toml(text, "lab.toml");
    ASSERT_FALSE(root) << text;
    EXPECT_NE(root.error().where.find("lab.toml: line "), std::string::npos) << root.error().where;
    EXPECT_NE(root.error().what.find("is not a finite number"), std::string::npos);
  }
  EXPECT_EQ(parse_toml("[t.u]\nv = [1, nan]", "").error().message(),
            "line 2: t.u.v is not a finite number (it is TOML)");
  EXPECT_FALSE(parse_toml("b = 1e309", "")) << "the library refuses it in words of its own";
  EXPECT_TRUE(parse_toml("a = -0.0\nb = \"nan\"\nc = 1e308", "lab.toml"));
}

TEST(TomlDocument, AFolderIsNoFile) {
  const auto root = load_toml("/tmp", "it is TOML");
  ASSERT_FALSE(root);
  EXPECT_NE(root.error().message().find("/tmp"), std::string::npos);
}

}  // namespace
}  // namespace prehend
