// Where hands lie, by name.
#include <algorithm>
#include <string_view>
#include <utility>

#include "common/base/paths.hpp"
#include "common/base/toml_document.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::model {
namespace {

/// Folders of hands: those that come with us first, then those that the user keeps.
std::vector<std::filesystem::path> hand_folders() {
  std::vector<std::filesystem::path> folders{share_directory() / "models" / "hands"};
  if (const auto own = data_directory(); !own.empty()) folders.push_back(own / "models" / "hands");
  return folders;
}

bool has_files(const std::filesystem::path& folder) {
  std::error_code none;
  return std::filesystem::exists(folder / "hand.toml", none);
}

std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none))
    if (has_files(entry.path())) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

constexpr std::string_view left = "_left", right = "_right";

/// Names of the hands whose mirror image a hand of this name may be, the likelier first.
std::vector<std::string> mirrored_by(const std::string& name) {
  std::vector<std::string> names;
  if (name.ends_with(left) && name.size() > left.size())
    names.push_back(name.substr(0, name.size() - left.size()));
  if (name.ends_with(left) || name.ends_with(right)) names.push_back(mirror_name(name));
  return names;
}

}  // namespace

std::string mirror_name(const std::string& name) {
  for (const auto& [side, other] : {std::pair(left, right), std::pair(right, left)})
    if (name.ends_with(side)) return name.substr(0, name.size() - side.size()).append(other);
  return name + std::string(left);
}

std::filesystem::path hand_files(const std::filesystem::path& folder) {
  if (has_files(folder)) return folder;
  // The folder may be written with a slash at its end.
  const auto whole = folder.has_filename() ? folder : folder.parent_path();
  for (const std::string& name : mirrored_by(whole.filename().string()))
    if (const auto beside = whole.parent_path() / name; has_files(beside)) return beside;
  return folder;
}

bool is_hand(const std::filesystem::path& folder) {
  return has_files(hand_files(folder));
}

std::filesystem::path hand_directory(const std::string& hand) {
  if (hand.find('/') != std::string::npos) return hand;
  std::error_code none;
  for (const auto& is : {has_files, is_hand}) {  // a mirror image last
    for (const auto& folder : hand_folders())
      if (is(folder / hand)) return folder / hand;
    if (!hand.empty() && is(hand)) return std::filesystem::absolute(hand, none);
  }
  return hand_folders().front() / hand;
}

std::vector<std::string> hand_names() {
  return names_in(hand_folders().front());
}

Expected<std::filesystem::path> named_hand(const std::string& name) {
  for (const auto& names : {std::vector{name}, mirrored_by(name)})
    for (const auto& folder : hand_folders()) {
      const auto kept = names_in(folder);
      for (const std::string& one : names)
        if (std::find(kept.begin(), kept.end(), one) != kept.end()) return folder / name;
    }
  return fail("no hand of this name comes with us or is the user's", "'" + name + "'");
}

Expected<std::filesystem::path> named_hand(const std::string& name,
                                           const std::vector<std::string>& told) {
  for (const std::string& one : told) {
    if (one.empty()) continue;
    const auto folder = hand_directory(one);
    if (const auto hand = HandModel::load(folder); hand && hand->name() == name) return folder;
  }
  return named_hand(name);
}

std::string lab_hand() {
  try {
    const toml::table lab = toml::parse_file((share_directory() / "lab.toml").string());
    return lab["mapping"]["hand"].value_or(std::string());
  } catch (const toml::parse_error&) {
    return {};  // whoever needs a hand says that none is named
  }
}

std::string hand_hint() {
  std::string names;
  for (const auto& folder : hand_folders())
    for (const std::string& name : names_in(folder)) names += (names.empty() ? "" : ", ") + name;
  return "choose one of " + names +
         ", NAME_left for its mirror image, or give the path of a folder";
}

}  // namespace prehend::model
