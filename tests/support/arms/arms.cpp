#include "tests/support/arms/arms.hpp"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <stdexcept>

#include "common/base/file_text.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::test {
namespace {

/// A row of a URDF: where a joint stands on the link before, how it turns, and the radius of the
/// capsule along the link that leads on from it.
struct Row {
  std::string xyz, rpy, axis;
  double lower, upper, velocity, radius;
  std::string capsule_xyz, capsule_rpy;
  double length;
};

std::string link(const std::string& name, const Row* row) {
  std::string text = "  <link name=\"" + name +
                     "\">\n    <inertial><mass value=\"2\"/><inertia ixx=\"0.02\" ixy=\"0\" "
                     "ixz=\"0\" iyy=\"0.02\" iyz=\"0\" izz=\"0.02\"/></inertial>\n";
  if (row && row->length > 0)
    text += "    <collision><origin xyz=\"" + row->capsule_xyz + "\" rpy=\"" + row->capsule_rpy +
            "\"/><geometry><cylinder radius=\"" + std::to_string(row->radius) + "\" length=\"" +
            std::to_string(row->length) + "\"/></geometry></collision>\n";
  return text + "  </link>\n";
}

std::string urdf(const std::string& name, const std::vector<Row>& rows) {
  std::string text = "<robot name=\"" + name + "\">\n" + link("base", nullptr);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    const std::string own = "link" + std::to_string(i + 1),
                      before = i == 0 ? "base" : "link" + std::to_string(i);
    text += link(own, &row) + "  <joint name=\"joint" + std::to_string(i + 1) +
            "\" type=\"revolute\">\n    <parent link=\"" + before + "\"/><child link=\"" + own +
            "\"/>\n    <origin xyz=\"" + row.xyz + "\" rpy=\"" + row.rpy + "\"/><axis xyz=\"" +
            row.axis + "\"/>\n    <limit lower=\"" + std::to_string(row.lower) + "\" upper=\"" +
            std::to_string(row.upper) + "\" effort=\"80\" velocity=\"" +
            std::to_string(row.velocity) + "\"/>\n  </joint>\n";
  }
  return text + "</robot>\n";
}

constexpr const char* right = "1.5707963267948966";

std::string turned(const char* pattern) {
  std::string text = pattern;  // h: a right angle, p: two
  for (std::size_t at; (at = text.find('h')) != std::string::npos;) text.replace(at, 1, right);
  for (std::size_t at; (at = text.find('p')) != std::string::npos;)
    text.replace(at, 1, "3.141592653589793");
  return text;
}

ArmFiles offset_wrist() {
  const double t = 6.2831;
  return {
      "offset_wrist",
      urdf(
          "offset_wrist",
          {{"0 0 0.089159", "0 0 0", "0 0 1", -t, t, 3.15, 0.06, "0 0.06 0", turned("h 0 0"), 0.1},
           {"0 0.13585 0", turned("0 h 0"), "0 1 0", -t, t, 3.15, 0.055, "0 0 0.2125", "0 0 0",
            0.4},
           {"0 -0.1197 0.425", "0 0 0", "0 1 0", -3.1415, 3.1415, 3.15, 0.045, "0 0 0.2", "0 0 0",
            0.3},
           {"0 0 0.39225", turned("0 h 0"), "0 1 0", -t, t, 3.2, 0.04, "0 0.05 0", turned("h 0 0"),
            0.06},
           {"0 0.093 0", "0 0 0", "0 0 1", -t, t, 3.2, 0.04, "0 0 0.04", "0 0 0", 0.06},
           {"0 0 0.09465", "0 0 0", "0 1 0", -t, t, 3.2, 0.03, "0 0.04 0", turned("h 0 0"), 0.03}}),
      "name = \"offset_wrist\"\nhome = [0, -1.2, 1.6, -1.9, -1.57, 0]\n[end]\nposition = [0, "
      "0.0823, 0]\n"
      "orientation = [0.7071067811865476, -0.7071067811865476, 0, 0]\n"};
}

