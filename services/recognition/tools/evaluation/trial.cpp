#include "services/recognition/tools/evaluation/trial.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <map>

namespace prehend::recognition {
namespace {

std::size_t views_of(const Dataset& dataset) {
  std::size_t all = 0;
  for (const TrainingClass& c : dataset.classes) all += c.views.size();
  return all;
}

/// The classes with only those views (counted through, class by class) that are wanted. A class
/// keeps its number when it has none left.
std::vector<TrainingClass> choose(const Dataset& dataset, auto wanted) {
  std::vector<TrainingClass> made;
  std::size_t i = 0;
  for (const TrainingClass& c : dataset.classes) {
    made.push_back({c.name, {}});
    for (const TrainingView& view : c.views)
      if (wanted(i++)) made.back().views.push_back(view);
  }
  return made;
}

/// One judged picture a wanted view, or a varied copy of it.
void judge(const Recogniser& recogniser, const Dataset& dataset, bool strangers, auto wanted,
           std::vector<Judged>& made, Random* other_light = nullptr) {
  std::size_t i = 0;
  for (std::size_t c = 0; c < dataset.classes.size(); ++c)
    for (std::size_t v = 0; v < dataset.classes[c].views.size(); ++v) {
      if (!wanted(i++)) continue;
      const TrainingView& view = dataset.classes[c].views[v];
      const Recogniser::PhotoAnswer answer = recogniser.name(
          other_light ? TrainingView{varied(view.picture, *other_light), view.mask} : view);
      made.push_back({dataset.files[c][v], strangers ? -1 : static_cast<int>(c), answer.best,
                      answer.probability});
    }
}

}  // namespace

Expected<std::vector<Judged>> cross_validate(Method method, const DescriptorOptions& options,
                                             const Dataset& dataset, const std::vector<int>& fold,
                                             const Dataset& strangers, bool other_light,
                                             const Told& told) {
  std::vector<Judged> made;
  Random random(17);  // another one than the training's
  const int folds = fold.empty() ? 0 : *std::max_element(fold.begin(), fold.end()) + 1;
  const std::size_t all = views_of(dataset) + views_of(strangers);
  for (int f = 0; f < folds; ++f) {
    const auto recogniser = make_recogniser(method, options);
    const auto learned =
        recogniser->learn(choose(dataset, [&](std::size_t i) { return fold[i] != f; }));
    if (!learned) return tl::unexpected(learned.error());
    judge(
        *recogniser, dataset, false, [&](std::size_t i) { return fold[i] == f; }, made,
        other_light ? &random : nullptr);
    judge(
        *recogniser, strangers, true,
        [&](std::size_t i) { return static_cast<int>(i) % folds == f; }, made,
        other_light ? &random : nullptr);
    told(made.size(), all);
  }
  return made;
}

std::vector<Judged> judge_all(const Recogniser& recogniser, const Dataset& dataset,
                              const std::vector<int>& number, const Dataset& strangers,
                              const Told& told) {
  std::vector<Judged> made;
  const auto all = [](std::size_t) { return true; };
  judge(recogniser, dataset, false, all, made);
  for (Judged& picture : made) picture.truth = number[static_cast<std::size_t>(picture.truth)];
  told(made.size(), made.size() + views_of(strangers));
  judge(recogniser, strangers, true, all, made);
  told(made.size(), made.size());
  return made;
}

Expected<std::vector<Judged>> leave_classes_out(Method method, const DescriptorOptions& options,
                                                const Dataset& dataset, const Told& told) {
  std::vector<int> owner;
  for (std::size_t c = 0; c < dataset.classes.size(); ++c)
    owner.insert(owner.end(), dataset.classes[c].views.size(), static_cast<int>(c));
  std::vector<Judged> made;
  for (int c = 0; c < static_cast<int>(dataset.classes.size()); ++c) {
    const auto recogniser = make_recogniser(method, options);
    const auto learned =
        recogniser->learn(choose(dataset, [&](std::size_t i) { return owner[i] != c; }));
    if (!learned) return tl::unexpected(learned.error());
    judge(
        *recogniser, dataset, true, [&](std::size_t i) { return owner[i] == c; }, made);
    told(made.size(), owner.size());
  }
  return made;
}

Expected<std::vector<int>> folds_from(const std::filesystem::path& file, const Dataset& dataset) {
  std::ifstream stream(file);
  if (!stream) return fail("cannot be read", file.string());
  std::map<std::string, std::size_t> first_view;
  std::size_t views = 0;
  std::map<std::string, std::size_t> size;
  for (const TrainingClass& c : dataset.classes) {
    first_view[c.name] = views;
    size[c.name] = c.views.size();
    views += c.views.size();
  }
  std::vector<int> made(views, -1);
  std::map<std::string, int> groups;
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    if (line.empty() || line.front() == '#') continue;
    const std::string where = fmt::format("{}:{}", file.string(), number);
    const std::size_t comma = line.find(','), second = line.find(',', comma + 1);
    std::size_t from = 0, to = 0;
    const char* end = line.data() + line.size();
    if (second == std::string::npos ||
        std::from_chars(line.data() + comma + 1, end, from).ptr != line.data() + second ||
        std::from_chars(line.data() + second + 1, end, to).ptr != end || to < from)
      return fail("is no CLASS,FIRST,LAST", where);
    const std::string name = line.substr(0, comma);
    if (!size.contains(name)) return fail("names no class of the pictures", where);
    if (to >= size[name]) return fail("goes beyond the last picture", where);
    const int fold = groups[name]++;
    for (std::size_t i = from; i <= to; ++i) made[first_view[name] + i] = fold;
  }
  if (std::find(made.begin(), made.end(), -1) != made.end())
    return fail("leaves out pictures", file.string(), "each belongs to one group");
  return made;
}

}  // namespace prehend::recognition
