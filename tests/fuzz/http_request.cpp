// Damaged requests for the page of metrics: each is judged without reading past its end, the same
// whether it comes at once or in pieces, and its answer has the form of one.
#include "services/cli/tools/metrics/http/request.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"

using namespace prehend;
using namespace prehend::cli::http;

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  fuzzer.seeds = {"GET /metrics HTTP/1.1\r\nHost: lab:9478\r\n\r\n",
                  "HEAD /metrics?x=1 HTTP/1.0\r\n\r\n",
                  "POST /metrics HTTP/1.1\r\nHost: a\r\nContent-Length: 4\r\n\r\nbody",
                  "GET http://lab/metrics HTTP/1.1\r\nHost: lab\r\nAccept: text/plain;q=0.5,*/*\r\n"
                  "User-Agent: Prometheus/2.45\r\nX-Prometheus-Scrape-Timeout-Seconds: 10\r\n\r\n"};
  fuzzer.long_round = 1'000'000;
  fuzzer.mutate = [](Random& random, std::string request) {
    return random.index(3) == 0 ? fuzz::mutate_lines(random, std::move(request))
                                : fuzz::mutate_bytes(random, std::move(request));
  };
  fuzzer.target = [](const std::string& text) {
    const Verdict verdict = judge(text, "/metrics");
    // What was decided of a beginning is not taken back when the rest comes.
    for (std::size_t size = 0; size < text.size(); size += 1 + text.size() / 16) {
      const Verdict early = judge(std::string(text, 0, size), "/metrics");
      fuzz::require(early.status == 0 || early.status == verdict.status,
                    "decided otherwise before");
    }
    if (verdict.status == 0) {
      fuzz::require(text.size() <= max_request, "waits for more than it takes");
      return false;
    }
    const std::string answer = response(verdict, "page\n");
    fuzz::require(answer.starts_with("HTTP/1.1 " + std::to_string(verdict.status) + " "),
                  "is no answer");
    fuzz::require(answer.find("\r\n\r\n") != std::string::npos, "has no end of its head");
    fuzz::require(verdict.status != 200 || verdict.body == answer.ends_with("\r\n\r\npage\n"),
                  "is not what was asked for");
    return verdict.status == 200 || verdict.status == 404 || verdict.status == 405;
  };
  return fuzz::run(fuzzer, argc, argv);
}
