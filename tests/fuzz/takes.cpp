// Damaged tables of takes: one reason on one line, or takes whose numbers are known and within
// reach, or unknown, and in order of time.
#include <cmath>

#include "services/demonstration/files/takes_file.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"
#include "tests/support/takes/made_takes.hpp"

using namespace prehend;
using namespace prehend::demonstration;

namespace {

void require_line(const Error& error) {
  fuzz::require(!error.what.empty() && !error.where.empty() && !error.hint.empty(),
                "not what, where and what to do");
  fuzz::require(error.message().find('\n') == std::string::npos, "more than one line");
}

void require_sound(const Take& take) {
  fuzz::require(!take.samples.empty() && !take.user.empty() && !take.label.empty(), "no take");
  fuzz::require(!take.object || model::is_valid(*take.object), "no object");
  double t = take.samples.front().t;
  for (const HandSample& sample : take.samples) {
    fuzz::require(std::isfinite(sample.t) && sample.t >= t, "samples are not in order of time");
    t = sample.t;
    for (const auto& tip : sample.p_thumb_tip_W)
      for (const double x : tip)
        fuzz::require(std::isnan(x) || std::abs(x) <= 0.5, "a finger out of reach");
    fuzz::require(!(std::abs(sample.hand_speed) > 50), "faster than a hand");
  }
}

}  // namespace

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  for (const std::uint64_t seed : {1, 2, 3}) {
    auto takes = test::made_takes({.people = 2, .trials = 1, .samples = 3, .seed = seed});
    fuzzer.seeds.push_back(test::to_csv(takes));
    for (Take& take : takes)
      take.object = model::Shape{model::ShapeKind::cylinder, {0.015, 0.015, 0.12}};
    fuzzer.seeds.push_back(takes_csv(takes));
  }
  fuzzer.long_round = 100'000;
  fuzzer.mutate = [](Random& random, std::string text) {
    return random.index(2) == 0 ? fuzz::mutate_bytes(random, std::move(text))
                                : fuzz::mutate_number(random, std::move(text));
  };
  fuzzer.target = [](const std::string& text) {
    const auto takes = parse_takes(text, "task1.csv", "1");
    if (!takes) {
      require_line(takes.error());
      return false;
    }
    fuzz::require(takes->complaints.size() <= 1, "more than one line for a file");
    for (const Error& complaint : takes->complaints) require_line(complaint);
    std::size_t samples = 0;
    for (const Take& take : takes->takes) {
      require_sound(take);
      samples += take.samples.size();
    }
    fuzz::require(samples + takes->bad_rows == takes->rows, "a row was lost");
    return true;
  };
  return fuzz::run(fuzzer, argc, argv);
}
