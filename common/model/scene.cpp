#include "common/model/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "common/base/printable.hpp"
#include "common/base/random.hpp"
#include "common/base/toml_document.hpp"

namespace prehend::model {
namespace {

using Eigen::Vector3d;
constexpr double pi = std::numbers::pi;

/// What is wrong first, and in which line; without a text: nothing.
struct Problem {
  std::string text;
  toml::source_index line = 0;  // 0: no line of its own
};

/// Reads the keys of one table and remembers which were asked for, so that a misspelt one is found.
class TableReader {
 public:
  TableReader(const toml::table& table, std::string name) : table_(table), name_(std::move(name)) {}

  template <class T>
  void read(std::string_view key, T& value) {
    known_.insert(std::string(key));
    const auto node = table_[key];
    if (!node) return;
    if (const auto found = node.template value<T>())
      value = *found;
    else
      complain(key, "has the wrong type");
  }
  void read_seed(std::string_view key, std::uint64_t& value) {
    auto number = static_cast<std::int64_t>(value);
    read(key, number);
    value = static_cast<std::uint64_t>(number);
  }
  void read(std::string_view key, Vector3d& value) {
    std::vector<double> numbers(value.data(), value.data() + 3);
    read_list(key, numbers);
    if (numbers.size() == 3)
      value = Eigen::Map<const Vector3d>(numbers.data());
    else
      complain(key, "needs three numbers");
  }
  void read(std::string_view key, Reach& value) {
    std::vector<double> n{value.opening, value.engage, value.clearance, value.half_width};
    read_list(key, n);
    if (n.size() != 4)
      return complain(key, "needs four numbers: opening, engage, clearance, half width");
    if (*std::min_element(n.begin(), n.end()) < 0) return complain(key, "must not be negative");
    value = {n[0], n[1], n[2], n[3]};
  }
  void read(std::string_view key, Pose& value) {
    const Eigen::Quaterniond q(value.linear());
    std::vector<double> n{value.translation().x(),
                          value.translation().y(),
                          value.translation().z(),
                          q.w(),
                          q.x(),
                          q.y(),
                          q.z()};
    read_list(key, n);
    if (n.size() != 7)
      return complain(key, "needs seven numbers: x y z in m, then the quaternion w x y z");
    const auto pose = checked_pose({n[0], n[1], n[2]}, Eigen::Quaterniond(n[3], n[4], n[5], n[6]));
    if (pose)
      value = *pose;
    else
      complain(key, pose.error().what);
  }
  const Problem& problem() {
    for (const auto& [key, node] : table_)
      if (!known_.contains(std::string(key.str()))) complain(key.str(), "is not a key of a scene");
    return problem_;
  }

 private:
  void read_list(std::string_view key, std::vector<double>& values) {
    known_.insert(std::string(key));
    const toml::array* array = table_[key].as_array();
    if (!array) {
      if (table_[key]) complain(key, "must be a list of numbers");
      return;
    }
    values.clear();
    for (const toml::node& node : *array) values.push_back(node.value<double>().value_or(NAN));
    if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); }))
      complain(key, "must be a list of finite numbers");
  }
  void complain(std::string_view key, std::string_view what) {
    if (!problem_.text.empty()) return;
    const toml::node* node = table_.get(key);
    problem_ = {fmt::format("{}.{} {}", name_, key, what),
                (node ? node->source() : table_.source()).begin.line};
  }

  const toml::table& table_;
  std::string name_;
  Problem problem_;
  std::set<std::string> known_;
};

/// Round-trips every double; TOML wants a point or an exponent in a float.
std::string number(double v) {
  std::string text = fmt::format("{}", v);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string list(std::initializer_list<double> values) {
  std::string text;
  for (const double v : values) text += (text.empty() ? "[" : ", ") + number(v);
  return text + "]";
}
std::string list(const Vector3d& v) {
  return list({v.x(), v.y(), v.z()});
}
std::string list(const Pose& X) {
  const Eigen::Quaterniond q(X.linear());
  const Vector3d p = X.translation();
  return list({p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()});
}

/// A text as TOML writes it.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + "\"";
}

void read_scene(TableReader& reader, Scene& scene) {
  reader.read("name", scene.name);
  reader.read("table_colour", scene.table_colour);
  reader.read_seed("texture_seed", scene.texture_seed);
  reader.read("X_WH", scene.X_WH);
  reader.read("recording_rate", scene.recording_rate);
}

