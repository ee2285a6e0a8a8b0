#pragma once

#include <functional>

#include "services/recognition/files/dataset.hpp"
#include "services/recognition/tools/evaluation/judged.hpp"
#include "services/recognition/tools/evaluation/recogniser.hpp"

namespace prehend::recognition {

/// What is told while a trial runs: pictures judged, of all.
using Told = std::function<void(std::size_t done, std::size_t all)>;

/// Names every picture by a recogniser that learned only the other folds (`fold`: one a view, class
/// by class), and every stranger by each of these recognisers, in turn. `other_light`: what is
/// named is not the picture but a varied copy (see training.hpp), as another day might show it.
Expected<std::vector<Judged>> cross_validate(Method method, const DescriptorOptions& options,
                                             const Dataset& dataset, const std::vector<int>& fold,
                                             const Dataset& strangers, bool other_light,
                                             const Told& told);

/// Names every picture and every stranger by what has learned from others. `number`: of each class
/// of the pictures, by the recogniser's numbers; one that it does not know has a number beyond.
std::vector<Judged> judge_all(const Recogniser& recogniser, const Dataset& dataset,
                              const std::vector<int>& number, const Dataset& strangers,
                              const Told& told);

/// Names every picture of a class by a recogniser that learned only the other classes: what comes
/// through are look-alikes. All are strangers then.
Expected<std::vector<Judged>> leave_classes_out(Method method, const DescriptorOptions& options,
                                                const Dataset& dataset, const Told& told);

/// Folds from a file of groups, lines of `CLASS,FIRST,LAST`: the pictures of a class, by name, from
/// the FIRST-th to the LAST-th (from 0) are kept together; the n-th line of a class is fold n.
Expected<std::vector<int>> folds_from(const std::filesystem::path& file, const Dataset& dataset);

}  // namespace prehend::recognition
