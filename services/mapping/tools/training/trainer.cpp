#include "services/mapping/tools/training/trainer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <numeric>
#include <set>
#include <utility>

#include "common/grasping/table_closing.hpp"
#include "common/proto/sealed_file.hpp"
#include "services/mapping/tools/training/network_training.hpp"

namespace prehend::mapping {

namespace {

/// What a network of this shape is told beside the features; nothing if the shape is unknown.
Eigen::VectorXd told(const learning::TrainingPair& pair, model::ShapeKind shape, SizeInput input) {
  if (shape == model::ShapeKind::unknown) return {};
  return size_numbers(input, {shape, pair.size}, pair.X_OG);
}

/// Columns of inputs and outputs, unscaled. unknown: all pairs, nine inputs; else that shape's
/// pairs with the object's size. Pairs shown without an object belong to each of that shape.
learning::Samples columns(const learning::TrainingSet& set, model::ShapeKind shape,
                          SizeInput input) {
  const auto less = [](const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  std::set<Eigen::VectorXd, decltype(less)> objects(less);
  for (const learning::TrainingPair& pair : set.pairs)
    if (pair.shape == model::to_string(shape)) objects.insert(told(pair, shape, input));
  if (shape == model::ShapeKind::unknown) objects.insert(Eigen::VectorXd());

  std::vector<std::pair<const learning::TrainingPair*, Eigen::VectorXd>> used;
  for (const learning::TrainingPair& pair : set.pairs) {
    if (shape == model::ShapeKind::unknown || pair.shape == model::to_string(shape))
      used.emplace_back(&pair, told(pair, shape, input));
    else if (pair.shape.empty())
      for (const Eigen::VectorXd& object : objects) used.emplace_back(&pair, object);
  }
  const auto count = static_cast<Eigen::Index>(used.size());
  const Eigen::Index sizes = shape == model::ShapeKind::unknown ? 0 : size_count(input, shape);
  learning::Samples samples{Eigen::MatrixXd(feature_count + sizes, count),
                            Eigen::MatrixXd(set.dof_names.size(), count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto& [pair, object] = used[static_cast<std::size_t>(k)];
    samples.inputs.col(k) << pair->features, object;
    samples.outputs.col(k) = pair->dof;
  }
  return samples;
}

/// Seeds of people must not meet those of other sets' people.
std::uint64_t seed_of(const SetOptions& options, int person) {
  return options.seed * 1000003 + static_cast<std::uint64_t>(person);
}

/// So many of the numbers below `count`, or all, in rising order.
std::vector<std::size_t> drawn(std::size_t count, int wanted, Random& random) {
  std::vector<std::size_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), std::size_t{0});
  while (numbers.size() > static_cast<std::size_t>(wanted))
    numbers.erase(numbers.begin() + static_cast<std::ptrdiff_t>(random.index(numbers.size())));
  return numbers;
}

/// Name of pairs between the open hand and a posture.
const std::string on_the_way_to = "on the way to ";

Expected<MappingNetwork> network_of(const Sets& sets, model::ShapeKind shape,
                                    const TrainerOptions& options,
                                    const std::function<void(double)>& progress) {
  const auto samples = [&](const learning::TrainingSet& set) {
    return columns(set, shape, options.size_input);
  };
  return train_network({samples(sets.training), samples(sets.validation), samples(sets.test)},
                       shape, options.scaling, options.network, progress);
}

/// What one person shows in one take: pairs of postures, and of others on the way to them.
class Take {
 public:
  Take(Demonstrator& demonstrator, const SchemePosture& open, int on_the_way, Random& random,
       learning::TrainingSet& set)
      : demonstrator_(demonstrator),
        open_(open),
        on_the_way_(on_the_way),
        random_(random),
        set_(set) {}

  /// What all pairs of the take, or of an object, have in common.
  learning::TrainingPair pair;

