#pragma once

#include <functional>
#include <string>
#include <variant>

#include "common/web/site.hpp"

namespace prehend::cli {

/// One page, at /metrics.
class MetricsSite final : public web::Site {
 public:
  /// page: called for each who asks for it; in the text format of Prometheus.
  explicit MetricsSite(std::function<std::string()> page) : page_(std::move(page)) {}
  std::variant<web::Answer, web::Upgrade> answer(const web::Request& request) override;

 private:
  std::function<std::string()> page_;
};

}  // namespace prehend::cli
