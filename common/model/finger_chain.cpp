#include "common/model/finger_chain.hpp"

namespace prehend::model {

std::vector<int> joints_to(const HandModel& hand, int link) {
  std::vector<int> joints;
  while (hand.links()[static_cast<std::size_t>(link)].joint >= 0) {
    joints.insert(joints.begin(), hand.links()[static_cast<std::size_t>(link)].joint);
    link = hand.joints()[static_cast<std::size_t>(joints.front())].parent;
  }
  return joints;
}

}  // namespace prehend::model
