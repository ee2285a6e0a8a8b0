#include "services/mapping/tools/training/closing_lessons.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "common/grasping/table_closing.hpp"
#include "services/mapping/core/size_input.hpp"
#include "services/mapping/tools/training/robot_grasps.hpp"

namespace prehend::mapping {
namespace {

constexpr double share_margin = 0.1;  // beside the range, so that the sigmoid reaches its ends

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
  std::array<learning::Samples, 3> sets;  // to learn from, to end by, to judge by
  for (std::size_t i = 0; i < sets.size(); ++i) {
    ClosingLessonOptions people = options;
    people.seed += i;
    if (i > 0) people.people = std::max(1, options.people / 4);
    sets[i] = closing_lessons(people);
  }
  auto input = learning::Scaling::fit(sets[0].inputs, learning::ScalingKind::each_feature);
  if (!input) return tl::unexpected(input.error());
  auto output =
      learning::Scaling::fit(sets[0].outputs, learning::ScalingKind::each_feature, share_margin);
  if (!output) return tl::unexpected(output.error());
  const auto scaled = [&](const learning::Samples& samples) {
    learning::Samples made = samples;
    for (Eigen::Index k = 0; k < made.inputs.cols(); ++k) {
      made.inputs.col(k) = input->to_unit(samples.inputs.col(k));
      made.outputs.col(k) = output->to_unit(samples.outputs.col(k));
    }
    return made;
  };
  auto best = learning::train(scaled(sets[0]), scaled(sets[1]), network);
  if (!best) return tl::unexpected(best.error());
  MappingNetwork made{model::ShapeKind::unknown,
                      std::move(best->network),
                      std::move(*input),
                      std::move(*output),
                      {}};
  const auto error = [&](const learning::Samples& samples) {
    double sum = 0;
    for (Eigen::Index k = 0; k < samples.inputs.cols(); ++k)
      sum +=
          (made.output.from_unit(made.network.evaluate(made.input.to_unit(samples.inputs.col(k)))) -
           samples.outputs.col(k))
              .squaredNorm();
    return sum / static_cast<double>(std::max<Eigen::Index>(samples.inputs.cols(), 1));
  };
  made.errors = {error(sets[0]), error(sets[1]), error(sets[2])};
  return made;
}

}  // namespace prehend::mapping
