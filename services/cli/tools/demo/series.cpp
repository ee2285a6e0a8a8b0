#include "services/cli/tools/demo/series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/base/to_terminal.hpp"
#include "common/convert/names.hpp"
#include "services/cli/tools/demo/demonstration.hpp"

namespace prehend::cli {
namespace {

struct Tally {
  int count = 0, right = 0, held = 0, intelligent = 0;
  std::vector<double> errors;  // m

  void add(const Outcome& outcome) {
    ++count;
    right += outcome.object && outcome.object->name == outcome.target;
    held += outcome.grasp.held;
    intelligent += outcome.mode == v1::MODE_INTELLIGENT;
    if (outcome.object && outcome.object->position_error)
      errors.push_back(*outcome.object->position_error);
  }
  double median_error() {
    if (errors.empty()) return 0;
    std::nth_element(errors.begin(), errors.begin() + static_cast<long>(errors.size() / 2),
                     errors.end());
    return errors[errors.size() / 2];
  }
};

std::string row(std::uint64_t seed, const Outcome& outcome) {
  const std::string seen = outcome.object ? outcome.object->name : "-";
  const std::string error = outcome.object && outcome.object->position_error
                                ? fmt::format("{:.1f}", *outcome.object->position_error * 1000)
                                : "-";
  return fmt::format("{:>5}  {:<12} {:<12} {:>7}  {:<12} {:>8}  {:>7.4f}  {}\n", seed,
                     outcome.target, seen, error, convert::mode_names.name(outcome.mode, "hold"),
                     outcome.grasp.contacts, outcome.grasp.epsilon,
                     outcome.grasp.held ? std::string("held") : outcome.grasp.reason);
}

nlohmann::ordered_json summary(Tally& tally) {
  return {{"count", tally.count},
          {"right_object", tally.right},
          {"held", tally.held},
          {"intelligent", tally.intelligent},
          {"median_position_error_m", tally.median_error()}};
}

}  // namespace

int run_series(const DemoOptions& demo, const SeriesOptions& options,
               const stage::Progress& progress) {
  Tally normal, direct;
  if (!options.json)
    to_terminal("{:>5}  {:<12} {:<12} {:>7}  {:<12} {:>8}  {:>7}  {}\n", "seed", "target",
                "recognised", "mm off", "mode", "contacts", "ε", "result");
  for (std::uint64_t seed = options.first; seed <= options.last; ++seed)
    for (const bool compare : {false, true}) {
      if (compare && !options.compare_direct) continue;
      DemoOptions one = demo;
      one.seed = seed;
      one.direct = demo.direct || compare;
      one.planned = demo.planned && !one.direct;
      const auto outcome = demonstrate(
          one, [&](const std::string& text) { progress(fmt::format("seed {}: {}", seed, text)); });
      if (!outcome) return service::complain(outcome.error());
      (compare ? direct : normal).add(*outcome);
      if (options.json) {
        auto document = nlohmann::ordered_json::parse(to_json(*outcome));
        document["seed"] = seed;
        std::cout << document.dump() << std::endl;
      } else {
        std::cout << row(seed, *outcome) << std::flush;
      }
    }
  if (options.json) {
    nlohmann::ordered_json document = {{"summary", summary(normal)}};
    if (options.compare_direct) document["direct"] = summary(direct);
    std::cout << document.dump() << std::endl;
  } else {
    const auto line = [](std::string_view name, Tally& tally) {
      to_terminal(
          "{}: right object {} of {}, held {} of {}, intelligent {}, median error {:.1f} mm\n",
          name, tally.right, tally.count, tally.held, tally.count, tally.intelligent,
          tally.median_error() * 1000);
    };
    line(demo.direct ? "direct mapping" : "as it comes", normal);
    if (options.compare_direct) line("direct mapping", direct);
  }
  const bool good =
      100 * normal.right >= 95 * normal.count && 100 * normal.held >= 80 * normal.count;
  return good ? exit_done : exit_no;
}

}  // namespace prehend::cli
