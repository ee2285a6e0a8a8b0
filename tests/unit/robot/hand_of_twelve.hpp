#pragma once

#include <functional>
#include <string>

#include "common/base/random.hpp"
#include "common/model/hand_model.hpp"

/// What tests of drivers share: a hand of twelve DoFs at the end of a wire.
namespace prehend::robot {

inline const model::HandModel& hand() {
  static const auto loaded = model::HandModel::load(model::hand_directory("dlr"));
  return *loaded;
}

/// A share of the way from the open hand to the ends of the ranges.
inline Eigen::VectorXd posture(double share) {
  Eigen::VectorXd dof = hand().postures().at("open");
  for (Eigen::Index d = 0; d < dof.size(); ++d)
    dof[d] += share * (hand().dofs()[static_cast<std::size_t>(d)].upper - dof[d]);
  return dof;
}

/// Now and then something comes before an answer, a bit of it is another, or a byte is missing.
inline std::function<std::string(std::string)> garbage(std::uint64_t seed, char flipped) {
  return [random = Random(seed), flipped](std::string answer) mutable {
    if (!answer.empty() && random.uniform() < 0.05) answer.insert(0, "\xff\xff\xfd*");
    if (!answer.empty() && random.uniform() < 0.05) answer[random.index(answer.size())] ^= flipped;
    if (!answer.empty() && random.uniform() < 0.05) answer.erase(random.index(answer.size()), 1);
    return answer;
  };
}

}  // namespace prehend::robot
