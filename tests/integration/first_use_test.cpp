// A hand that a stranger brings leads to a grasp without another command: from its URDF by `prehend
// hand add` or from a folder as it is, it is trained on first use, and then demonstrated.
#include <set>

#include "common/base/file_text.hpp"
#include "tests/integration/demo_rig.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::integration {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::set<std::string> files_in(const fs::path& folder) {
  std::set<std::string> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.insert(entry.path().filename());
  return files;
}

class FirstUse : public Demo {
 protected:
  FirstUse() { ::setenv("XDG_STATE_HOME", (folder_ / "state").c_str(), 1); }
  ~FirstUse() override { ::unsetenv("XDG_STATE_HOME"); }

  /// A hand of ours as if it were somebody else's.
  fs::path copied(const std::string& hand, const std::string& name) const {
    fs::copy(test::in_sources("common/models/hands/" + hand), folder_ / name);
    std::string toml = read_file(folder_ / name / "hand.toml").value();
    toml.replace(toml.find('"' + hand + '"'), hand.size() + 2, '"' + name + '"');
    EXPECT_TRUE(write_file(folder_ / name / "hand.toml", toml));
    return folder_ / name;
  }

  /// Demonstrated with a hand that may have to be trained before: a grasp is closed and judged.
  json judged(const fs::path& hand) {
    const Answer answer = run("prehend",
                              {"demo", "--json", "--domain", std::to_string(domain_), "--seed", "1",
                               "--hand", hand.string()},
                              300);
    EXPECT_TRUE(answer.exit_code == 0 || answer.exit_code == 1) << answer.output << answer.log;
    const json document = json::parse(answer.output, nullptr, false);
    if (document.is_discarded()) return {};
    EXPECT_EQ(document["mapping"]["hand"], hand.filename().string());
    EXPECT_EQ(document["mapping"]["mode"], "intelligent") << answer.log;
    EXPECT_GE(document["grasp"]["contacts"].get<int>(), 2) << answer.log;
    return document;
  }
};

TEST_F(FirstUse, AFolderIsTrainedAndHolds) {
  const fs::path hand = copied("barrett", "somebodys");
  EXPECT_EQ(judged(hand)["grasp"]["held"], true);
  EXPECT_TRUE(fs::exists(hand / "hand.mapping"));
  EXPECT_TRUE(fs::exists(folder_ / "state" / "prehend" / "grasps" / "somebodys"))
      << "grasps were planned, too";
}

TEST_F(FirstUse, AUrdfBecomesAHandThatGrasps) {
  const fs::path urdf = folder_ / "stranger.urdf", hand = folder_ / "stranger";
  fs::copy_file(test::in_sources("common/models/hands/barrett/hand.urdf"), urdf);
  const Answer added = run("prehend",
                           {"hand", "add", urdf.string(), "--name", "stranger", "--output",
                            hand.string(), "--candidates", "2"},
                           200);
  ASSERT_EQ(added.exit_code, 0) << added.output << added.log;
  judged(hand);
}

// The service alone trains its hand, too; several may begin at once.
TEST_F(FirstUse, SeveralMayTrainAtOnce) {
  const fs::path hand = copied("parallel_jaw", "pincers");
  std::set<std::string> before = files_in(hand);
  stage::Process mapping = start("mapping", {"mapping.hand=" + hand.string()});
  stage::Process other = start_program("prehend-train", {"--hand", hand.string(), "--if-needed"});
  EXPECT_TRUE(eventually(120, [&] { return other.exit().has_value(); }));
  ASSERT_TRUE(other.exit());
  EXPECT_EQ(other.exit()->code, 0);
  EXPECT_TRUE(eventually(120, [&] {
    return read_file(folder_ / "prehend-mapping.log").value_or("").find("pincers, derived") !=
           std::string::npos;
  }));
  EXPECT_FALSE(mapping.exit());
  // Whole, and nothing is left beside it.
  before.insert({"hand.grasps", "hand.mapping"});
  EXPECT_EQ(files_in(hand), before);
  const Answer again = run("prehend-train", {"--hand", hand.string(), "--if-needed"}, 60);
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_EQ(again.log, "");
}

}  // namespace
}  // namespace prehend::integration
