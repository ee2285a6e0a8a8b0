#include "tests/integration/fault_rig.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "tests/support/paths/paths.hpp"

namespace prehend::integration {
namespace {

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return -1;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1) + 0.5)];
}

/// Prints the table when all tests have run.
class Table : public testing::Environment {
 public:
  void add(const FaultRow& row) { rows_.push_back(row); }
  void TearDown() override {
    if (rows_.empty()) return;
    fmt::print(
        "\n| fault | rounds | lost | recovery p50, s | p99, s | memory before, MB | after, MB |\n"
        "|---|---|---|---|---|---|---|\n");
    const auto mb = [](double bytes) {
      return bytes > 0 ? fmt::format("{:.1f}", bytes / 1e6) : std::string("–");
    };
    for (const FaultRow& row : rows_)
      fmt::print("| {} | {} | {} | {:.3f} | {:.3f} | {} | {} |\n", row.fault, row.rounds, row.lost,
                 quantile(row.recoveries, 0.5), quantile(row.recoveries, 0.99),
                 mb(row.memory_before), mb(row.memory_after));
  }

 private:
  std::vector<FaultRow> rows_;
};

Table& table() {
  static auto* made = dynamic_cast<Table*>(testing::AddGlobalTestEnvironment(new Table));
  return *made;
}
[[maybe_unused]] const Table& at_start = table();

}  // namespace

void report(const FaultRow& row) {
  table().add(row);
}

double promised(double limit_s) {
  return std::getenv("PREHEND_LONG") ? limit_s : 5 * limit_s;
}

int rounds(int usual, int many) {
  return std::getenv("PREHEND_LONG") ? many : usual;
}

OnHosts::OnHosts() {
  if (const auto why = Hosts::unavailable()) {
    skip_ = *why;
    return;
  }
  hosts_.emplace(test::in_programs("prehend-delay-line"));
  hosts_->add("operator");
  hosts_->enter("operator");
}

void FaultRig::secure() {
  network_.keys = folder_ / "keys";
  const Answer made = run("prehend", with_lab({"keys", "init", network_.keys.string()}), 30);
  if (made.exit_code != 0) throw std::runtime_error(made.log);
  join("replayer");  // which writes orders and reads everything
}

void FaultRig::SetUp() {
  if (!hosts_) GTEST_SKIP() << skip_;
  states_.emplace(reader(dds::robot_state));
  grasps_.emplace(reader(dds::grasp_report));
  health_.emplace(reader(dds::service_status));
  replies_.emplace(reader(dds::operator_reply));
  commands_.emplace(writer(dds::operator_command));
  sets_ = {"lab.scene=" + scene(1), "glove.device=synthetic"};
}

std::string FaultRig::host_of(const std::string& service) const {
  return service == "glove" ? "hand" : service == "recognition" ? "eye" : "robot";
}

stage::Process FaultRig::launch(const std::string& service, const Strings& prefix,
                                const Strings& sets, const std::string& log) {
  Strings command = prefix;
  command.push_back(program("prehend-" + service));
  Strings all = sets_;
  all.insert(all.end(), sets.begin(), sets.end());
  for (std::string& argument : lab_arguments(all)) command.push_back(std::move(argument));
  auto made = stage::Process::start(
      {.command = hosts_->on(host_of(service), command),
       .log = log.starts_with('/') ? std::filesystem::path(log)
                                   : folder_ / ((log.empty() ? service : log) + ".log")});
  if (!made) throw std::runtime_error(made.error().message());
  return std::move(*made);
}

void FaultRig::start_lab() {
  for (const char* name : {"recognition", "mapping", "simulation", "glove"})
    processes_.insert_or_assign(name, launch(name));
  ASSERT_TRUE(operate(40, [&] {
    return moved_by_ > 0 && statuses_.contains("recognition") &&
           !statuses_["mapping"].rates().empty();
  })) << "the lab does not start";
}

std::uint64_t FaultRig::leads() const {
  const auto simulation = statuses_.find("simulation");
  if (simulation != statuses_.end())
    for (const auto& rate : simulation->second.rates())
      if (rate.name().to_string() == "leads") return rate.total();
  return 0;
}

