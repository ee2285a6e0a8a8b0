#include "services/mapping/tools/training/scheme.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <optional>

#include "common/base/paths.hpp"
#include "common/base/toml_document.hpp"

namespace prehend::mapping {

namespace {

/// The file's unit of a DoF: degrees, or millimetres of what slides.
double unit_of(const model::HandDof& dof) {
  return dof.kind == model::JointKind::prismatic ? 0.001 : std::numbers::pi / 180;
}

/// `count` numbers of an array; nothing when they are not that.
std::optional<std::vector<double>> numbers(const toml::node_view<const toml::node>& node,
                                           std::size_t count) {
  const toml::array* array = node.as_array();
  if (!array || array->size() != count) return std::nullopt;
  std::vector<double> values;
  for (const toml::node& element : *array) {
    const auto value = element.value<double>();
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  return values;
}

/// Numbers of a hand's DoFs that are named; fails on a name that it does not have.
Expected<std::vector<std::size_t>> named_dofs(const toml::node_view<const toml::node>& node,
                                              const model::HandModel& hand) {
  std::vector<std::size_t> found;
  const toml::array* names = node.as_array();
  if (!names) return found;
  for (const toml::node& element : *names) {
    const auto name = element.value_or(std::string());
    const auto dof = std::find_if(hand.dofs().begin(), hand.dofs().end(),
                                  [&](const model::HandDof& d) { return d.name == name; });
    if (dof == hand.dofs().end()) return fail(fmt::format("the hand has no DoF «{}»", name));
    found.push_back(static_cast<std::size_t>(dof - hand.dofs().begin()));
  }
  return found;
}

/// One scheme file while it is being read.
class Reader {
 public:
  Reader(const toml::table& table, const model::HandModel& hand) : table_(table), hand_(hand) {}

  Expected<Scheme> read() {
    scheme_.name = table_["name"].value_or(std::string());
    if (auto ok = read_limits(); !ok) return tl::unexpected(ok.error());
    const toml::table* open = table_["open"].as_table();
    if (!open) return fail("has no posture «open»");
    auto posture = read_posture(*open);
    if (!posture) return fail(posture.error().what, "open");
    scheme_.open = std::move(*posture);
    scheme_.open.name = "open";
    if (auto ok = for_each("closed", [&](const auto& entry) { return add_closed(entry); }); !ok)
      return tl::unexpected(ok.error());
    for (const char* finger : {"thumb", "index", "little"})
      if (std::none_of(scheme_.closed.begin(), scheme_.closed.end(),
                       [&](const SchemePosture& closed) { return closed.name == finger; }))
        return fail(fmt::format("has no closed posture «{}»", finger));
    if (auto ok = for_each("preshape", [&](const auto& entry) { return add_preshape(entry); }); !ok)
      return tl::unexpected(ok.error());
    for (const GraspType type : grasp_types)
      if (std::none_of(scheme_.preshapes.begin(), scheme_.preshapes.end(), [&](const Preshape& p) {
            return std::find(p.types.begin(), p.types.end(), type) != p.types.end();
          }))
        return fail(fmt::format("has no preshape for {} grasps", to_string(type)));
    return std::move(scheme_);
  }

 private:
  template <class Take>
  Expected<void> for_each(const char* key, Take take) {
    const toml::array* entries = table_[key].as_array();
    if (!entries) return {};
    for (const toml::node& node : *entries) {
      const toml::table* entry = node.as_table();
      if (!entry) return fail("is not a table", key);
      if (auto ok = take(*entry); !ok) {
        const auto name = (*entry)["name"].value_or(std::string());
        return fail(ok.error().what, name.empty() ? key : fmt::format("{} «{}»", key, name));
      }
    }
    return {};
  }

  Expected<void> read_limits() {
    const auto count = static_cast<Eigen::Index>(hand_.dofs().size());
    scheme_.lower.resize(count);
    scheme_.upper.resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      scheme_.lower[i] = hand_.dofs()[static_cast<std::size_t>(i)].lower;
      scheme_.upper[i] = hand_.dofs()[static_cast<std::size_t>(i)].upper;
    }
    return for_each("limit", [&](const toml::table& entry) -> Expected<void> {
      const auto dofs = named_dofs(entry["dofs"], hand_);
      if (!dofs) return tl::unexpected(dofs.error());
      if (dofs->empty()) return fail("names no DoF");
      for (const std::size_t i : *dofs) {
        const model::HandDof& dof = hand_.dofs()[i];
        const auto k = static_cast<Eigen::Index>(i);
        scheme_.lower[k] = entry["lower"].value_or(dof.lower / unit_of(dof)) * unit_of(dof);
        scheme_.upper[k] = entry["upper"].value_or(dof.upper / unit_of(dof)) * unit_of(dof);
        // Written so that not-a-number fails.
        if (!(scheme_.lower[k] >= dof.lower - rounding &&
              scheme_.upper[k] <= dof.upper + rounding && scheme_.lower[k] <= scheme_.upper[k]))
          return fail(
              fmt::format("the limits of «{}» are upside down or wider than the hand's", dof.name));
      }
      return {};
    });
  }

  /// «robot»: a number a DoF, or the name of one of the hand's own postures.
  Expected<Eigen::VectorXd> read_robot(const toml::table& entry) const {
    const std::size_t count = hand_.dofs().size();
    Eigen::VectorXd dof(count);
    if (const auto name = entry["robot"].value<std::string>()) {
      const auto posture = hand_.postures().find(*name);
      if (posture == hand_.postures().end())
        return fail(fmt::format("the hand has no posture «{}»", *name));
      dof = posture->second;
    } else {
      const auto values = numbers(entry["robot"], count);
      if (!values) return fail(fmt::format("«robot» is not {} numbers", count));
      for (std::size_t i = 0; i < count; ++i)
        dof[static_cast<Eigen::Index>(i)] = (*values)[i] * unit_of(hand_.dofs()[i]);
    }
    if (!dof.allFinite() || (dof.array() < scheme_.lower.array() - rounding).any() ||
        (dof.array() > scheme_.upper.array() + rounding).any())
      return fail("«robot» is outside the limits");
    return dof;
  }

  Expected<SchemePosture> read_posture(const toml::table& entry) const {
    SchemePosture posture;
    posture.name = entry["name"].value_or(std::string());
    const auto closure = numbers(entry["human"], model::finger_count);
    if (!closure) return fail("«human» is not five numbers");
    for (std::size_t f = 0; f < closure->size(); ++f) {
      if (!((*closure)[f] >= 0 && (*closure)[f] <= 1)) return fail("«human» is outside 0 to 1");
      posture.human[f] = (*closure)[f];
    }
    posture.splay = entry["splay"].value_or(0.0);
    if (!(posture.splay >= 0 && posture.splay <= 1)) return fail("«splay» is outside 0 to 1");
    auto robot = read_robot(entry);
    if (!robot) return tl::unexpected(robot.error());
    posture.robot = std::move(*robot);
    return posture;
  }

  Expected<void> add_closed(const toml::table& entry) {
    auto posture = read_posture(entry);
    if (!posture) return tl::unexpected(posture.error());
    for (const SchemePosture& other : scheme_.closed)
      if (other.name == posture->name) return fail("is there twice");
    if (posture->human == scheme_.open.human && posture->splay == scheme_.open.splay)
      return fail("is the open hand");
    scheme_.closed.push_back(std::move(*posture));
    return {};
  }

  Expected<void> add_preshape(const toml::table& entry) {
    auto robot = read_robot(entry);
    if (!robot) return tl::unexpected(robot.error());
    Preshape preshape{std::move(*robot), {}, std::vector<bool>(hand_.dofs().size())};
    const auto resting = named_dofs(entry["resting"], hand_);
    if (!resting) return tl::unexpected(resting.error());
    for (const std::size_t dof : *resting) preshape.resting[dof] = true;
    if (const toml::array* types = entry["types"].as_array()) {
      for (const toml::node& node : *types) {
        const auto name = node.value_or(std::string());
        const auto type = grasp_type_from_string(name);
        if (!type || *type == GraspType::none)
          return fail(fmt::format("unknown grasp type «{}»", name));
        preshape.types.push_back(*type);
      }
    } else {
      preshape.types.assign(grasp_types.begin(), grasp_types.end());
    }
    scheme_.preshapes.push_back(std::move(preshape));
    return {};
  }

  static constexpr double rounding = 1e-9;
  const toml::table& table_;
  const model::HandModel& hand_;
  Scheme scheme_;
};

/// A share of the way from the open hand to a closed posture is added to `posture`.
void add_share(SchemePosture& posture, const SchemePosture& open, const SchemePosture& closed,
               double share) {
  for (std::size_t f = 0; f < posture.human.size(); ++f)
    posture.human[f] += share * (closed.human[f] - open.human[f]);
  posture.splay += share * (closed.splay - open.splay);
  posture.robot += share * (closed.robot - open.robot);
}

}  // namespace

std::vector<SchemePosture> Scheme::posture_set(int count) const {
  const int levels = std::max(1, (count - 1) / 3);
  std::vector<SchemePosture> set{open};
  for (const SchemePosture& end : closed)
    for (int level = 1; level <= levels; ++level) {
      SchemePosture posture = open;
      add_share(posture, open, end, static_cast<double>(level) / levels);
      posture.name = level == levels ? end.name + " closed"
                     : levels == 2   ? end.name + " half"
                                     : fmt::format("{} {}/{}", end.name, level, levels);
      set.push_back(std::move(posture));
    }
  return set;
}

std::vector<SchemePosture> Scheme::combinations() const {
  const auto find = [&](const char* finger) -> const SchemePosture& {
    return *std::find_if(closed.begin(), closed.end(),
                         [&](const SchemePosture& posture) { return posture.name == finger; });
  };
  std::vector<SchemePosture> made;
  for (const char* finger : {"index", "thumb"})
    for (const double share : {0.5, 1.0}) {
      SchemePosture posture = open;
      add_share(posture, open, find(finger), share);
      add_share(posture, open, find("little"), share);
      posture.robot = posture.robot.cwiseMax(lower).cwiseMin(upper);
      posture.name = fmt::format("{} and little {}", finger, share < 1 ? "half" : "closed");
      made.push_back(std::move(posture));
    }
  return made;
}

std::filesystem::path scheme_path(const std::string& scheme) {
  if (scheme.find('/') != std::string::npos || scheme.ends_with(".toml")) return scheme;
  return share_directory() / "schemes" / (scheme + ".toml");
}

Expected<Scheme> Scheme::load(const std::filesystem::path& file, const model::HandModel& hand) {
  const auto refuse = [&](const std::string& what, const std::string& element = {}) {
    return fail(what, element.empty() ? file.string() : file.string() + ", " + element);
  };
  const auto document = load_toml(file, "a scheme is TOML");
  if (!document) return tl::unexpected(document.error());
  const toml::table& table = *document;
  if (table["hand"].value_or(std::string()) != hand.name())
    return refuse(fmt::format("is not for the hand «{}»", hand.name()));
  auto scheme = Reader(table, hand).read();
  if (!scheme) return refuse(scheme.error().what, scheme.error().where);
  return scheme;
}

}  // namespace prehend::mapping
