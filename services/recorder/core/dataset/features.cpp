#include "services/recorder/core/dataset/features.hpp"

#include <map>
#include <set>

namespace prehend::recorder::dataset {

std::vector<std::string> keep_common(const std::vector<Rows*>& episodes) {
  // A feature of the same name with other columns is another one.
  std::map<std::pair<std::string, std::vector<std::string>>, std::size_t> features;
  std::map<std::string, std::size_t> cameras;
  for (const Rows* rows : episodes) {
    for (const Feature& feature : rows->others) ++features[{feature.name, feature.columns}];
    for (const auto& [name, places] : rows->pictures) ++cameras[name];
  }
  std::set<std::string> left_out;
  for (Rows* rows : episodes) {
    std::erase_if(rows->others, [&](const Feature& feature) {
      if (features[{feature.name, feature.columns}] == episodes.size()) return false;
      left_out.insert(feature.name);
      return true;
    });
    std::erase_if(rows->pictures, [&](const auto& camera) {
      if (cameras[camera.first] == episodes.size()) return false;
      left_out.insert(camera.first);
      return true;
    });
  }
  return {left_out.begin(), left_out.end()};
}

Statistics statistics(const Table& values) {
  Statistics all;
  all.min = values.colwise().minCoeff().transpose();
  all.max = values.colwise().maxCoeff().transpose();
  all.mean = values.colwise().mean().transpose();
  const Table off = values.rowwise() - all.mean.transpose();
  all.deviation = off.colwise().squaredNorm().transpose() / static_cast<double>(values.rows());
  all.deviation = all.deviation.cwiseSqrt();
  all.count = static_cast<std::size_t>(values.rows());
  return all;
}

Statistics together(const std::vector<Statistics>& parts) {
  Statistics all = parts.front();
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(all.mean.size());
  all.mean = squares;
  all.count = 0;
  for (const Statistics& part : parts) {
    all.min = all.min.cwiseMin(part.min);
    all.max = all.max.cwiseMax(part.max);
    all.mean += part.mean * static_cast<double>(part.count);
    all.count += part.count;
  }
  all.mean /= static_cast<double>(all.count);
  for (const Statistics& part : parts)
    squares += static_cast<double>(part.count) *
               (part.deviation.array().square() + (part.mean - all.mean).array().square()).matrix();
  all.deviation = (squares / static_cast<double>(all.count)).cwiseSqrt();
  return all;
}

Table scaled(const Table& values, const Statistics& range) {
  Table all = Table::Zero(values.rows(), values.cols());
  for (Eigen::Index column = 0; column < values.cols(); ++column) {
    const double low = range.min[column], width = range.max[column] - low;
    if (width <= 0) continue;
    all.col(column) = (2 * (values.col(column).array() - low) / width - 1).cwiseMax(-1).cwiseMin(1);
  }
  return all;
}

}  // namespace prehend::recorder::dataset
