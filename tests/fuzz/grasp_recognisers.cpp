// Damaged recognisers of grasps: a broken seal is never accepted, and what a good seal holds is
// refused with a reason or answers every hand with probabilities.
#include <google/protobuf/stubs/logging.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "services/demonstration/files/recogniser_file.hpp"
#include "services/demonstration/tools/training/trainer.hpp"
#include "tests/fuzz/sealed.hpp"
#include "tests/support/takes/made_takes.hpp"

using namespace prehend;
using namespace prehend::demonstration;

int main(int argc, char** argv) {
  const auto path = std::filesystem::temp_directory_path() /
                    ("fuzz-grasps-" + std::to_string(::getpid()) + ".model");
  google::protobuf::SetLogHandler(nullptr);  // it would report every broken name
  fuzz::Fuzzer fuzzer;
  fuzzer.long_round = 10000;
  const auto takes = test::made_takes({.people = 2, .trials = 1, .samples = 4});
  std::vector<const Take*> shown;
  for (const Take& take : takes) shown.push_back(&take);
  for (const Method method : methods) {
    const auto made = train_recognisers(shown, {method}, {.folds = 2, .hidden = 2, .epochs = 5});
    fuzz::require(made && save_recognisers(path, {{"1", made->front(), 2, 6}}), "no seed");
    fuzzer.seeds.push_back(fuzz::read_file(path.string()));
  }
  fuzzer.mutate = [](Random& random, std::string file) {
    return fuzz::mutate_sealed(random, "grasp-recogniser", std::move(file));
  };
  fuzzer.target = [&](const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
    const auto read = load_recognisers(path);
    fuzz::require(read || !read.error().what.empty(), "refused without a reason");
    if (!read) return false;
    fuzz::require_intact(bytes, "grasp-recogniser");
    for (const TaskRecogniser& one : *read)
      for (const Take& take : takes) {
        const Distribution p = one.recogniser.recognise(take.samples);
        fuzz::require(p.allFinite() && std::abs(p.sum() - 1) < 1e-9, "no probabilities");
      }
    return true;
  };
  const int result = fuzz::run(fuzzer, argc, argv);
  std::filesystem::remove(path);
  return result;
}
