// Damaged training sets: a broken seal is never accepted, and what a good seal holds is refused
// with a reason or is a set that training can rely on and that comes back from its own file.
#include "common/learning/training_set.hpp"

#include <google/protobuf/stubs/logging.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/fuzz/sealed.hpp"

using namespace prehend;

namespace {

constexpr std::string_view kind = "training-set";

learning::TrainingSet some_set(std::uint64_t seed, int pairs) {
  Random random(seed);
  learning::TrainingSet set{"barrett", "a scheme", {"spread", "finger 1", "finger 2"}, {}};
  for (int i = 0; i < pairs; ++i) {
    learning::TrainingPair pair;
    pair.features = Eigen::VectorXd::NullaryExpr(9, [&] { return random.normal(0.1); });
    pair.dof = Eigen::VectorXd::NullaryExpr(3, [&] { return random.uniform(); });
    pair.user = "user " + std::to_string(i / 4);
    pair.take = static_cast<unsigned>(i % 3);
    pair.posture = i % 2 == 0 ? "open" : "precision";
    if (i % 2 == 1) pair.object = "Cup", pair.shape = "cylinder", pair.size = {0.03, 0.03, 0.09};
    pair.source = "synthetic";
    pair.X_OG.translation() = random.normal3(0.1);
    set.pairs.push_back(pair);
  }
  return set;
}

}  // namespace

int main(int argc, char** argv) {
  const auto path = std::filesystem::temp_directory_path() /
                    ("fuzz-training-" + std::to_string(::getpid()) + ".set");
  google::protobuf::SetLogHandler(nullptr);  // it would report every broken name
  fuzz::Fuzzer fuzzer;
  fuzzer.long_round = 10000;
  for (const int pairs : {2, 12, 60}) {
    fuzz::require(learning::save(path, some_set(1, pairs)).has_value(), "no seed");
    fuzzer.seeds.push_back(fuzz::read_file(path.string()));
  }
  fuzzer.mutate = [](Random& random, std::string file) {
    return fuzz::mutate_sealed(random, kind, std::move(file));
  };
  fuzzer.target = [&](const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
    const auto set = learning::load_training_set(path);
    fuzz::require(set || !set.error().what.empty(), "refused without a reason");
    if (!set) return false;
    fuzz::require_intact(bytes, kind);
    fuzz::require(learning::check(*set).has_value(), "accepted, and yet not good");
    const std::string again = learning::serialise(*set);
    const auto back = learning::parse_training_set(again);
    fuzz::require(back && learning::serialise(*back) == again, "does not come back");
    return true;
  };
  const int result = fuzz::run(fuzzer, argc, argv);
  std::filesystem::remove(path);
  return result;
}
