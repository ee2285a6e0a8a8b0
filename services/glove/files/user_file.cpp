#include "services/glove/files/user_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>
#include <string_view>

#include "common/base/toml_document.hpp"
#include "services/glove/core/joint_sensors.hpp"

namespace prehend::glove {
namespace {

std::vector<double> numbers(const toml::table* table, std::string_view key) {
  std::vector<double> values;
  if (const toml::array* array = table ? (*table)[key].as_array() : nullptr)
    for (const toml::node& node : *array) values.push_back(node.value<double>().value_or(NAN));
  return values;
}

template <std::size_t n>
bool take(const std::vector<double>& values, double least, double most,
          std::array<double, n>& target) {
  const auto fits = [&](double v) { return v >= least && v <= most; };
  if (values.size() != n || !std::all_of(values.begin(), values.end(), fits)) return false;
  std::copy(values.begin(), values.end(), target.begin());
  return true;
}

/// A basic string; what TOML does not allow in one is left out.
std::string toml_text(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f) result += c;
  }
  return result + '"';
}

}  // namespace

Expected<UserCalibration> load_user(const std::filesystem::path& file) {
  const auto bad = [&](const std::string& what) {
    return fail(what, file.string(), "make it with prehend glove calibrate");
  };
  const auto document = load_toml(file, "make it with prehend glove calibrate");
  if (!document) return tl::unexpected(document.error());
  const toml::table& root = *document;
  UserCalibration user;
  user.user = root["user"].value_or(std::string());
  user.scale = root["hand_scale"].value_or(std::nan(""));
  user.scale_sd = root["hand_scale_sd"].value_or(0.0);
  user.residual = root["residual"].value_or(0.0);
  if (user.user.empty()) return bad("names no user");
  if (!(user.scale >= 0.7 && user.scale <= 1.4)) return bad("hand_scale must lie in 0.7 to 1.4");
  for (std::size_t f = 0; f < model::finger_names.size(); ++f) {
    const toml::table* finger = root["finger"][model::finger_names.rows[f].name].as_table();
    if (!take(numbers(finger, "bones"), 0.005, 0.12, user.bones[f]))
      return bad(fmt::format("finger.{}.bones must be three lengths of 5 to 120 mm",
                             model::finger_names.rows[f].name));
    if (!take(numbers(finger, "range"), 0, 0.4, user.range[f]))
      return bad(fmt::format("finger.{}.range must be two lengths up to 0.4 m",
                             model::finger_names.rows[f].name));
  }
  const toml::table* glove = root[joint_gains_table].as_table();
  user.gain = numbers(glove, "gain");
  user.offset = numbers(glove, "offset");
  const auto finite = [](double v) { return std::isfinite(v); };
  if (user.gain.size() != user.offset.size() ||
      !std::all_of(user.gain.begin(), user.gain.end(), finite) ||
      !std::all_of(user.offset.begin(), user.offset.end(), finite))
    return bad(fmt::format("{}.gain and offset must be as many finite numbers", joint_gains_table));
  return user;
}

Expected<void> save(const std::filesystem::path& file, const UserCalibration& user) {
  std::string text = fmt::format(
      "# A hand, as prehend glove calibrate measured it. Lengths in m.\n"
      "user = {}\nhand_scale = {:.4f}\nhand_scale_sd = {:.4f}\nresidual = {:.5f}\n",
      toml_text(user.user), user.scale, user.scale_sd, user.residual);
  for (std::size_t f = 0; f < model::finger_names.size(); ++f)
    text += fmt::format("\n[finger.{}]\nbones = [{:.5f}]\nrange = [{:.4f}]\n",
                        model::finger_names.rows[f].name, fmt::join(user.bones[f], ", "),
                        fmt::join(user.range[f], ", "));
  if (!user.gain.empty())
    text += fmt::format("\n[{}]\ngain = [{:.8f}]\noffset = [{:.6f}]\n", joint_gains_table,
                        fmt::join(user.gain, ", "), fmt::join(user.offset, ", "));
  std::error_code ignored;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), ignored);
  std::ofstream stream(file, std::ios::binary);
  stream << text << std::flush;
  if (!stream)
    return fail("the file cannot be written", file.string(), "choose another with --out");
  return {};
}

}  // namespace prehend::glove
