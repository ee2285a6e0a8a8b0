#include "services/demonstration/core/recognition/recogniser.hpp"

#include <cmath>
#include <set>
#include <utility>

#include "common/base/named_values.hpp"

namespace prehend::demonstration {

namespace {

constexpr auto method_names =
    named_values<Method>({{Method::hybrid, "hybrid", "shape, direction and speed"},
                          {Method::posture, "posture", "the hand's shape alone"},
                          {Method::trajectory, "trajectory", "direction and speed alone"},
                          {Method::hmm, "hmm", "hidden Markov models on all of it"}});

}  // namespace

std::string_view to_string(Method method) {
  return method_names.name(method);
}

std::optional<Method> method_from_string(std::string_view name) {
  return method_names.value(name);
}

Expected<Recogniser> Recogniser::create(Method method, std::vector<std::string> classes,
                                        std::vector<Part> parts, double temperature) {
  if (classes.size() < 2) return fail("a recogniser needs at least two kinds of grasps");
  if (std::set<std::string>(classes.begin(), classes.end()).size() != classes.size())
    return fail("a kind of grasp is there twice");
  if (parts.empty()) return fail("a recogniser has no classifier");
  for (const Part& part : parts) {
    if (auto ok = check(part.classifier, classes.size()); !ok) return tl::unexpected(ok.error());
    if (!std::isfinite(part.weight)) return fail("a classifier's weight is no number");
  }
  if (!(temperature > 0) || !std::isfinite(temperature))
    return fail("a recogniser's temperature is not above 0");
  Recogniser made;
  made.method_ = method;
  made.classes_ = std::move(classes);
  made.parts_ = std::move(parts);
  made.temperature_ = temperature;
  return made;
}

Distribution Recogniser::recognise(const std::vector<HandSample>& samples) const {
  RecogniserStream stream(*this);
  for (const HandSample& sample : samples) stream.add(sample);
  return stream.latest();
}

RecogniserStream::RecogniserStream(const Recogniser& recogniser)
    : recogniser_(&recogniser),
      scores_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(recogniser.classes().size()))),
      latest_(distribution_of(scores_, 1)),
      surest_(latest_) {
  for (const Part& part : recogniser.parts()) parts_.emplace_back(part.classifier);
}

const Distribution& RecogniserStream::add(const HandSample& sample) {
  scores_.setZero();
  for (std::size_t i = 0; i < parts_.size(); ++i)
    scores_ += recogniser_->parts()[i].weight * parts_[i].add(sample);
  latest_ = distribution_of(scores_, recogniser_->temperature());
  if (latest_.maxCoeff() >= surest_.maxCoeff()) surest_ = latest_;
  return surest_;
}

}  // namespace prehend::demonstration
