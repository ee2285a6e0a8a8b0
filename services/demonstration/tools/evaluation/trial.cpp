#include "services/demonstration/tools/evaluation/trial.hpp"

#include <algorithm>
#include <set>

#include "common/base/workers.hpp"
#include "services/demonstration/core/recognition/object_likelihood.hpp"

namespace prehend::demonstration {

namespace {

/// One training, and whom it judges.
struct Job {
  std::size_t task = 0;  // index of the result
  std::vector<const Take*> training, judged;
  std::map<Method, std::vector<Judged>> methods;
  std::map<Method, std::vector<Judged>> with_object;
  std::optional<Error> trouble;
};

std::size_t index_of(const std::vector<std::string>& names, const std::string& name) {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

/// classes: those of the recogniser and maybe others, which are not answered.
Judged judged_by(const Recogniser& recogniser, const Take& take,
                 const std::vector<std::string>& classes) {
  std::vector<Eigen::Index> place;
  for (const std::string& name : recogniser.classes())
    place.push_back(static_cast<Eigen::Index>(index_of(classes, name)));
  Judged made{take.user,
              index_of(classes, take.label),
              Distribution::Zero(static_cast<Eigen::Index>(classes.size())),
              {}};
  RecogniserStream stream(recogniser);
  for (const HandSample& sample : take.samples) {
    Eigen::Index best = 0;
    stream.add(sample).maxCoeff(&best);
    made.stream.push_back(static_cast<std::size_t>(place[static_cast<std::size_t>(best)]));
  }
  for (std::size_t c = 0; c < place.size(); ++c)
    made.answer[place[c]] = stream.latest()[static_cast<Eigen::Index>(c)];
  return made;
}

void judge_all(const std::vector<Recogniser>& recognisers, const std::vector<const Take*>& takes,
               const std::vector<std::string>& classes,
               std::map<Method, std::vector<Judged>>& methods) {
  for (const Recogniser& recogniser : recognisers)
    for (const Take* take : takes)
      methods[recogniser.method()].push_back(judged_by(recogniser, *take, classes));
}

/// The same answers times how well each kind explains the object. judged: of these takes.
std::vector<Judged> told_object(std::vector<Judged> judged, const std::vector<const Take*>& takes,
                                const ObjectLikelihood& likelihood) {
  for (std::size_t i = 0; i < judged.size(); ++i) {
    const Take& take = *takes[i];
    if (!take.object) continue;
    Distribution& answer = judged[i].answer;
    answer = with_prior(answer, likelihood.of(*take.object)).value_or(answer);
  }
  return judged;
}

Expected<void> tell_objects(Job& job, const std::vector<std::string>& classes) {
  const auto likelihood = ObjectLikelihood::learn(job.training, classes);
  if (!likelihood) return tl::unexpected(likelihood.error());
  for (const auto& [method, judged] : job.methods)
    job.with_object[method] = told_object(judged, job.judged, *likelihood);
  return {};
}

void run(Job& job, const std::vector<std::string>& classes, const TrainerOptions& options,
         bool with_object) {
  const auto recognisers =
      train_recognisers(job.training, {methods.begin(), methods.end()}, options);
  if (!recognisers) {
    job.trouble = recognisers.error();
    return;
  }
  judge_all(*recognisers, job.judged, classes, job.methods);
  if (!with_object) return;
  if (auto told = tell_objects(job, classes); !told) job.trouble = told.error();
}

/// What came of a job goes to what comes of its task.
void collect(Job& job, TaskResult& result) {
  const auto append = [](auto& from, auto& to) {
    for (auto& [method, judged] : from)
      std::move(judged.begin(), judged.end(), std::back_inserter(to[method]));
  };
  if (job.trouble) result.trouble = job.trouble;
  append(job.methods, result.methods);
  append(job.with_object, result.with_object);
}

std::vector<std::string> classes_of(const std::vector<const Take*>& takes,
                                    const std::vector<std::string>& more) {
  std::set<std::string> names(more.begin(), more.end());
  for (const Take* take : takes) names.insert(take->label);
  return {names.begin(), names.end()};
}

/// Kinds of these takes that are none of those.
std::vector<std::string> not_among(const std::vector<const Take*>& takes,
                                   const std::vector<std::string>& learnt) {
  std::vector<std::string> made;
  for (const std::string& name : classes_of(takes, {}))
    if (std::find(learnt.begin(), learnt.end(), name) == learnt.end()) made.push_back(name);
  return made;
}

/// Kinds that a single person shows: left out, nobody else teaches them.
std::vector<std::string> of_one_person(const std::vector<const Take*>& takes) {
  std::map<std::string, std::set<std::string>> people;
  for (const Take* take : takes) people[take->label].insert(take->user);
  std::vector<std::string> made;
  for (const auto& [label, users] : people)
    if (users.size() == 1) made.push_back(label);
  return made;
}

std::vector<Job> folds_by_person(std::size_t task, const std::vector<const Take*>& takes) {
  std::map<std::string, std::vector<const Take*>> people;
  for (const Take* take : takes) people[take->user].push_back(take);
  std::vector<Job> jobs;
  for (const auto& [user, own] : people) {
    Job job{task, {}, own, {}, {}, {}};
    for (const Take* take : takes)
      if (take->user != user) job.training.push_back(take);
    jobs.push_back(std::move(job));
  }
  return jobs;
}

}  // namespace

std::map<std::string, std::vector<const Take*>> by_task(const std::vector<Take>& takes) {
  std::map<std::string, std::vector<const Take*>> tasks;
  for (const Take& take : takes) tasks[take.task].push_back(&take);
  return tasks;
}

std::vector<TaskResult> judge(const std::vector<Take>& takes, const std::vector<Take>* training,
                              const TrainerOptions& options, unsigned threads,
                              const std::function<void(std::size_t, std::size_t)>& progress,
                              bool with_object) {
  const auto trained = training ? by_task(*training) : decltype(by_task(takes)){};
  std::vector<TaskResult> results;
  std::vector<Job> jobs;
  for (const auto& [task, own] : by_task(takes)) {
    const auto found = trained.find(task);
    const auto shown = found == trained.end() ? std::vector<const Take*>{} : found->second;
    const auto kinds = classes_of(shown, {});
    results.push_back({task, classes_of(own, kinds), {}, {}, {}});
    results.back().not_learnt = training ? not_among(own, kinds) : of_one_person(own);
    if (training && shown.empty()) {
      results.back().trouble = Error{"nobody shows it in the folder to learn from",
                                     {},
                                     "the same task needs the same name in both"};
      continue;
    }
    auto made = training ? std::vector<Job>{{results.size() - 1, shown, own, {}, {}, {}}}
                         : folds_by_person(results.size() - 1, own);
    std::move(made.begin(), made.end(), std::back_inserter(jobs));
  }
  share_work(
      jobs.size(), threads,
      [&](std::size_t i) { run(jobs[i], results[jobs[i].task].classes, options, with_object); },
      [&](std::size_t done) { progress(done, jobs.size()); });
  for (Job& job : jobs) collect(job, results[job.task]);
  return results;
}

TaskResult judge_with(const std::string& task, const std::vector<const Take*>& takes,
                      const std::vector<Recogniser>& recognisers) {
  TaskResult result{task, {}, {}, {}, {}};
  std::vector<std::string> known;
  for (const Recogniser& recogniser : recognisers)
    known.insert(known.end(), recogniser.classes().begin(), recogniser.classes().end());
  result.classes = classes_of(takes, known);
  result.not_learnt = not_among(takes, known);
  judge_all(recognisers, takes, result.classes, result.methods);
  return result;
}

}  // namespace prehend::demonstration
