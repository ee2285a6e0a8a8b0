#include "common/model/arm_choice.hpp"

#include <system_error>

namespace prehend::model {

Expected<ArmModel> load_arm(const std::string& name) {
  const auto folder = arm_directory(name);
  std::error_code ignored;
  if (name.empty() || !std::filesystem::exists(folder / "arm.toml", ignored))
    return wrong_use("there is no such arm", "'" + name + "'", arm_hint());
  return ArmModel::load(folder);
}

}  // namespace prehend::model
