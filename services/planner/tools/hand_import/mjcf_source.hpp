#pragma once

#include <tinyxml2.h>

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/planner/tools/hand_import/mjcf.hpp"

namespace prehend::planner {

using MjcfAttributes = std::map<std::string, std::string>;

/// An element and what the class of defaults that it belongs to says of its kind.
struct MjcfElement {
  const tinyxml2::XMLElement* at = nullptr;
  const MjcfAttributes* defaults = nullptr;  // none: nothing

  std::optional<std::string> own(const char* key) const;   // as written
  std::optional<std::string> text(const char* key) const;  // as written, or the default
  std::string text_or(const char* key, const std::string& otherwise) const;
};

/// <compiler>, of all sections of that name.
struct MjcfCompiler {
  double angle = 1;  // rad of a unit
  std::string euler = "xyz", mesh_folder;
  bool autolimits = true, inertia_from_geoms = false;
};

/// MJCF with its includes, its classes of defaults and its <compiler>. Collects findings.
class MjcfSource {
 public:
  static Expected<MjcfSource> create(const std::string& text, const IncludeReader& includes);

  /// Elements below another; those of an included file stand where its <include> stands.
  std::vector<const tinyxml2::XMLElement*> children(const tinyxml2::XMLElement& of) const;
  /// Elements below all sections of a name, such as worldbody.
  std::vector<const tinyxml2::XMLElement*> section(std::string_view name) const;

  const MjcfCompiler& compiler() const { return compiler_; }
  std::string model() const;

  /// With the defaults of its class="…", else of `childclass`, else of all.
  MjcfElement element(const tinyxml2::XMLElement& at, const std::string& childclass = {});

  /// Between `least` and `most` numbers of an attribute; none if it is absent or wrong, which is a
  /// finding then.
  std::optional<std::vector<double>> numbers(const MjcfElement& of, const char* key,
                                             std::size_t least, std::size_t most);
  double number(const MjcfElement& of, const char* key, double otherwise);
  Eigen::Vector3d vector(const MjcfElement& of, const char* key, const Eigen::Vector3d& otherwise);
  /// pos and quat, euler, axisangle, xyaxes or zaxis.
  Pose pose(const MjcfElement& of);

  void complain(Severity severity, const char* code, const tinyxml2::XMLElement& at,
                std::string what, std::string repair);
  void complain(Severity severity, const char* code, std::string element,
                const tinyxml2::XMLElement& at, std::string what, std::string repair);

  std::string owner;  // «link f1»: what is being read
  std::vector<UrdfFinding> findings;

 private:
  using Document = std::unique_ptr<tinyxml2::XMLDocument>;

  void include_all(const tinyxml2::XMLElement& below, const IncludeReader& includes, int depth);
  void include(const tinyxml2::XMLElement& at, const IncludeReader& includes, int depth);
  void read_compiler();
  void read_defaults(const tinyxml2::XMLElement& at, const std::string& above);
  Eigen::Quaterniond orientation(const MjcfElement& of);

  const tinyxml2::XMLElement* root_ = nullptr;
  std::vector<Document> documents_;
  std::map<const tinyxml2::XMLElement*, const tinyxml2::XMLElement*> included_;  // roots
  std::map<const tinyxml2::XMLDocument*, std::string> files_;                    // names
  MjcfCompiler compiler_;
  std::map<std::string, std::map<std::string, MjcfAttributes>> classes_;  // by class and kind
};

}  // namespace prehend::planner
