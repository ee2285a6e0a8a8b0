// The page of metrics as a site: which requests get it, and what the others are told.
#include "services/cli/tools/metrics/metrics_site.hpp"

#include <gtest/gtest.h>

namespace prehend::cli {
namespace {

web::Answer answer(const std::string& method, const std::string& target) {
  MetricsSite site([] { return "prehend_up 1\n"; });
  return std::get<web::Answer>(site.answer({.method = method, .target = target}));
}

TEST(MetricsSite, ThePageIsThereByEveryFormOfItsAddress) {
  for (const char* target : {"/metrics", "/metrics?name=x", "http://lab:9478/metrics"})
    for (const char* method : {"GET", "HEAD"}) {
      const web::Answer page = answer(method, target);
      EXPECT_EQ(page.status, 200) << method << " " << target;
      EXPECT_EQ(page.body, "prehend_up 1\n");
      EXPECT_TRUE(page.type.starts_with("text/plain; version=0.0.4"));
    }
}

TEST(MetricsSite, OtherPathsAndMethodsAreRefused) {
  for (const char* target : {"/", "/metrics/", "/METRICS", "http://lab", "*"})
    EXPECT_EQ(answer("GET", target).status, 404) << target;
  for (const char* target : {"metrics", "", "https://lab/metrics"})
    EXPECT_EQ(answer("GET", target).status, 400) << target;
  for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS", "TRACE", "get", "BREW"}) {
    const web::Answer refusal = answer(method, "/metrics");
    EXPECT_EQ(refusal.status, 405) << method;
    EXPECT_EQ(refusal.fields, (web::Fields{{"Allow", "GET, HEAD"}}));
  }
}

}  // namespace
}  // namespace prehend::cli