ArmFiles seven_offset() {
  return {"seven_offset",
          urdf("seven_offset", {{"0 0 0.333", "0 0 0", "0 0 1", -2.8973, 2.8973, 2.175, 0.06,
                                 "0 0 -0.1", "0 0 0", 0.14},
                                {"0 0 0", turned("-h 0 0"), "0 0 1", -1.7628, 1.7628, 2.175, 0.06,
                                 "0 0 0", "0 0 0", 0.1},
                                {"0 -0.316 0", turned("h 0 0"), "0 0 1", -2.8973, 2.8973, 2.175,
                                 0.055, "0 0 -0.1", "0 0 0", 0.12},
                                {"0.0825 0 0", turned("h 0 0"), "0 0 1", -3.0718, -0.0698, 2.175,
                                 0.055, "0 0 0", "0 0 0", 0.09},
                                {"-0.0825 0.384 0", turned("-h 0 0"), "0 0 1", -2.8973, 2.8973,
                                 2.61, 0.05, "0 0.03 -0.2", "0 0 0", 0.1},
                                {"0 0 0", turned("h 0 0"), "0 0 1", -0.0175, 3.7525, 2.61, 0.045,
                                 "0 0 0", "0 0 0", 0.06},
                                {"0.088 0 0", turned("h 0 0"), "0 0 1", -2.8973, 2.8973, 2.61,
                                 0.035, "0 0 0.06", "0 0 0", 0.05}}),
          "name = \"seven_offset\"\nhome = [0, -0.785, 0, -2.356, 0, 1.571, 0.785]\n[end]\n"
          "position = [0, 0, 0.107]\norientation = [1, 0, 0, 0]\n"};
}

ArmFiles seven_round() {
  const double wide = 2.9671, narrow = 2.0944;
  return {"seven_round",
          urdf("seven_round",
               {{"0 0 0.1575", "0 0 0", "0 0 1", -wide, wide, 1.48, 0.07, "0 0 0.1", "0 0 0", 0.1},
                {"0 0 0.2025", turned("h 0 p"), "0 0 1", -narrow, narrow, 1.48, 0.06, "0 0.09 0",
                 turned("h 0 0"), 0.08},
                {"0 0.2045 0", turned("h 0 p"), "0 0 1", -wide, wide, 1.75, 0.06, "0 0 0.1",
                 "0 0 0", 0.1},
                {"0 0 0.2155", turned("h 0 0"), "0 0 1", -narrow, narrow, 1.31, 0.055, "0 0.09 0",
                 turned("h 0 0"), 0.08},
                {"0 0.1845 0", turned("-h p 0"), "0 0 1", -wide, wide, 2.27, 0.05, "0 0 0.1",
                 "0 0 0", 0.1},
                {"0 0 0.2155", turned("h 0 0"), "0 0 1", -narrow, narrow, 2.36, 0.05, "0 0 0",
                 "0 0 0", 0.06},
                {"0 0.081 0", turned("-h p 0"), "0 0 1", -3.0543, 3.0543, 2.36, 0.035, "0 0 0.01",
                 "0 0 0", 0.02}}),
          "name = \"seven_round\"\nhome = [0, 0.6, 0, -1.5, 0, 1.0, 0]\n[end]\nposition = [0, 0, "
          "0.045]\n"
          "orientation = [1, 0, 0, 0]\n"};
}

}  // namespace

const std::vector<ArmFiles>& foreign_arms() {
  static const std::vector<ArmFiles> arms{offset_wrist(), seven_offset(), seven_round()};
  return arms;
}

std::vector<ArmFiles> all_arms() {
  std::vector<ArmFiles> arms = foreign_arms();
  for (const auto& entry :
       std::filesystem::directory_iterator(test::in_sources("common/models/arms")))
    if (entry.is_directory())
      arms.push_back({entry.path().filename().string(),
                      read_file(entry.path() / "arm.urdf").value(),
                      read_file(entry.path() / "arm.toml").value()});
  std::sort(arms.begin(), arms.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return arms;
}

std::vector<std::string> arm_names() {
  std::vector<std::string> names;
  for (const ArmFiles& files : all_arms()) names.push_back(files.name);
  return names;
}

const model::ArmModel& arm(std::string_view name) {
  using Models = std::map<std::string, model::ArmModel, std::less<>>;
  static const Models loaded = [] {
    Models made;
    for (const ArmFiles& files : all_arms()) {
      auto parsed = model::ArmModel::parse(files.urdf, files.toml);
      if (!parsed) throw std::runtime_error(files.name + ": " + parsed.error().message());
      made.emplace(files.name, std::move(*parsed));
    }
    return made;
  }();
  const auto found = loaded.find(name);
  if (found == loaded.end())
    throw std::runtime_error("no arm of the tests is named " + std::string(name));
  return found->second;
}

arm::Joints random_posture(const model::ArmModel& arm, Random& random) {
  arm::Joints q(static_cast<Eigen::Index>(arm.joints.size()));
  for (std::size_t i = 0; i < arm.joints.size(); ++i)
    q[static_cast<Eigen::Index>(i)] = random.uniform(arm.joints[i].lower, arm.joints[i].upper);
  return q;
}

double turn_distance(const arm::Joints& a, const arm::Joints& b) {
  double most = 0;
  for (Eigen::Index i = 0; i < a.size(); ++i)
    most = std::max(most, std::abs(arm::wrapped(a[i] - b[i])));
  return most;
}

}  // namespace prehend::test