  /// resting: of the hand, in this posture; the open one rests fully. A hand that reaches gets
  /// ready on the way, half of the people's before the fingers close, others' while they do.
  void show(std::string_view name, const Closure& human, double splay, double resting,
            const Eigen::VectorXd& robot, double complete, bool reaching) {
    constexpr double on_the_reach = 0.5;  // of the time in which the fingers close
    pair.posture = name;
    pair.features = demonstrator_.read(human, splay, resting);
    pair.dof = robot;
    set_.pairs.push_back(pair);
    for (int i = 0; i < on_the_way_; ++i) {
      const double phase = random_.uniform(reaching ? -on_the_reach : 0.0, 1.0);
      const double share = std::max(0.0, phase);
      const double ready = reaching ? std::max(0.0, random_.uniform(-1, 1)) : 0;
      const double rest = reaching ? std::clamp((ready - phase) / (ready + on_the_reach), 0.0, 1.0)
                                   : 1 + share * (resting - 1);
      Closure part{};
      for (std::size_t f = 0; f < part.size(); ++f)
        part[f] = open_.human[f] + complete * share * (human[f] - open_.human[f]);
      pair.posture = on_the_way_to + std::string(name);
      pair.features = demonstrator_.read(part, open_.splay + share * (splay - open_.splay), rest);
      pair.dof = open_.robot + share * (robot - open_.robot);
      set_.pairs.push_back(pair);
    }
  }