void read_light(TableReader& reader, Light& light) {
  reader.read("to_light_W", light.to_light_W);
  reader.read("ambient", light.ambient);
  reader.read("gain", light.gain);
  reader.read("colour", light.colour);
}

void read_demonstrator(TableReader& reader, Demonstrator& person) {
  reader.read("user", person.user);
  reader.read("target", person.target);
  reader.read("hand_scale", person.hand_scale);
  reader.read("grasp_yaw", person.grasp_yaw);
  reader.read("reach", person.reach);
  reader.read("carry_W", person.carry_W);
  reader.read("X_OG", person.X_OG);
  reader.read("hands_over", person.hands_over);
  reader.read("approach_offset", person.approach_offset);
  reader.read("approach_turn", person.approach_turn);
  reader.read("position_noise", person.position_noise);
  reader.read("angle_noise", person.angle_noise);
  reader.read("extreme_rate", person.extreme_rate);
  reader.read_seed("seed", person.seed);
}

/// What makes no sense in a scene whose values can be read; empty: nothing.
std::string contradiction(const Scene& scene) {
  if (!(scene.recording_rate > 0)) return "recording_rate must be positive";
  if (!(scene.light.to_light_W.norm() > 1e-6)) return "light has no direction";
  if (!(scene.demonstrator.hand_scale >= 0.7 && scene.demonstrator.hand_scale <= 1.4))
    return "hand_scale must lie in 0.7 to 1.4";
  if (!(scene.demonstrator.carry_W.norm() <= 1)) return "carry_W must be at most 1 m";
  if (scene.demonstrator.hands_over) {
    if (scene.demonstrator.carry_W.isZero()) return "hands_over needs carry_W";
  } else if (!scene.demonstrator.carry_W.isZero() &&
             !(scene.demonstrator.X_OG.translation().x() > 0)) {
    return "X_OG must say where the right hand presses what is carried, at x > 0";
  }
  const std::string& target = scene.demonstrator.target;
  if (!target.empty() &&
      std::none_of(scene.objects.begin(), scene.objects.end(),
                   [&](const PlacedObject& object) { return object.name == target; }))
    return "the demonstrator's target '" + target + "' stands nowhere";
  return {};
}

/// Does a point of the first, of a grid, lie deeper in the second than contact explains?
bool reaches_into(const Shape& one, const Pose& X_W1, const Shape& other, const Pose& X_W2) {
  constexpr int steps = 6;         // a side of the middle, along each axis
  constexpr double touch = 0.002;  // m
  const Pose X_21 = X_W2.inverse() * X_W1;
  const Vector3d half = half_extents(one);
  for (int x = -steps; x <= steps; ++x)
    for (int y = -steps; y <= steps; ++y)
      for (int z = -steps; z <= steps; ++z) {
        const Vector3d p = Vector3d(x, y, z).cwiseProduct(half) / steps;
        if (signed_distance(one, p) <= 1e-9 && signed_distance(other, X_21 * p) < -touch)
          return true;
      }
  return false;
}

bool overlap(const Shape& one, const Pose& X_W1, const Shape& other, const Pose& X_W2) {
  const double reach = half_extents(one).norm() + half_extents(other).norm();
  if ((X_W1.translation() - X_W2.translation()).norm() > reach) return false;
  return reaches_into(one, X_W1, other, X_W2) || reaches_into(other, X_W2, one, X_W1);
}

/// Why the object of this number cannot stand as it is said; empty: it can. Objects are known by
/// their names, and what is inside another flies apart in the first step of the world.
std::string misplaced(const Scene& scene, std::size_t i, const Catalogue& catalogue) {
  constexpr double farthest = 5, below = -0.01;  // m
  const PlacedObject& one = scene.objects[i];
  const Vector3d p = one.X_WO.translation();
  if (p.cwiseAbs().maxCoeff() > farthest || p.z() < below)
    return fmt::format(
        "object '{}' is at ({:g}, {:g}, {:g}) m: below the table, or more than {:g} m away",
        one.name, p.x(), p.y(), p.z(), farthest);
  const Shape& shape = catalogue.find(one.name)->shape;
  for (std::size_t k = 0; k < i; ++k) {
    const PlacedObject& other = scene.objects[k];
    if (other.name == one.name) return "two objects are named '" + one.name + "'";
    if (overlap(shape, one.X_WO, catalogue.find(other.name)->shape, other.X_WO))
      return fmt::format("objects '{}' and '{}' are inside each other", other.name, one.name);
  }
  return {};
}

