#include "services/mapping/tools/training/closing_lessons.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "common/grasping/table_closing.hpp"
#include "services/mapping/core/size_input.hpp"
#include "services/mapping/tools/training/network_training.hpp"
#include "services/mapping/tools/training/robot_grasps.hpp"

namespace prehend::mapping {
namespace {

model::Shape drawn_shape(Random& random) {
  constexpr std::array kinds{model::ShapeKind::cylinder, model::ShapeKind::box,
                             model::ShapeKind::sphere};
  const model::ShapeKind kind = kinds[random.index(kinds.size())];
  const double a = random.uniform(0.008, 0.048), height = random.uniform(0.06, 0.26);
  const double depth = random.uniform(0.015, 0.095), length = random.uniform(0.02, 0.2);
  if (kind == model::ShapeKind::cylinder) return {kind, {a, a, height}};
  if (kind == model::ShapeKind::box) return {kind, {depth, length, height}};
  return {kind, Eigen::Vector3d::Constant(std::max(a, 0.02))};
}

struct Lesson {
  Features features;
  Eigen::VectorXd seen;
  double share = 0;
};

/// Some moments of one closing: as far as `share` says, as Take::show of trainer.cpp has it.
void show(Demonstrator& person, const Closure& closed, const Eigen::VectorXd& seen,
          const ClosingLessonOptions& options, Random& random, std::vector<Lesson>& lessons) {
  person.rest();
  for (int i = 0; i < options.moments; ++i) {
    const double way = i == 0 ? 1.0 : random.uniform();
    // A hand at rest gets ready while it reaches, or while it closes.
    const double resting = random.uniform() < 0.5 ? 0.0 : std::max(0.0, 1 - 2 * way);
    Closure part{};
    for (std::size_t f = 0; f < part.size(); ++f) part[f] = way * closed[f];
    lessons.push_back({person.read(part, 0, resting), seen, std::min(1.0, way / options.complete)});
  }
}

}  // namespace

learning::Samples closing_lessons(const ClosingLessonOptions& options) {
  std::vector<Lesson> lessons;
  for (int number = 0; number < options.people; ++number) {
    const std::uint64_t seed = options.seed * 1000003 + static_cast<std::uint64_t>(number);
    Demonstrator person("", seed, options.demonstrator);
    Random random(seed ^ 0xc105e);
    for (int thing = 0; thing < options.things; ++thing) {
      const model::Shape shape = drawn_shape(random);
      const auto ways = grasping::approaches(shape, model::Reach{});
      if (ways.empty()) continue;
      const Pose X_OG = ways[random.index(ways.size())];
      const auto types = types_from(X_OG);
      const auto taken = person.reach(shape, X_OG, types[random.index(types.size())]);
      // None: this person's hand does not fit around it.
      if (!taken) continue;
      show(person, taken->closure, size_numbers(SizeInput::seen, shape, X_OG), options, random,
           lessons);
    }
  }
  const auto count = static_cast<Eigen::Index>(lessons.size());
  const int sizes = size_count(SizeInput::seen, model::ShapeKind::unknown);
  learning::Samples samples{Eigen::MatrixXd(feature_count + sizes, count),
                            Eigen::MatrixXd(1, count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    const Lesson& lesson = lessons[static_cast<std::size_t>(k)];
    samples.inputs.col(k) << lesson.features, lesson.seen;
    samples.outputs(0, k) = lesson.share;
  }
  return samples;
}

Expected<MappingNetwork> train_closing(const ClosingLessonOptions& options,
                                       const learning::TrainingOptions& network) {
  const auto lessons_of = [&](std::uint64_t others, int share) {
    ClosingLessonOptions people = options;
    people.seed += others;
    people.people = std::max(1, options.people / share);
    return closing_lessons(people);
  };
  return train_network({lessons_of(0, 1), lessons_of(1, 4), lessons_of(2, 4)},
                       model::ShapeKind::unknown, learning::ScalingKind::each_feature, network);
}

}  // namespace prehend::mapping
