#include "services/planner/tools/hand_import/mjcf_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/finite_number.hpp"

namespace prehend::planner {
namespace {

using Eigen::Vector3d;
using tinyxml2::XMLElement;

constexpr int deepest_include = 8;
constexpr std::size_t included_files = 64;
constexpr double largest_number =
    1e9;  // what is longer, heavier or stronger is no number of a robot
constexpr const char* main_class = "main";  // the class of the outermost <default>

Expected<std::unique_ptr<tinyxml2::XMLDocument>> xml_of(const std::string& text) {
  if (text.find('\0') != std::string::npos) return fail("holds a zero byte", {}, "XML is text");
  auto document = std::make_unique<tinyxml2::XMLDocument>();
  document->Parse(text.data(), text.size());
  if (document->Error())
    return fail("is not XML", fmt::format("line {}", document->ErrorLineNum()),
                tinyxml2::XMLDocument::ErrorIDToName(document->ErrorID()));
  return document;
}

/// Actuators of all kinds share their defaults.
std::string kind_of(const XMLElement& element) {
  const std::string name = element.Name();
  constexpr std::array actuators{"general", "motor",  "position", "velocity", "intvelocity",
                                 "damper",  "muscle", "adhesion", "cylinder", "plugin"};
  if (std::find(actuators.begin(), actuators.end(), name) != actuators.end()) return "actuator";
  return name == "fixed" || name == "spatial" ? "tendon" : name;
}

std::string attribute(const XMLElement& element, const char* key, const std::string& otherwise) {
  const char* value = element.Attribute(key);
  return value ? value : otherwise;
}

}  // namespace

std::optional<std::string> MjcfElement::own(const char* key) const {
  const char* value = at->Attribute(key);
  return value ? std::optional<std::string>(value) : std::nullopt;
}

std::optional<std::string> MjcfElement::text(const char* key) const {
  if (auto written = own(key)) return written;
  if (!defaults) return std::nullopt;
  const auto found = defaults->find(key);
  return found == defaults->end() ? std::nullopt : std::optional<std::string>(found->second);
}

std::string MjcfElement::text_or(const char* key, const std::string& otherwise) const {
  return text(key).value_or(otherwise);
}

Expected<MjcfSource> MjcfSource::create(const std::string& text, const IncludeReader& includes) {
  auto document = xml_of(text);
  if (!document) return tl::unexpected(document.error());
  MjcfSource source;
  source.root_ = (*document)->FirstChildElement("mujoco");
  if (!source.root_) return fail("has no <mujoco>", {}, "the root of MJCF");
  source.documents_.push_back(std::move(*document));
  source.owner = "robot " + source.model();
  source.include_all(*source.root_, includes, 0);
  source.read_compiler();
  source.classes_[main_class];
  for (const XMLElement* each : source.children(*source.root_))
    if (std::string_view(each->Name()) == "default") source.read_defaults(*each, {});
  return source;
}

std::string MjcfSource::model() const {
  return attribute(*root_, "model", "hand");
}

void MjcfSource::include_all(const XMLElement& below, const IncludeReader& includes, int depth) {
  for (const XMLElement* e = below.FirstChildElement(); e; e = e->NextSiblingElement())
    if (std::string_view(e->Name()) == "include")
      include(*e, includes, depth);
    else
      include_all(*e, includes, depth);
}

void MjcfSource::include(const XMLElement& at, const IncludeReader& includes, int depth) {
  const std::string name = attribute(at, "file", "");
  const auto refuse = [&](const std::string& why) {
    complain(Severity::error, "missing-include", at, fmt::format("includes {}: {}", name, why),
             "put the file beside this one; each is included once");
  };
  if (name.empty() || !includes) return refuse("it cannot be read here");
  if (depth >= deepest_include || documents_.size() >= included_files)
    return refuse("files include each other without end");
  const auto text = includes(name);
  if (!text) return refuse(text.error().message());
  auto document = xml_of(*text);
  if (!document) return refuse(document.error().message());
  const XMLElement* root = (*document)->RootElement();
  if (!root) return refuse("it is empty");
  included_[&at] = root;
  files_[document->get()] = name;
  documents_.push_back(std::move(*document));
  include_all(*root, includes, depth + 1);
}

std::vector<const XMLElement*> MjcfSource::children(const XMLElement& of) const {
  std::vector<const XMLElement*> found;
  for (const XMLElement* e = of.FirstChildElement(); e; e = e->NextSiblingElement()) {
    if (std::string_view(e->Name()) != "include") {
      found.push_back(e);
    } else if (const auto file = included_.find(e); file != included_.end()) {
      const auto inside = children(*file->second);
      found.insert(found.end(), inside.begin(), inside.end());
    }
  }
  return found;
}

std::vector<const XMLElement*> MjcfSource::section(std::string_view name) const {
  std::vector<const XMLElement*> found;
  for (const XMLElement* each : children(*root_)) {
    if (each->Name() != name) continue;
    const auto inside = children(*each);
    found.insert(found.end(), inside.begin(), inside.end());
  }
  return found;
}

void MjcfSource::read_compiler() {
  compiler_.angle = std::numbers::pi / 180;
  for (const XMLElement* each : children(*root_)) {
    if (std::string_view(each->Name()) != "compiler") continue;
    if (const char* angle = each->Attribute("angle"))
      compiler_.angle = std::string_view(angle) == "radian" ? 1 : std::numbers::pi / 180;
    const std::string sequence = attribute(*each, "eulerseq", compiler_.euler);
    if (sequence.size() == 3 && sequence.find_first_not_of("xyzXYZ") == std::string::npos)
      compiler_.euler = sequence;
    else
      complain(Severity::error, "bad-number", *each,
               fmt::format("<compiler> has eulerseq=\"{}\"", sequence),
               "three of x, y, z, X, Y, Z");
    compiler_.mesh_folder = attribute(*each, "assetdir", compiler_.mesh_folder);
    compiler_.mesh_folder = attribute(*each, "meshdir", compiler_.mesh_folder);
    if (const char* limits = each->Attribute("autolimits"))
      compiler_.autolimits = std::string_view(limits) != "false";
    if (attribute(*each, "inertiafromgeom", "auto") == "true") compiler_.inertia_from_geoms = true;
    if (attribute(*each, "coordinate", "local") == "global")
      complain(Severity::error, "global-coordinates", *each, "places its bodies in the world",
               "save it with coordinate=\"local\": MuJoCo itself has given global ones up");
  }
}

void MjcfSource::read_defaults(const XMLElement& at, const std::string& above) {
  const std::string given = attribute(at, "class", main_class);
  const std::string name = above.empty() ? main_class : attribute(at, "class", "");
  if (name.empty())
    return complain(Severity::error, "no-name", at, "a <default> inside another has no class",
                    "give it one");
  if (!above.empty()) classes_[name] = classes_.at(above);
  const auto inside = children(at);
  for (const XMLElement* each : inside) {
    if (std::string_view(each->Name()) == "default") continue;
    MjcfAttributes& attributes = classes_[name][kind_of(*each)];
    for (const auto* a = each->FirstAttribute(); a; a = a->Next())
      attributes[a->Name()] = a->Value();
  }
  if (above.empty() && given != main_class) classes_[given] = classes_[main_class];
  for (const XMLElement* each : inside)
    if (std::string_view(each->Name()) == "default") read_defaults(*each, name);
}

MjcfElement MjcfSource::element(const XMLElement& at, const std::string& childclass) {
  const std::string name = attribute(at, "class", childclass.empty() ? main_class : childclass);
  auto found = classes_.find(name);
  if (found == classes_.end()) {
    complain(
        Severity::error, "unknown-class", at,
        fmt::format("<{}> is of the class {}, of which there is no <default>", at.Name(), name),
        "add the class, or spell it as its <default>");
    found = classes_.find(main_class);
  }
  const auto kind = found->second.find(kind_of(at));
  return {&at, kind == found->second.end() ? nullptr : &kind->second};
}

std::optional<std::vector<double>> MjcfSource::numbers(const MjcfElement& of, const char* key,
                                                       std::size_t least, std::size_t most) {
  const auto text = of.text(key);
  if (!text) return std::nullopt;
  auto found = finite_numbers(*text);
  if (found && found->size() >= least && found->size() <= most &&
      std::all_of(found->begin(), found->end(),
                  [](double x) { return std::abs(x) < largest_number; }))
    return found;
  const std::string count =
      least == most ? std::to_string(least) : fmt::format("{} to {}", least, most);
  complain(Severity::error, "bad-number", *of.at,
           fmt::format("<{}> has {}=\"{}\"", of.at->Name(), key, text->substr(0, 60)),
           fmt::format("{} finite number{}", count, most > 1 ? "s" : ""));
  return std::nullopt;
}

double MjcfSource::number(const MjcfElement& of, const char* key, double otherwise) {
  const auto found = numbers(of, key, 1, 1);
  return found ? (*found)[0] : otherwise;
}

Vector3d MjcfSource::vector(const MjcfElement& of, const char* key, const Vector3d& otherwise) {
  const auto found = numbers(of, key, 3, 3);
  return found ? Vector3d(found->data()) : otherwise;
}

Pose MjcfSource::pose(const MjcfElement& of) {
  return make_pose(vector(of, "pos", Vector3d::Zero()), orientation(of));
}

Eigen::Quaterniond MjcfSource::orientation(const MjcfElement& of) {
  using Eigen::AngleAxisd;
  using Eigen::Quaterniond;
  constexpr std::array keys{"quat", "axisangle", "xyaxes", "zaxis", "euler"};
  const Quaterniond none = Quaterniond::Identity();
  const auto written = [&](const char* key) { return of.own(key).has_value(); };
  const bool own = std::any_of(keys.begin(), keys.end(), written);
  for (const char* key : keys) {
    if (own ? !written(key) : !of.text(key)) continue;
    const std::string_view kind = key;
    const std::size_t count = kind == "xyaxes" ? 6 : kind == "zaxis" || kind == "euler" ? 3 : 4;
    const auto n = numbers(of, key, count, count);
    if (!n) return none;
    const Vector3d first(n->data());
    if (kind == "euler") {
      Quaterniond q = none;
      for (std::size_t i = 0; i < 3; ++i) {
        const char axis = compiler_.euler[i];
        const int k = (axis | 0x20) - 'x';
        const Quaterniond turn(AngleAxisd((*n)[i] * compiler_.angle, Vector3d::Unit(k)));
        q = axis >= 'x' ? q * turn : turn * q;  // small letters: about axes that turn along
      }
      return q;
    }
    if (kind == "quat") {
      const Quaterniond q((*n)[0], (*n)[1], (*n)[2], (*n)[3]);
      if (q.norm() > 1e-9) return q.normalized();
    } else if (kind == "axisangle" && first.norm() > 1e-9) {
      return Quaterniond(AngleAxisd((*n)[3] * compiler_.angle, first.normalized()));
    } else if (kind == "zaxis" && first.norm() > 1e-9) {
      return Quaterniond::FromTwoVectors(Vector3d::UnitZ(), first);
    } else if (kind == "xyaxes" && first.norm() > 1e-9) {
      Eigen::Matrix3d R;
      R.col(0) = first.normalized();
      const Vector3d y = Vector3d(n->data() + 3) - R.col(0).dot(Vector3d(n->data() + 3)) * R.col(0);
      R.col(1) = y.normalized();
      R.col(2) = R.col(0).cross(R.col(1));
      if (y.norm() > 1e-9) return Quaterniond(R);
    }
    complain(Severity::error, "bad-number", *of.at,
             fmt::format("<{}> has a {} without a direction", of.at->Name(), key),
             "give one that is not zero");
    return none;
  }
  return none;
}

void MjcfSource::complain(Severity severity, const char* code, const XMLElement& at,
                          std::string what, std::string repair) {
  complain(severity, code, owner, at, std::move(what), std::move(repair));
}

void MjcfSource::complain(Severity severity, const char* code, std::string element,
                          const XMLElement& at, std::string what, std::string repair) {
  if (const auto file = files_.find(at.GetDocument()); file != files_.end())
    element += " in " + file->second;
  findings.push_back(
      {severity, code, std::move(element), at.GetLineNum(), std::move(what), std::move(repair)});
}

}  // namespace prehend::planner