/// The objects of a scene, each where it can stand.
Problem read_objects(const toml::table& root, const Catalogue& catalogue, Scene& scene) {
  const toml::node* node = root.get("object");
  if (!node) return {};
  if (!node->is_array()) return {"object must be [[object]]", node->source().begin.line};
  for (const toml::node& entry : *node->as_array()) {
    const auto line = entry.source().begin.line;
    const toml::table* table = entry.as_table();
    if (!table) return {"object is no table", line};
    PlacedObject object{"", Pose::Identity()};
    TableReader reader(*table, "object");
    reader.read("name", object.name);
    reader.read("X_WO", object.X_WO);
    if (!reader.problem().text.empty()) return reader.problem();
    if (!catalogue.find(object.name))
      return {"object '" + printable(object.name) + "' is not in the catalogue", line};
    scene.objects.push_back(object);
    if (auto why = misplaced(scene, scene.objects.size() - 1, catalogue); !why.empty())
      return {std::move(why), line};
  }
  return {};
}

/// A light as the seed wants it.
Light drawn_light(Random& random) {
  Light light;
  const double turn = random.uniform(0, 2 * pi), height = random.uniform(0.6, 1.3);
  light.to_light_W = {std::cos(turn) * std::cos(height), std::sin(turn) * std::cos(height),
                      std::sin(height)};
  light.ambient = random.uniform(0.35, 0.6);
  light.gain = random.uniform(0.85, 1.15);
  for (double& channel : light.colour) channel = random.uniform(0.94, 1.06);
  return light;
}

void place(Scene& scene, const CatalogueObject& object, double x, double y, double yaw) {
  const double height = half_extents(object.shape).z();
  scene.objects.push_back(
      {object.name, make_pose(Vector3d(x, y, height),
                              Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Vector3d::UnitZ())))});
}

/// Others than the first object of the scene, where they neither hide it nor are in the way of the
/// hands.
void place_distractors(Scene& scene, const Catalogue& catalogue, int count, Random& random) {
  const double x = scene.objects.front().X_WO.translation().x();
  const double y = scene.objects.front().X_WO.translation().y();
  std::set<std::string> used{scene.objects.front().name};
  for (int tries = 0; tries < 500 && static_cast<int>(used.size()) <= count; ++tries) {
    const CatalogueObject& other = catalogue.objects()[random.index(catalogue.objects().size())];
    const double ox = random.uniform(-0.4, 0.4), oy = random.uniform(-0.2, 0.35);
    const double yaw = random.uniform(-pi, pi);
    if (used.contains(other.name)) continue;
    const double radius = half_extents(other.shape).head<2>().norm();
    const double towards = std::atan2(oy - y, ox - x);
    const auto apart = [&](double azimuth) {
      return std::abs(std::remainder(towards - azimuth, 2 * pi));
    };
    if (std::hypot(ox - x, oy - y) < 0.24 + radius) continue;
    if (apart(scene.demonstrator.grasp_yaw) < 1.2 || apart(-pi / 2) < 1.0) continue;
    const bool crowded = std::any_of(
        scene.objects.begin() + 1, scene.objects.end(), [&](const PlacedObject& placed) {
          const double taken = half_extents(catalogue.find(placed.name)->shape).head<2>().norm();
          return std::hypot(placed.X_WO.translation().x() - ox,
                            placed.X_WO.translation().y() - oy) < taken + radius + 0.03;
        });
    if (crowded) continue;
    place(scene, other, ox, oy, yaw);
    used.insert(other.name);
  }
}

}  // namespace

Expected<Scene> load_scene(const std::filesystem::path& file, const Catalogue& catalogue) {
  const auto document = load_toml(file, "a scene is a TOML file");
  if (!document) return tl::unexpected(document.error());
  const toml::table& root = *document;
  Scene scene;
  Problem problem;
  const auto note = [&](Problem found) {
    if (problem.text.empty()) problem = std::move(found);
  };
  const auto read_table = [&](std::string_view name, auto&& read) {
    const toml::node* node = root.get(name);
    if (!node) return;
    const toml::table* table = node->as_table();
    if (!table) return note({fmt::format("{} must be a table", name), node->source().begin.line});
    TableReader reader(*table, std::string(name));
    read(reader);
    note(reader.problem());
  };
  read_table("scene", [&](TableReader& reader) { read_scene(reader, scene); });
  read_table("light", [&](TableReader& reader) { read_light(reader, scene.light); });
  read_table("demonstrator",
             [&](TableReader& reader) { read_demonstrator(reader, scene.demonstrator); });
  note(read_objects(root, catalogue, scene));
  for (const auto& [key, node] : root)
    if (key != "scene" && key != "light" && key != "demonstrator" && key != "object")
      note({fmt::format("{} is not a table of a scene", key.str()), node.source().begin.line});
  note({contradiction(scene)});
  if (!problem.text.empty())
    return fail(problem.text,
                file.string() + (problem.line ? fmt::format(": line {}", problem.line) : ""),
                "X_WO is x y z in metres, then w x y z; `prehend scene` writes a sound scene");
  scene.light.to_light_W.normalize();
  return scene;
}

