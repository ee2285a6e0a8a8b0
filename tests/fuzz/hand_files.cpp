#include "tests/fuzz/hand_files.hpp"

#include <algorithm>
#include <filesystem>

#include "common/base/random.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::fuzz {

std::vector<HandFiles> all_hands() {
  std::vector<std::filesystem::path> folders;
  for (const auto& entry :
       std::filesystem::directory_iterator(test::in_sources("common/models/hands")))
    if (entry.is_directory()) folders.push_back(entry.path());
  std::sort(folders.begin(), folders.end());
  std::vector<HandFiles> hands;
  for (const auto& folder : folders)
    hands.push_back({read_file(folder / "hand.urdf"), read_file(folder / "hand.toml")});
  return hands;
}

void require_sound(const model::HandModel& hand) {
  require(!hand.fingertips().empty() && !hand.dofs().empty(), "a hand without fingers");
  require(hand.postures().contains("open"), "a hand without the open posture");
  require(is_finite(hand.X_BG()), "grasp frame is not finite");
  Random random(1);
  for (int trial = 0; trial < 3; ++trial) {
    Eigen::VectorXd dof(static_cast<Eigen::Index>(hand.dofs().size()));
    for (double& value : dof) value = random.uniform(-10, 10);
    dof = hand.clamp(dof);
    for (const Eigen::Vector3d& tip : hand.fingertip_positions(dof))
      require(tip.allFinite(), "a fingertip is not finite");
  }
  for (const model::HandLink& link : hand.links()) {
    require(link.mass > 0 && link.inertia_L.allFinite() && link.com_L.allFinite(),
            "inertia is not finite");
    for (const model::CollisionShape& part : link.collision)
      require(is_valid(part.shape) && is_finite(part.X_LS), "a shape is not valid");
  }
}

}  // namespace prehend::fuzz
