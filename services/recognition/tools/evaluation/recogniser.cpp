#include "services/recognition/tools/evaluation/recogniser.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "common/base/named_values.hpp"
#include "services/recognition/tools/evaluation/false_alarm.hpp"

namespace prehend::recognition {
namespace {

/// Colour cooccurrence histograms, as the service compares them.
class Cooccurrence final : public Recogniser {
 public:
  Cooccurrence(const DescriptorOptions& options, Method method)
      : options_(options), method_(method) {}

  Cooccurrence(ObjectModels models, Method method) : method_(method), models_(std::move(models)) {
    for (std::size_t i = 0; i < models_->classes.size(); ++i)
      class_of_.push_back(static_cast<int>(i));
    if (method_ == Method::false_alarm) false_alarm_.emplace(*models_);
  }

  Expected<void> learn(const std::vector<TrainingClass>& classes) override {
    auto learned = train(classes, options_);
    if (!learned) return tl::unexpected(learned.error());
    models_ = std::move(*learned);
    // Classes without a usable view are left out by the training.
    class_of_.clear();
    for (const ObjectClass& c : models_->classes)
      for (std::size_t i = 0; i < classes.size(); ++i)
        if (classes[i].name == c.name) class_of_.push_back(static_cast<int>(i));
    if (method_ == Method::false_alarm) false_alarm_.emplace(*models_);
    return {};
  }

  PhotoAnswer name(const TrainingView& view) const override {
    const Classification seen =
        classify(*models_, describe(*models_, models_->palette.quantise(view.picture), view.mask),
                 method_ != Method::nearest_view && method_ != Method::false_alarm);
    if (seen.best < 0) return {};
    PhotoAnswer made{class_of_[static_cast<std::size_t>(seen.best)], seen.probability};
    if (false_alarm_)
      made.probability = 1 - false_alarm_->probability(seen.best, seen.similarity[seen.best]);
    return made;
  }

 private:
  DescriptorOptions options_;
  Method method_;
  std::optional<ObjectModels> models_;
  std::optional<FalseAlarm> false_alarm_;
  std::vector<int> class_of_;  // by the models' numbers
};

/// SIFT features (Lowe 2004): each votes for the class of its nearest neighbour if that is clearly
/// nearer than the nearest of any other class. The probability is the winner's share of the votes.
class Sift final : public Recogniser {
 public:
  Expected<void> learn(const std::vector<TrainingClass>& classes) override {
    cv::setRNGSeed(1);  // the index' trees are drawn
    matcher_ = cv::FlannBasedMatcher::create();
    label_.clear();
    classes_ = classes.size();
    std::vector<cv::Mat> all;
    for (std::size_t c = 0; c < classes.size(); ++c)
      for (const TrainingView& view : classes[c].views)
        if (cv::Mat features = features_of(view); !features.empty()) {
          label_.push_back(c);
          all.push_back(features);
        }
    if (all.empty()) return fail("has no feature", "training pictures");
    matcher_->add(all);
    matcher_->train();
    return {};
  }

  PhotoAnswer name(const TrainingView& view) const override {
    const cv::Mat features = features_of(view);
    if (features.empty()) return {};
    std::vector<std::vector<cv::DMatch>> near;
    matcher_->knnMatch(features, near, 12);
    std::vector<double> votes(classes_, 0);
    double sum = 0;
    for (const auto& matches : near) {
      if (matches.empty()) continue;
      const std::size_t first = label_[static_cast<std::size_t>(matches.front().imgIdx)];
      const auto other = std::find_if(matches.begin(), matches.end(), [&](const cv::DMatch& m) {
        return label_[static_cast<std::size_t>(m.imgIdx)] != first;
      });
      if (other != matches.end() && matches.front().distance > 0.85f * other->distance) continue;
      votes[first] += 1;
      sum += 1;
    }
    const auto best = std::max_element(votes.begin(), votes.end());
    if (sum == 0) return {};
    return {static_cast<int>(best - votes.begin()), *best / sum};
  }

 private:
  static cv::Mat features_of(const TrainingView& view) {
    const cv::Mat rgb(view.picture.height, view.picture.width, CV_8UC3,
                      const_cast<std::uint8_t*>(view.picture.rgb.data()));
    const cv::Mat mask(view.mask.height, view.mask.width, CV_8UC1,
                       const_cast<std::uint8_t*>(view.mask.values.data()));
    cv::Mat grey, descriptors;
    cv::cvtColor(rgb, grey, cv::COLOR_RGB2GRAY);
    std::vector<cv::KeyPoint> points;
    cv::SIFT::create(400)->detectAndCompute(grey, mask, points, descriptors);
    return descriptors;
  }

  cv::Ptr<cv::DescriptorMatcher> matcher_;
  std::vector<std::size_t> label_;  // class of each picture in the matcher
  std::size_t classes_ = 0;
};

}  // namespace

namespace {
constexpr auto method_names =
    named_values<Method>({{Method::learned, "cooccurrence, learned"},
                          {Method::nearest_view, "cooccurrence, nearest view"},
                          {Method::false_alarm, "nearest view, false-alarm model"},
                          {Method::histogram, "colour histogram, learned"},
                          {Method::sift, "SIFT votes"}});
}  // namespace

std::string_view to_string(Method method) {
  return method_names.name(method);
}

std::unique_ptr<Recogniser> make_recogniser(Method method, const DescriptorOptions& options) {
  if (method == Method::sift) return std::make_unique<Sift>();
  DescriptorOptions used = options;
  if (method == Method::histogram) used.distances = {0};
  return std::make_unique<Cooccurrence>(used, method);
}

std::unique_ptr<Recogniser> recogniser_of(ObjectModels models, Method method) {
  return std::make_unique<Cooccurrence>(std::move(models), method);
}

}  // namespace prehend::recognition
