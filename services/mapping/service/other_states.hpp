#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/dds/topics.hpp"
#include "services/mapping/core/capsules.hpp"

namespace prehend::mapping {

/// The robot/state of other hands in the same world, as what must be kept off.
class OtherStates {
 public:
  /// names: of these hands in robot/state. kind: the hand that is led, a name or a folder; others
  /// may be the same hand, or its mirror image, wherever its folder is.
  OtherStates(std::vector<std::string> names, const std::string& kind);

  bool names(const std::string& hand) const;
  /// Where it is, in W. Fails on a hand that is not known here, and says so once, and on a state
  /// that is none of it.
  Expected<std::vector<Capsule>> place(const v1::HandState& state);

 private:
  struct Model {
    HandCapsules capsules;
    Eigen::Index dofs = 0;
  };
  const std::optional<Model>& model(const std::string& name);

  std::vector<std::string> names_, told_;
  std::map<std::string, std::optional<Model>> models_;  // by name; nothing: not known here
};

}  // namespace prehend::mapping
