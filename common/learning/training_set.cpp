#include "common/learning/training_set.hpp"

#include <fmt/format.h>

#include <set>

#include "common/proto/pose_numbers.hpp"
#include "common/proto/sealed_file.hpp"
#include "common/proto/training_set.pb.h"
#include "common/proto/vectors.hpp"

namespace prehend::learning {

namespace {

constexpr std::string_view kind = "training-set";

}  // namespace

Expected<void> check(const TrainingSet& set) {
  if (set.hand.empty()) return fail("a training set names no hand");
  std::set<std::string> postures;
  for (std::size_t i = 0; i < set.pairs.size(); ++i) {
    const TrainingPair& pair = set.pairs[i];
    const std::string where = fmt::format("pair {} ({} of {})", i, pair.posture, pair.user);
    if (pair.dof.size() != static_cast<Eigen::Index>(set.dof_names.size()))
      return fail(
          fmt::format("{} DoF values for a hand of {}", pair.dof.size(), set.dof_names.size()),
          where);
    if (pair.features.size() == 0 || pair.features.size() != set.pairs.front().features.size())
      return fail(fmt::format("{} features", pair.features.size()), where);
    if (!pair.features.allFinite() || !pair.dof.allFinite() || !pair.size.allFinite() ||
        !is_finite(pair.X_OG))
      return fail("a number is not finite", where);
    postures.insert(pair.posture);
  }
  if (postures.size() < 2)
    return fail("a training set needs at least two different postures", set.hand);
  return {};
}

std::string serialise(const TrainingSet& set) {
  messages::TrainingSet message;
  message.set_hand(set.hand);
  message.set_scheme(set.scheme);
  for (const std::string& name : set.dof_names) message.add_dof_names(name);
  for (const TrainingPair& pair : set.pairs) {
    messages::TrainingPair& to = *message.add_pairs();
    to.mutable_features()->Add(pair.features.begin(), pair.features.end());
    to.mutable_dof()->Add(pair.dof.begin(), pair.dof.end());
    to.set_user(pair.user);
    to.set_take(pair.take);
    to.set_posture(pair.posture);
    to.set_object(pair.object);
    to.set_shape(pair.shape);
    to.mutable_size()->Add(pair.size.begin(), pair.size.end());
    to.set_source(pair.source);
    const auto X_OG = proto::pose_numbers(pair.X_OG);
    to.mutable_grasp_frame()->Add(X_OG.begin(), X_OG.end());
  }
  return message.SerializeAsString();
}

Expected<TrainingSet> parse_training_set(const std::string& bytes) {
  messages::TrainingSet message;
  if (!message.ParseFromString(bytes)) return fail("not a training set");
  TrainingSet set{message.hand(),
                  message.scheme(),
                  {message.dof_names().begin(), message.dof_names().end()},
                  {}};
  for (const messages::TrainingPair& from : message.pairs()) {
    if (from.size_size() != 3) return fail("an object's size is not three numbers");
    auto X_OG = proto::pose_from_numbers({from.grasp_frame().begin(), from.grasp_frame().end()});
    if (!X_OG) return tl::unexpected(X_OG.error());
    set.pairs.push_back({proto::to_vector(from.features()), proto::to_vector(from.dof()),
                         from.user(), from.take(), from.posture(), from.object(), from.shape(),
                         proto::to_vector(from.size()), from.source(), *X_OG});
  }
  if (auto ok = check(set); !ok) return tl::unexpected(ok.error());
  return set;
}

Expected<void> save(const std::filesystem::path& file, const TrainingSet& set) {
  return proto::write_sealed(file, kind, serialise(set));
}

Expected<TrainingSet> load_training_set(const std::filesystem::path& file) {
  auto bytes = proto::read_sealed(file, kind);
  if (!bytes) return tl::unexpected(bytes.error());
  return parse_training_set(*bytes);
}

}  // namespace prehend::learning