std::string to_toml(const Scene& scene) {
  const Demonstrator& person = scene.demonstrator;
  std::string text = fmt::format(
      "[scene]\nname = {}\ntable_colour = {}\ntexture_seed = {}\nX_WH = {}\nrecording_rate = "
      "{}\n\n",
      quoted(scene.name), list(scene.table_colour), static_cast<std::int64_t>(scene.texture_seed),
      list(scene.X_WH), number(scene.recording_rate));
  text += fmt::format("[light]\nto_light_W = {}\nambient = {}\ngain = {}\ncolour = {}\n\n",
                      list(scene.light.to_light_W), number(scene.light.ambient),
                      number(scene.light.gain), list(scene.light.colour));
  text += fmt::format(
      "[demonstrator]\nuser = {}\ntarget = {}\nhand_scale = {}\ngrasp_yaw = {}\nreach = {}\n"
      "approach_offset = {}\napproach_turn = {}\nposition_noise = {}\nangle_noise = {}\n"
      "extreme_rate = {}\nseed = {}\n",
      quoted(person.user), quoted(person.target), number(person.hand_scale),
      number(person.grasp_yaw),
      list({person.reach.opening, person.reach.engage, person.reach.clearance,
            person.reach.half_width}),
      list(person.approach_offset), list(person.approach_turn), number(person.position_noise),
      number(person.angle_noise), number(person.extreme_rate),
      static_cast<std::int64_t>(person.seed));
  if (!person.carry_W.isZero())
    text += fmt::format("carry_W = {}\nX_OG = {}\nhands_over = {}\n", list(person.carry_W),
                        list(person.X_OG), person.hands_over);
  for (const PlacedObject& object : scene.objects)
    text +=
        fmt::format("\n[[object]]\nname = {}\nX_WO = {}\n", quoted(object.name), list(object.X_WO));
  return text;
}

Expected<Scene> make_scene(const Catalogue& catalogue, std::uint64_t seed,
                           const SceneOptions& options) {
  Random random(seed * 0x9E3779B97F4A7C15ULL + 1);
  Scene scene;
  scene.name = fmt::format("seed-{}", seed);
  scene.texture_seed = random.bits() >> 1;
  for (double& channel : scene.table_colour) channel = random.uniform(0.35, 0.75);
  scene.light = drawn_light(random);

  std::vector<std::string> names = options.graspable;
  if (names.empty())
    for (const CatalogueObject& object : catalogue.objects()) names.push_back(object.name);
  const std::string drawn = names[random.index(names.size())];
  const CatalogueObject* target = catalogue.find(options.target.empty() ? drawn : options.target);
  if (!target)
    return fail("object '" + (options.target.empty() ? drawn : options.target) +
                    "' is not in the catalogue",
                "scene", "see prehend demo --help");

  const double x = random.uniform(-0.12, 0.12), y = random.uniform(-0.15, 0.05);
  place(scene, *target, x, y, random.uniform(-pi / 2, pi / 2));

  Demonstrator& person = scene.demonstrator;
  person.user = fmt::format("user{}", seed);
  person.target = target->name;
  person.hand_scale = std::clamp(1.0 + random.normal(0.06), 0.86, 1.14);
  person.grasp_yaw = -pi / 2 + random.uniform(-0.9, 0.9);  // from the side of the camera
  for (double& offset : person.approach_offset) offset = random.uniform(-0.01, 0.01);
  const Vector3d axis = random.normal3(1.0).normalized();
  person.approach_turn = axis * random.uniform(0, 10 * pi / 180);
  person.seed = random.bits() >> 1;

  place_distractors(scene, catalogue, options.distractors, random);
  return scene;
}

}  // namespace prehend::model
