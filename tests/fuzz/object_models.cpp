// Damaged object models: a broken seal is never accepted, and what a good seal holds is refused
// with a reason or answers with finite scores and probabilities.
#include <google/protobuf/stubs/logging.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "services/recognition/core/learning/training.hpp"
#include "services/recognition/files/model_file.hpp"
#include "tests/fuzz/sealed.hpp"

using namespace prehend;
using namespace prehend::recognition;

namespace {

constexpr std::string_view kind = "object-models";

/// Two colours in turn, with noise.
TrainingView view(int colour, Random& random) {
  TrainingView made{Picture(24, 24), Plane(24, 24, 1)};
  for (std::size_t i = 0; i < made.picture.rgb.size(); ++i)
    made.picture.rgb[i] = static_cast<std::uint8_t>(
        random.index(60) + (i % 3 == static_cast<std::size_t>(colour) ? 150 : 30));
  return made;
}

void require_sound(const ObjectModels& models) {
  Random random(1);
  const TrainingView seen = view(1, random);
  for (const bool learned : {true, false}) {
    const Classification answer = classify(
        models, describe(models, models.palette.quantise(seen.picture), seen.mask), learned);
    fuzz::require(answer.probability >= 0 && answer.probability <= 1, "no probability");
    fuzz::require(answer.best < static_cast<int>(models.classes.size()), "no class");
  }
}

}  // namespace

int main(int argc, char** argv) {
  const auto path = std::filesystem::temp_directory_path() /
                    ("fuzz-objects-" + std::to_string(::getpid()) + ".model");
  google::protobuf::SetLogHandler(nullptr);  // it would report every broken name
  fuzz::Fuzzer fuzzer;
  fuzzer.long_round = 10000;
  Random random(1);
  std::vector<TrainingClass> classes;
  for (int c = 0; c < 3; ++c) {
    classes.push_back({"class " + std::to_string(c), {}});
    for (int i = 0; i < 4; ++i) classes.back().views.push_back(view(c, random));
  }
  for (const DescriptorOptions& suited : {DescriptorOptions(), photos_of_objects()}) {
    DescriptorOptions options = suited;
    options.colours = 10;
    options.coarse_colours = 5;
    const auto models = train(classes, options);
    fuzz::require(models && save_models(path, *models), "no seed");
    fuzzer.seeds.push_back(fuzz::read_file(path.string()));
  }
  fuzzer.mutate = [](Random& draw, std::string file) {
    return fuzz::mutate_sealed(draw, kind, std::move(file));
  };
  fuzzer.target = [&](const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
    const auto models = load_models(path);
    fuzz::require(models || !models.error().what.empty(), "refused without a reason");
    if (!models) return false;
    fuzz::require_intact(bytes, kind);
    require_sound(*models);
    return true;
  };
  const int result = fuzz::run(fuzzer, argc, argv);
  std::filesystem::remove(path);
  return result;
}
