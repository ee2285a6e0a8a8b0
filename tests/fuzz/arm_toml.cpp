// A damaged arm.toml beside the URDF of each arm: refused with a reason, or a sound arm.
#include "tests/fuzz/arm_files.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"
#include "tests/support/arms/arms.hpp"

using namespace prehend;

int main(int argc, char** argv) {
  const auto arms = test::all_arms();
  const std::string more =
      "redundant = \"joint3\"\npayload = 3\n[shoulder]\nposition = [0, 0, 0.3]\n"
      "orientation = [1, 0, 0, 0]\n[collision]\nnot_checked = [[\"link1\", \"link4\"]]\n[limits]\n"
      "velocity = [1, 1, 1, 1, 1, 1, 1]\nlower = [-1, -1, -1, -3, -1, -0.1, -1]\n";
  fuzz::Fuzzer fuzzer;
  for (const test::ArmFiles& arm : arms) fuzzer.seeds.push_back(arm.toml);
  fuzzer.seeds.push_back("name = \"all\"\n" + more);
  fuzzer.mutate = [](Random& random, std::string text) {
    return fuzz::mutate_text(random, std::move(text), fuzz::mutate_lines);
  };
  fuzzer.target = [&](const std::string& toml) {
    bool accepted = false;
    for (const test::ArmFiles& files : arms) {
      const auto arm = model::ArmModel::parse(files.urdf, toml);
      fuzz::require(arm || !arm.error().what.empty(), "refused without a reason");
      if (arm) fuzz::require_sound(*arm);
      accepted |= arm.has_value();
    }
    return accepted;
  };
  return fuzz::run(fuzzer, argc, argv);
}