 private:
  Demonstrator& demonstrator_;
  const SchemePosture& open_;
  int on_the_way_;
  Random& random_;
  learning::TrainingSet& set_;
};

}  // namespace

learning::TrainingSet demonstrate(const model::HandModel& hand, const Scheme& scheme,
                                  const std::vector<RobotGrasp>& grasps,
                                  const SetOptions& options) {
  learning::TrainingSet set;
  set.hand = hand.name();
  set.scheme = scheme.name;
  for (const model::HandDof& dof : hand.dofs()) set.dof_names.push_back(dof.name);

  const std::vector<SchemePosture> postures = scheme.posture_set(options.postures);
  const SchemePosture& open = scheme.open;
  const bool spread_says =
      std::any_of(scheme.closed.begin(), scheme.closed.end(),
                  [&](const SchemePosture& closed) { return closed.splay != open.splay; });
  for (int person = 0; person < options.users; ++person) {
    const std::uint64_t seed = seed_of(options, person);
    Demonstrator demonstrator(fmt::format("person {}-{}", options.seed, person), seed,
                              options.demonstrator);
    Random random(seed ^ 0x5eed);
    for (int take = 0; take < options.takes; ++take) {
      demonstrator.new_take();
      Take shown(demonstrator, open, options.on_the_way, random, set);
      shown.pair.user = demonstrator.user();
      shown.pair.take = static_cast<unsigned>(take);
      shown.pair.source = "synthetic";
      const auto show_posture = [&](const SchemePosture& posture) {
        demonstrator.rest(!spread_says);
        shown.show(posture.name, demonstrator.repeat(posture.human), posture.splay,
                   1 - posture.human.front(), posture.robot, 1.0, false);
      };
      if (grasps.empty())
        for (const SchemePosture& posture : postures) show_posture(posture);
      for (const std::size_t g : drawn(grasps.size(), options.grasps, random)) {
        const RobotGrasp& grasp = grasps[g];
        shown.pair.object = grasp.object;
        shown.pair.shape = model::to_string(grasp.shape.kind);
        shown.pair.size = grasp.shape.size;
        shown.pair.X_OG = grasp.X_OG;
        for (int i = 0; i < options.beside; ++i)
          show_posture(postures[random.index(postures.size())]);
        demonstrator.rest(!spread_says);
        // None: this person's hand does not fit around it.
        if (const auto human = demonstrator.reach(grasp.shape, grasp.X_OG, grasp.type))
          shown.show(to_string(grasp.type), human->closure, open.splay, 0.0,
                     past_contact(hand, grasp, open.robot, options.past_contact), options.complete,
                     true);
      }
    }
  }
  return set;
}

Eigen::VectorXd precision_discriminant(const model::Catalogue& catalogue, const model::Reach& reach,
                                       const SetOptions& options) {
  std::array<std::vector<Features>, 2> classes;  // circular sphere, precision
  for (int person = 0; person < options.users; ++person) {
    Demonstrator demonstrator("", seed_of(options, person), options.demonstrator);
    for (const model::CatalogueObject& object : catalogue.objects())
      for (const Pose& X_OG : grasping::approaches(object.shape, reach))
        for (const GraspType type : types_from(X_OG)) {
          if (type == GraspType::power_wrap) continue;
          if (const auto grasp = demonstrator.reach(object.shape, X_OG, type))
            classes[type == GraspType::precision ? 1 : 0].push_back(
                demonstrator.read(grasp->closure));
        }
  }
  if (classes[0].empty() || classes[1].empty()) return {};
  using Row = Eigen::Matrix<double, feature_count + 1, 1>;
  Eigen::Matrix<double, feature_count + 1, feature_count + 1> squares;
  squares.setZero();
  Row sums = Row::Zero();
  for (std::size_t i = 0; i < classes.size(); ++i)
    for (const Features& features : classes[i]) {
      Row x;
      x << features, 1.0;
      const double weight = 1.0 / static_cast<double>(classes[i].size());
      squares += weight * x * x.transpose();
      sums += weight * (i == 1 ? 1.0 : -1.0) * x;
    }
  // Few people may not span all features: a little ridge beside their spread of centimetres.
  squares.diagonal().head<feature_count>().array() += 1e-6;
  return squares.ldlt().solve(sums);
}

std::vector<PalmOffset> palm_offsets(const std::vector<RobotGrasp>& grasps) {
  std::vector<PalmOffset> places;
  for (const RobotGrasp& grasp : grasps)
    if (grasp.held)
      places.push_back(
          {grasp.shape.kind, size_numbers(SizeInput::seen, grasp.shape, grasp.X_OG), grasp.p_GR});
  return places;
}

Expected<MappingModel> train_mapping(const model::HandModel& hand, const Scheme& scheme,
                                     const Sets& sets, const TrainerOptions& options,
                                     const grasping::ForEach& for_each, const Progress& progress) {
  for (const learning::TrainingSet* set : {&sets.training, &sets.validation, &sets.test}) {
    if (auto ok = learning::check(*set); !ok) return tl::unexpected(ok.error());
    if (set->hand != hand.name())
      return fail(fmt::format("a training set for the hand «{}»", set->hand), hand.name());
    if (set->pairs.front().features.size() != feature_count)
      return fail("a training set with other features", hand.name());
  }
  std::vector<model::ShapeKind> kinds{model::ShapeKind::unknown};
  for (const auto kind :
       {model::ShapeKind::cylinder, model::ShapeKind::box, model::ShapeKind::sphere})
    if (std::any_of(sets.training.pairs.begin(), sets.training.pairs.end(),
                    [&](const auto& pair) { return pair.shape == model::to_string(kind); }))
      kinds.push_back(kind);

  std::vector<Expected<MappingNetwork>> trained(kinds.size(), fail("not trained"));
  std::vector<double> shares(kinds.size());
  std::mutex mutex;  // of the shares
  for_each(kinds.size(), [&](std::size_t i) {
    trained[i] = network_of(sets, kinds[i], options, [&](double share) {
      const std::lock_guard lock(mutex);
      shares[i] = share;
      progress("training", std::accumulate(shares.begin(), shares.end(), 0.0) /
                               static_cast<double>(shares.size()));
    });
  });
  std::vector<MappingNetwork> networks;
  for (auto& network : trained) {
    if (!network) return tl::unexpected(network.error());
    networks.push_back(std::move(*network));
  }
  ModelTraits traits{scheme.name,        proto::digest(learning::serialise(sets.training)),
                     options.size_input, scheme.lower,
                     scheme.upper,       options.precision,
                     options.places,     options.made_for,
                     options.closing};
  return MappingModel::create(hand, std::move(traits), std::move(networks));
}

Comparison compare(const MappingModel& model, const learning::TrainingSet& set,
                   model::ShapeKind shape, bool grasps_only) {
  Comparison result;
  for (const learning::TrainingPair& pair : set.pairs) {
    if (pair.shape != model::to_string(shape)) continue;
    if (grasps_only && !grasp_type_from_string(pair.posture)) continue;
    const Features features = pair.features;
    const auto known = model.intelligent(features, {shape, pair.size}, pair.X_OG);
    if (!known) continue;
    result.direct += (model.direct(features).dof - pair.dof).squaredNorm();
    result.intelligent += (known->dof - pair.dof).squaredNorm();
    ++result.pairs;
  }
  if (result.pairs > 0) {
    result.direct /= result.pairs;
    result.intelligent /= result.pairs;
  }
  return result;
}

}  // namespace prehend::mapping
