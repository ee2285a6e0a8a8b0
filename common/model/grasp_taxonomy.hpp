#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/named_values.hpp"
#include "common/model/human_hand.hpp"
#include "common/model/shape.hpp"

namespace prehend::model {

enum class GraspKind { power, precision };
enum class GraspForm { prismatic, circular, flat };
enum class Opposition { palm, pad, side };
enum class ThumbPlace { abducted, adducted, free };
enum class Approach { side, above };
/// What of an object a hand may lie on.
enum class ObjectPart { opening, handle, blade };

inline constexpr auto grasp_kinds =
    named_values<GraspKind>({{GraspKind::power, "power"}, {GraspKind::precision, "precision"}});
inline constexpr auto grasp_forms = named_values<GraspForm>({{GraspForm::prismatic, "prismatic"},
                                                             {GraspForm::circular, "circular"},
                                                             {GraspForm::flat, "flat"}});
inline constexpr auto oppositions = named_values<Opposition>(
    {{Opposition::palm, "palm"}, {Opposition::pad, "pad"}, {Opposition::side, "side"}});
inline constexpr auto thumb_places = named_values<ThumbPlace>({{ThumbPlace::abducted, "abducted"},
                                                               {ThumbPlace::adducted, "adducted"},
                                                               {ThumbPlace::free, "free"}});
inline constexpr auto approaches =
    named_values<Approach>({{Approach::side, "side"}, {Approach::above, "above"}});
inline constexpr auto object_parts = named_values<ObjectPart>({{ObjectPart::opening, "opening"},
                                                               {ObjectPart::handle, "handle"},
                                                               {ObjectPart::blade, "blade"}});

/// A kind of human grasp.
struct GraspClass {
  std::string name;
  int feix = 0;  // number among the 33 of [Feix2016]
  GraspKind kind{};
  GraspForm form{};
  Opposition opposition{};
  std::vector<Finger> opposed;  // by the thumb or the palm
  ThumbPlace thumb{};
  Approach approach{};                  // where the palm usually comes from
  std::vector<ObjectPart> blocks;       // what the hand then lies on
  std::vector<ShapeKind> shapes;        // that are grasped so
  double min_width = 0, max_width = 0;  // m, of what is between the fingers
  std::string robot;                    // type of grasp of our robot hands

  bool blocked(ObjectPart part) const;
};

/// Cutkosky's sixteen kinds of grasps [Cutkosky1989], from models/grasps/taxonomy.toml.
class GraspTaxonomy {
 public:
  static Expected<GraspTaxonomy> load(const std::filesystem::path& file);
  static Expected<GraspTaxonomy> parse(std::string_view toml);
  /// The one that comes with us.
  static Expected<GraspTaxonomy> of_the_house();

  const std::vector<GraspClass>& classes() const { return classes_; }
  /// nullptr if there is none of that name.
  const GraspClass* find(std::string_view name) const;
  /// What this robot hand does instead of a human grasp: the class's type, or another one if the
  /// hand has not that.
  const std::string& robot_type(const GraspClass& grasp, const std::string& hand) const;

  /// How plausible each class is for an object, 0 to 1, in order of classes(): 1 for a shape that
  /// is grasped so and a width within the class's range, less the farther outside (half an octave:
  /// 0.6, one: 0.14). Of an unknown shape everything is possible.
  std::vector<double> fit_to_object(const Shape& shape) const;
  /// 0 for classes that lie on what a task needs, 1 for the others.
  std::vector<double> fit_to_task(const std::vector<ObjectPart>& needed) const;

 private:
  std::vector<GraspClass> classes_;
  std::map<std::string, std::map<std::string, std::string>> instead_;  // hand, type: type
};

}  // namespace prehend::model
