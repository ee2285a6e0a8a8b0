#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <string_view>

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

/// Each byte of every answer is any.
inline std::function<std::string(std::string)> noise(std::uint64_t seed) {
  return [random = Random(seed)](std::string answer) mutable {
    for (char& c : answer) c = static_cast<char>(random.bits() & 0xff);
    return answer;
  };
}

inline std::string bytes_of_hex(std::string_view hex) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes += static_cast<char>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16));
  return bytes;
}

/// What the parser makes of the bytes, which are no more than a frame.
template <class Parser>
auto only_frame(Parser parser, const std::string& bytes) {
  parser.feed(bytes);
  auto frame = parser.next();
  EXPECT_FALSE(parser.next());
  return frame;
}

}  // namespace prehend::robot