bool FaultRig::operate(double limit_s, const std::function<bool()>& condition) {
  return eventually(limit_s, [&] {
    for (auto& sample : states_->take())
      if (!sample.info.gone) {
        moved_by_ = sample.data.origin_ns();
        stillness_.add(sample.data);
      }
    for (auto& sample : grasps_->take())
      if (!sample.info.gone) reports_.insert(sample.data.sequence_number());
    for (auto& sample : health_->take())
      if (!sample.info.gone) statuses_[sample.data.name().to_string()] = sample.data;
    for (auto& sample : replies_->take())
      if (!sample.info.gone) {
        open_.erase(sample.data.id().to_string());
        // The way back is matched later than the way there: with keys and on a loaded machine the
        // first orders are obeyed before anybody can be told.
        if (answered_++ == 0) open_.clear();
      }
    if (orders_ && processes_.contains("mapping") && now_ns() > next_order_) {
      next_order_ = now_ns() + static_cast<std::int64_t>(operating_period * 1e9);
      eprosima::fastdds::dds::PublicationMatchedStatus matched;
      commands_->raw().get_publication_matched_status(matched);
      if (matched.current_count > 0) {  // nobody has promised anything to who is not there
        v1::OperatorCommand command;
        command.id(fmt::format("order-{}", ++given_));
        command.stamp_ns(now_ns());
        command.action(v1::ACTION_SET_MODE);
        command.target("mapping");
        command.argument("joints");
        open_.insert(command.id().to_string());
        commands_->write(command);
      }
    }
    return condition();
  });
}

double FaultRig::max_pause(double limit_s, const std::function<bool()>& condition) {
  std::int64_t last = now_ns(), moved = moved_by_;
  double longest = 0;
  operate(limit_s, [&] {
    if (moved_by_ != moved) {
      moved = moved_by_;
      last = now_ns();
    }
    longest = std::max(longest, static_cast<double>(now_ns() - last) * 1e-9);
    return condition();
  });
  return longest;
}

double FaultRig::recovery(std::int64_t time, double limit_s) {
  if (!operate(limit_s, [&] { return moved_by_ > time; })) return -1;
  return static_cast<double>(now_ns() - time) * 1e-9;
}

void FaultRig::resume_orders() {
  orders_ = true;
  const std::uint64_t before = answered_;
  EXPECT_TRUE(operate(20, [&] { return answered_ > before; })) << "no order is answered";
  open_.clear();
}

std::uint64_t FaultRig::unanswered() {
  orders_ = false;
  operate(20, [&] { return open_.empty(); });
  orders_ = true;
  const std::uint64_t lost = open_.size();
  for (const std::string& id : open_) std::cout << id << " of " << given_ << " is not answered\n";
  open_.clear();
  return lost;
}

std::uint64_t FaultRig::unreported() {
  auto late = dds::Participant::create(
      {.name = "late", .domain = domain_, .rig = name_, .network = network_, .role = "viewer"});
  if (!late) throw std::runtime_error(late.error().message());
  auto reader = late->reader(dds::grasp_report);
  if (!reader) throw std::runtime_error(reader.error().message());
  std::set<std::uint64_t> all;
  std::int64_t last = now_ns();
  // All come at once; when nothing more has come for a second, these are all.
  operate(5, [&] {
    for (auto& sample : reader->take())
      if (!sample.info.gone) {
        all.insert(sample.data.sequence_number());
        last = now_ns();
      }
    return now_ns() - last > 1'000'000'000;
  });
  return static_cast<std::uint64_t>(std::count_if(
      all.begin(), all.end(), [&](std::uint64_t number) { return !reports_.contains(number); }));
}

double FaultRig::memory() const {
  return std::accumulate(
      statuses_.begin(), statuses_.end(), 0.0,
      [](double sum, const auto& entry) { return sum + entry.second.resident(); });
}

FaultRow FaultRig::begin(const std::string& fault) {
  FaultRow row;
  row.fault = fault;
  undisturbed_ = max_pause(1.5);  // meanwhile a status of each comes
  row.memory_before = memory();
  return row;
}

void FaultRig::expect_recovery(FaultRow& row, double limit_s) {
  row.recoveries.push_back(recovery(now_ns()));
  EXPECT_GT(row.recoveries.back(), 0);
  EXPECT_LT(row.recoveries.back(), promised(limit_s));
}

void FaultRig::finish(FaultRow row) {
  operate(1.5);
  row.memory_after = memory();
  row.lost += unanswered() + unreported();
  EXPECT_EQ(row.lost, 0u);
  report(row);
  expect_alive();
}

void FaultRig::expect_alive() {
  for (auto& [name, process] : processes_)
    EXPECT_FALSE(process.exit()) << name << " ended: " << stage::last_lines(process.log(), 5);
}

}  // namespace prehend::integration
