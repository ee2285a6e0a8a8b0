#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "tests/integration/hosts.hpp"
#include "tests/integration/rig.hpp"
#include "tests/integration/stillness.hpp"

namespace prehend::integration {

/// What became of one kind of fault: a row of the table that the program prints at its end.
struct FaultRow {
  std::string fault;
  int rounds = 0;
  std::uint64_t lost = 0;          // samples of operator/* and grasp/report
  std::vector<double> recoveries;  // s, from the fault's end until a new frame moved the hand
  double memory_before = 0, memory_after = 0;  // bytes, of all services together; 0: not measured
};
void report(const FaultRow& row);

/// Moves the test to a host of its own before the Rig takes part in the domain.
class OnHosts {
 protected:
  OnHosts();
  std::optional<Hosts> hosts_;
  std::string skip_;  // why there are none
};

/// A lab spread over hosts: glove on «hand», recognition on «eye», mapping and simulation on
/// «robot»; the test is an operator on a host of its own, who gives orders and reads everything.
class FaultRig : public OnHosts, public Rig {
 protected:
  explicit FaultRig(dds::Network network = {.profile = "lan"}) : Rig(std::move(network)) {}
  static constexpr double operating_period = 0.1;  // s, between orders

  /// Makes keys for everybody, before SetUp().
  void secure();

  void SetUp() override;
  /// Starts all four and waits until a frame of the glove moves the hand.
  void start_lab();
  virtual std::string host_of(const std::string& service) const;
  /// prefix: before the command; log: a name, or a path; the service's name where it is empty.
  stage::Process launch(const std::string& service, const Strings& prefix = {},
                        const Strings& sets = {}, const std::string& log = {});
  /// Lets the lab run, giving orders and reading, until the condition holds; false: not in time.
  bool operate(
      double limit_s, const std::function<bool()>& condition = [] { return false; });
  /// The longest time without a new frame that moved the hand, s, until the condition holds.
  double max_pause(
      double limit_s, const std::function<bool()>& condition = [] { return false; });
  /// Until a frame that was taken after `time` moved the hand; s since then. -1: never.
  double recovery(std::int64_t time, double limit_s = 15);
  /// Gives orders again, to a mapping that has just been started. Those before the first answer do
  /// not count: it may not have met us yet when we have met it.
  void resume_orders();
  /// Orders that were given and never answered, once they have had their time.
  std::uint64_t unanswered();
  /// Reports of grasps that a late joiner gets and the operator did not.
  std::uint64_t unreported();
  double memory() const;
  /// A row of the table, with what is before the fault: also the longest pause of this machine.
  FaultRow begin(const std::string& fault);
  /// The fault has just ended: a new frame moves the hand within so many s, as promised() has them.
  void expect_recovery(FaultRow& row, double limit_s);
  /// Nothing was lost and nobody ended: the row joins the table.
  void finish(FaultRow row);
  /// Every service is still the process that it was.
  void expect_alive();

  Strings sets_;
  std::map<std::string, stage::Process> processes_;
  std::int64_t moved_by_ = 0;                          // origin of the last state of the hand
  Stillness stillness_;                                // of the hand, since it was last begun anew
  std::map<std::string, v1::ServiceStatus> statuses_;  // last of each name
  std::set<std::uint64_t> reports_;                    // their numbers
  bool orders_ = true;                                 // give any
  double undisturbed_ = 0;  // s, the longest time without a new frame before the fault
  /// How often the lead over the hand has changed, by the simulation's own count.
  std::uint64_t leads() const;

 private:
  std::uint64_t given_ = 0;
  std::uint64_t answered_ = 0;
  std::set<std::string> open_;  // orders without an answer
  std::int64_t next_order_ = 0;
  std::optional<dds::Reader<v1::HandState>> states_;
  std::optional<dds::Reader<v1::GraspReport>> grasps_;
  std::optional<dds::Reader<v1::ServiceStatus>> health_;
  std::optional<dds::Reader<v1::OperatorReply>> replies_;
  std::optional<dds::Writer<v1::OperatorCommand>> commands_;
};

/// A time that is promised, s: as it is where it is measured, over many rounds on a machine that
/// has nothing else to do (PREHEND_LONG). Otherwise five times as long, which no load takes, and
/// which still is too short to wait for the lease of who is gone, 20 s.
double promised(double limit_s);

/// Rounds of a fault: few by default, many under PREHEND_LONG.
int rounds(int usual, int many);

}  // namespace prehend::integration
