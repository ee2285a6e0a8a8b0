#include "services/demonstration/core/observation/grasp_judge.hpp"

#include <cmath>

namespace prehend::demonstration {

namespace {

constexpr double max_grasp_speed = 0.2;  // m/s: a hand that is faster is on its way
constexpr double smoothing = 0.1;        // s, of that speed, or a tracker's noise would be a speed
constexpr double other_approach = 0.15;  // of a kind whose palm usually comes from elsewhere

std::vector<std::string> names_of(const model::GraspTaxonomy& taxonomy) {
  std::vector<std::string> names;
  for (const model::GraspClass& each : taxonomy.classes()) names.push_back(each.name);
  return names;
}

}  // namespace

HandSample sample_of(const SeenHand& hand, const SeenHand* before, Time begin) {
  HandSample sample{.t = to_seconds(hand.stamp - begin)};
  sample.scale = hand.scale;
  for (std::size_t f = 0; f < hand.p_HF.size(); ++f)
    if (hand.p_HF[f]) sample.p_HF[f] = *hand.p_HF[f];
  const auto& thumb = hand.p_HF[static_cast<std::size_t>(model::Finger::thumb)];
  for (std::size_t f = 1; thumb && f < hand.p_HF.size(); ++f)
    if (hand.p_HF[f]) sample.p_thumb_tip_W[f - 1] = hand.X_WH.linear() * (*hand.p_HF[f] - *thumb);
  if (before && hand.stamp > before->stamp)
    sample.hand_speed = (hand.X_WH.translation() - before->X_WH.translation()).norm() /
                        to_seconds(hand.stamp - before->stamp);
  return sample;
}

double PalmSpeed::add(Time stamp, const Eigen::Vector3d& p_WH) {
  if (seen_ && stamp > stamp_) {
    const double dt = to_seconds(stamp - stamp_);
    v_WH_ += (1 - std::exp(-dt / smoothing)) * ((p_WH - p_WH_) / dt - v_WH_);
  }
  seen_ = true;
  stamp_ = stamp;
  p_WH_ = p_WH;
  return v_WH_.norm();
}

GraspJudge::GraspJudge(const model::GraspTaxonomy& taxonomy, const Recogniser* recogniser,
                       const ObjectLikelihood* objects)
    : taxonomy_(taxonomy),
      recogniser_(recogniser),
      objects_(objects),
      kinds_(recogniser ? recogniser->classes() : names_of(taxonomy)) {
  for (const std::string& kind : kinds_) {
    const model::GraspClass* known = taxonomy.find(kind);
    classes_.push_back(known ? std::optional<std::size_t>(known - taxonomy.classes().data())
                             : std::nullopt);
  }
  begin();
}

void GraspJudge::begin() {
  if (recogniser_) stream_.emplace(*recogniser_);
  first_.reset();
  last_.reset();
}

Eigen::VectorXd GraspJudge::prior(const SeenObject* object) const {
  Eigen::VectorXd made = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(kinds_.size()));
  if (!object) return made;
  if (objects_ && model::is_valid(object->shape)) return objects_->of(object->shape);
  const std::vector<double> fit = taxonomy_.fit_to_object(object->shape);
  for (std::size_t k = 0; k < kinds_.size(); ++k)
    if (classes_[k]) made[static_cast<Eigen::Index>(k)] = fit[*classes_[k]];
  // An object that is grasped in no way that we know says nothing.
  return made.sum() > 0 ? made : Eigen::VectorXd::Ones(made.size());
}

Distribution GraspJudge::by_approach(const SeenHand& hand) const {
  const Pose X_WG = hand.X_WH * model::HumanHand(hand.scale).X_HG();
  const double down = std::clamp(-X_WG.linear().col(2).z(), 0.0, 1.0);
  const double above = down * down;
  Distribution made(static_cast<Eigen::Index>(kinds_.size()));
  for (std::size_t c = 0; c < kinds_.size(); ++c) {
    const bool from_above = taxonomy_.classes()[c].approach == model::Approach::above;
    made[static_cast<Eigen::Index>(c)] = other_approach + (from_above ? above : 1 - above);
  }
  return made / made.sum();
}

Distribution GraspJudge::see(const SeenHand& hand, const SeenObject* object) {
  if (speed_.add(hand.stamp, hand.X_WH.translation()) > max_grasp_speed) begin();
  if (!first_) first_ = hand;
  const Distribution seen =
      stream_ ? stream_->add(sample_of(hand, last_ ? &*last_ : nullptr, first_->stamp))
              : by_approach(hand);
  last_ = hand;
  const Distribution of_object = with_prior(seen, prior(object)).value_or(seen);
  // A task that forbids all that is seen is not the one that is done.
  return with_prior(of_object, prior_of_task_).value_or(of_object);
}

}  // namespace prehend::demonstration
