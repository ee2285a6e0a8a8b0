#include "services/mapping/service/other_states.hpp"

#include <algorithm>
#include <utility>

#include "common/base/log.hpp"
#include "common/convert/convert.hpp"

namespace prehend::mapping {
namespace {

constexpr std::size_t max_models = 16;  // of what others may claim to be

}  // namespace

OtherStates::OtherStates(std::vector<std::string> names, const std::string& kind)
    : names_(std::move(names)) {
  const std::string files = model::hand_files(model::hand_directory(kind)).string();
  told_ = {kind, files, model::mirror_name(files)};
}

bool OtherStates::names(const std::string& hand) const {
  return std::find(names_.begin(), names_.end(), hand) != names_.end();
}

const std::optional<OtherStates::Model>& OtherStates::model(const std::string& name) {
  static const std::optional<Model> none;
  if (const auto known = models_.find(name); known != models_.end()) return known->second;
  if (models_.size() >= max_models) return none;
  const auto hand = model::named_hand(name, told_).and_then(model::HandModel::load);
  if (!hand) log::warning("another hand cannot be kept off: {}", hand.error().message());
  return models_[name] = hand ? std::optional(Model{HandCapsules(*hand),
                                                    static_cast<Eigen::Index>(hand->dofs().size())})
                              : std::nullopt;
}

Expected<std::vector<Capsule>> OtherStates::place(const v1::HandState& state) {
  const auto& known = model(state.model().to_string());
  if (!known) return fail("another hand is not known");
  const auto X_WB = convert::from_message(state.X_WB());
  const Eigen::VectorXd dof = convert::from_message(state.dof());
  if (!X_WB || dof.size() != known->dofs || !dof.allFinite())
    return fail("state of another hand not usable");
  return known->capsules.at(*X_WB, dof);
}

}  // namespace prehend::mapping
