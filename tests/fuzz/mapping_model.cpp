// Damaged mapping models: a broken seal is never accepted, and what a good seal holds is refused
// with a reason or answers with finite postures within the hand's limits.
#include <google/protobuf/stubs/logging.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "services/mapping/files/mapping_model_file.hpp"
#include "tests/fuzz/sealed.hpp"
#include "tests/support/hands.hpp"
#include "tests/support/models/random_model.hpp"

using namespace prehend;

namespace {

constexpr std::string_view kind = "mapping-model";

void require_sound(const mapping::MappingModel& model, const model::HandModel& hand) {
  const auto good = [&](const mapping::NetworkAnswer& answer) {
    fuzz::require(answer.dof.size() == static_cast<Eigen::Index>(hand.dofs().size()) &&
                      answer.dof.allFinite() && hand.clamp(answer.dof).isApprox(answer.dof, 1e-9),
                  "an answer that the hand cannot take");
  };
  for (const double value : {-1.0, 0.0, 0.05, 1e300}) {
    const mapping::Features asked = mapping::Features::Constant(value);
    good(model.direct(asked));
    (void)model.is_precision(asked);
    for (const auto shape : {model::ShapeKind::cylinder, model::ShapeKind::box})
      if (const auto known = model.intelligent(asked, {shape, {0.04, 0.05, 0.1}}, Pose::Identity()))
        good(*known);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const auto path = std::filesystem::temp_directory_path() /
                    ("fuzz-mapping-" + std::to_string(::getpid()) + ".mapping");
  google::protobuf::SetLogHandler(nullptr);  // it would report every broken name
  fuzz::Fuzzer fuzzer;
  fuzzer.long_round = 10000;
  for (const std::string& name : test::hand_names()) {
    const auto saved = mapping::save_mapping_model(path, test::random_model(test::hand(name), 1),
                                                   test::hand(name));
    fuzz::require(saved.has_value(), "no seed");
    fuzzer.seeds.push_back(fuzz::read_file(path.string()));
  }
  fuzzer.mutate = [](Random& random, std::string file) {
    return fuzz::mutate_sealed(random, kind, std::move(file));
  };
  fuzzer.target = [&](const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
    bool accepted = false;
    for (const std::string& name : test::hand_names()) {
      const auto model = mapping::load_mapping_model(path, test::hand(name));
      fuzz::require(model || !model.error().what.empty(), "refused without a reason");
      if (!model) continue;
      fuzz::require(!accepted, "accepted for two hands");
      accepted = true;
      fuzz::require_intact(bytes, kind);
      require_sound(*model, test::hand(name));
    }
    return accepted;
  };
  const int result = fuzz::run(fuzzer, argc, argv);
  std::filesystem::remove(path);
  return result;
}
