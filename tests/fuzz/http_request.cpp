// Damaged requests, over the wire: each gets one answer that has the form of one, or none as it has
// not come to its end, and what was answered to its beginning is not taken back by the rest.
#include <thread>

#include "common/web/server.hpp"
#include "services/cli/tools/metrics/metrics_site.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"
#include "tests/support/metrics/client.hpp"

using namespace prehend;

namespace {

/// Serves until the process ends.
class Served {
 public:
  Served() : server_(web::Server::listen({}, site_).value()) {
    std::thread([this] { server_->run(); }).detach();
  }
  /// All that is answered to these bytes, behind which nothing comes.
  std::string ask(std::string_view request) const {
    const tests::Client client(port_);
    client.say(request);
    client.end();
    return client.hear();
  }

 private:
  cli::MetricsSite site_{[] { return "page\n"; }};
  std::unique_ptr<web::Server> server_;
  const int port_ = server_->port();
};

/// 0: there is no answer.
int status_of(const std::string& answer) {
  if (answer.empty()) return 0;
  fuzz::require(answer.size() > 12 && answer.starts_with("HTTP/1.1 "), "is no answer");
  fuzz::require(answer.find("\r\n\r\n") != std::string::npos, "has no end of its head");
  return std::stoi(answer.substr(9, 3));
}

}  // namespace

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  fuzzer.seeds = {"GET /metrics HTTP/1.1\r\nHost: lab:9478\r\n\r\n",
                  "HEAD /metrics?x=1 HTTP/1.0\r\n\r\n",
                  "POST /metrics HTTP/1.1\r\nHost: a\r\nContent-Length: 4\r\n\r\nbody",
                  "GET /metrics HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n"
                  "4\r\nbody\r\n0\r\n\r\n",
                  "GET http://lab/metrics HTTP/1.1\r\nHost: lab\r\nAccept: text/plain;q=0.5,*/*\r\n"
                  "User-Agent: Prometheus/2.45\r\nX-Prometheus-Scrape-Timeout-Seconds: 10\r\n\r\n"};
  fuzzer.long_round = 1'000'000;
  fuzzer.mutate = [](Random& random, std::string request) {
    return random.index(3) == 0 ? fuzz::mutate_lines(random, std::move(request))
                                : fuzz::mutate_bytes(random, std::move(request));
  };
  fuzzer.target = [](const std::string& text) {
    // In the child process, where threads do what they do.
    static const auto& served = *new Served;
    const std::string answer = served.ask(text);
    const int status = status_of(answer);
    const int early = status_of(served.ask(text.substr(0, text.size() / 2)));
    // How a bad request is refused may depend on how much of it came at once.
    fuzz::require(early == 0 || early == status || (early >= 400 && status >= 400),
                  "decided otherwise before");
    fuzz::require(status != 200 || answer.ends_with("\r\n\r\npage\n") != text.starts_with("HEAD "),
                  "is not what was asked for");
    return status == 200 || status == 404 || status == 405;
  };
  return fuzz::run(fuzzer, argc, argv);
}
