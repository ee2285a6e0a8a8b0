// A lab of real services, read as Prometheus reads it.
#include <csignal>
#include <fstream>

#include "tests/integration/rig.hpp"
#include "tests/support/metrics/client.hpp"
#include "tests/support/metrics/page.hpp"

namespace prehend::integration {
namespace {

using tests::Client;
using tests::MetricsPage;

class Metrics : public Rig {
 protected:
  stage::Process start_exporter() {
    stage::Process::Options options;
    options.command = {program("prehend"), "metrics"};
    for (const std::string& argument : lab_arguments({"metrics.port=0"}))
      options.command.push_back(argument);
    options.log = folder_ / "metrics.log";
    options.output = folder_ / "metrics.out";
    auto process = stage::Process::start(options);
    if (!process) throw std::runtime_error(process.error().message());
    EXPECT_TRUE(eventually(30, [&] {
      std::ifstream said(options.output);
      std::string line;
      if (!std::getline(said, line) || said.eof() || !line.ends_with("/metrics")) return false;
      EXPECT_TRUE(line.starts_with("http://127.0.0.1:")) << line;
      port_ = std::stoi(line.substr(line.rfind(':') + 1));
      return true;
    })) << "nothing is served";
    return std::move(*process);
  }

  /// All that the exporter answers.
  std::string ask(const std::string& request) const {
    const Client client(port_);
    client.say(request);
    return client.hear();
  }

  MetricsPage page() const {
    const std::string said = ask("GET /metrics HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n");
    if (!said.starts_with("HTTP/1.1 200 OK\r\n")) throw std::runtime_error("no page: " + said);
    const std::string body = said.substr(said.find("\r\n\r\n") + 4);
    auto read = MetricsPage::parse(body);
    if (!read) throw std::runtime_error(read.error().message());
    return std::move(*read);
  }
  /// Until the one sample of this name with these labels is so.
  testing::AssertionResult becomes(const std::string& name, const std::string& labels,
                                   const std::function<bool(double)>& so) const {
    Expected<double> last = fail("nothing was read");
    if (eventually(40, [&] {
          last = page().value(name, labels);
          return last && so(*last);
        }))
      return testing::AssertionSuccess();
    return testing::AssertionFailure() << name << " " << labels << ": "
                                       << (last ? std::to_string(*last) : last.error().message());
  }

  int port_ = 0;
};

bool is_one(double value) {
  return value == 1;
}
bool is_some(double value) {
  return value > 0;
}

TEST_F(Metrics, TellALabAndWhatBecomesOfIt) {
  auto exporter = start_exporter();
  EXPECT_EQ(page().value("prehend_processes", "service=\"mapping\""), 0.0) << "missing";
  const Strings hands{"lab.scene=" + scene(1)};
  auto simulation = start("simulation", hands);
  auto mapping = start("mapping", hands);
  auto recognition = start("recognition", hands);
  auto glove = start("glove", hands);
  for (const char* name : {"glove", "recognition", "mapping", "simulation"}) {
    const std::string labels = std::string("service=\"") + name + "\"";
    EXPECT_TRUE(becomes("prehend_up", labels, is_one));
    EXPECT_TRUE(becomes("prehend_peers", labels, is_some));
    EXPECT_TRUE(becomes("prehend_resident_bytes", labels, is_some));
    EXPECT_EQ(page().value("prehend_starts_total", labels), 1.0);
  }
  EXPECT_TRUE(becomes("prehend_gate_led", "hand", is_one));
  EXPECT_TRUE(becomes("prehend_gate_obeyed_total", "hand", is_some));
  EXPECT_TRUE(becomes("prehend_events_total", "event=\"leads\"", is_some));
  EXPECT_TRUE(
      becomes("prehend_latency_seconds", "stage=\"glove to accepted\",quantile=\"0.99\"", is_some));

  // Counts only grow, from one page to the next.
  MetricsPage before = page();
  const double obeyed = before.value("prehend_gate_obeyed_total", "hand").value();
  EXPECT_TRUE(becomes("prehend_gate_obeyed_total", "hand", [&](double value) {
    const MetricsPage now = page();
    EXPECT_EQ(now.shrunk_since(before), "");
    before = now;
    return value > obeyed + 20;
  }));

  const Answer stopped =
      run("prehend", with_lab({"stop", "--reason", "a \"hand\" \\ in the cell"}), 30);
  ASSERT_EQ(stopped.exit_code, 0) << stopped.log;
  EXPECT_TRUE(becomes("prehend_gate_stopped", "hand", is_one));
  EXPECT_TRUE(becomes("prehend_gate_stop_info", R"(reason="a \"hand\" \\ in the cell")", is_one));
  EXPECT_TRUE(becomes("prehend_gate_refusals_total", "reason=\"command while stopped\"", is_some));

  mapping.signal(SIGKILL);
  EXPECT_TRUE(becomes("prehend_processes", "service=\"mapping\"", [](double n) { return n == 0; }));
  auto another = start("mapping", hands);
  EXPECT_TRUE(
      becomes("prehend_starts_total", "service=\"mapping\"", [](double n) { return n == 2; }));
  exporter.signal(SIGTERM);
  const auto exit = exporter.wait(seconds(20));
  ASSERT_TRUE(exit);
  EXPECT_EQ(exit->code, 0);
}

TEST_F(Metrics, OtherRequestsAreAnsweredAsHttpWants) {
  auto exporter = start_exporter();
  const std::string head = ask("HEAD /metrics HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_TRUE(head.starts_with("HTTP/1.1 200 OK\r\n")) << head;
  EXPECT_NE(head.find("text/plain; version=0.0.4"), std::string::npos);
  EXPECT_TRUE(head.ends_with("\r\n\r\n")) << head;
  EXPECT_TRUE(ask("GET / HTTP/1.1\r\nHost: a\r\n\r\n").starts_with("HTTP/1.1 404 "));
  EXPECT_TRUE(ask("POST /metrics HTTP/1.1\r\nHost: a\r\n\r\n").starts_with("HTTP/1.1 405 "));
  EXPECT_TRUE(ask("\x16\x03\x01\r\n").starts_with("HTTP/1.1 400 ")) << "TLS, say";

  const Answer second =
      run("prehend", with_lab({"metrics", "--set", "metrics.port=" + std::to_string(port_)}), 30);
  EXPECT_EQ(second.exit_code, 3) << "two at one port";
  EXPECT_NE(second.log.find(std::to_string(port_)), std::string::npos) << second.log;
  EXPECT_EQ(run("prehend", with_lab({"metrics", "--set", "metrics.port=70000"}), 30).exit_code, 2);
}

}  // namespace
}  // namespace prehend::integration
