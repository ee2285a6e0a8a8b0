#include "tests/support/hands.hpp"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <stdexcept>
#include <utility>

#include "common/base/file_text.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::test {

namespace {
const std::filesystem::path folder = test::in_sources("common/models/hands");
}

std::vector<std::string> hand_names() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.is_directory()) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::string> mappable_hands() {
  std::vector<std::string> names = hand_names();
  std::erase_if(names, [](const std::string& name) {
    return !std::filesystem::exists(test::in_sources("services/mapping/schemes/") + name + ".toml");
  });
  return names;
}

const model::HandModel& hand(std::string_view name) {
  static std::map<std::string, model::HandModel, std::less<>> loaded;
  const auto found = loaded.find(name);
  if (found != loaded.end()) return found->second;
  auto made = model::HandModel::load(folder / name);
  if (!made) throw std::runtime_error(made.error().message());
  return loaded.emplace(name, std::move(*made)).first->second;
}

model::HandModel coupled_hand(const std::string& name, const std::string& coupling) {
  std::string toml = read_file(folder / name / "hand.toml").value();
  for (std::size_t at = 0; (at = toml.find("[[dof]]", at)) != std::string::npos; at += 7)
    toml.insert(at + 7, "\ncoupling = \"" + coupling + "\"");
  auto made = model::HandModel::parse(read_file(folder / name / "hand.urdf").value(), toml);
  if (!made) throw std::runtime_error(made.error().message());
  return std::move(*made);
}

}  // namespace prehend::test
