#pragma once

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "common/base/error.hpp"
#include "common/gate/motion_limiter.hpp"
#include "common/robot/gatekeeper.hpp"
#include "common/service/order_book.hpp"
#include "common/service/shell.hpp"
#include "services/simulation/core/simulation.hpp"
#include "services/simulation/service/arm_teller.hpp"

namespace prehend::simulation {

/// The shell around a Simulation: topics in, topics out, and the judge in a thread of its own, so
/// that the world goes on while a grasp is judged. In lockstep the judge answers in the same cycle.
class Service {
 public:
  static Expected<std::unique_ptr<Service>> create(service::Shell& shell);
  ~Service();
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

 private:
  /// A hand of the lab, by its number in the simulation.
  struct Hand {
    std::string name;  // key of its topics
    model::HandModel model;
    std::unique_ptr<robot::Gatekeeper> gate{};
    Time led{};  // when it was last told to go on
  };

  Service(service::Shell& shell, std::deque<Hand> hands, model::Catalogue catalogue,
          grasping::CatalogueBodies bodies);
  static Expected<std::deque<Hand>> hands_of(const service::Config& config);
  Expected<void> start();
  Expected<void> build();
  Expected<void> open_gate(int hand);
  Expected<void> obey(const v2::HandCommand& message, const gate::Place& place, Time now, int hand);
  std::optional<gate::Place> where(int hand) const;
  void go(const gate::Place& place, Time now, int hand);
  void on_detection(const v1::ObjectDetection& message);
  void on_order(const v1::OperatorCommand& order, const dds::SampleInfo& info);
  Expected<std::string> place(const v1::OperatorCommand& order, const dds::SampleInfo& info);
  void on_tick(Time now);
  void publish_state();
  void publish_hand(int hand);
  void publish_scene();
  void judge_soon(Closure closure);
  void publish_report(const Closure& closure, const GraspVerdict& verdict);
  void judge_queued();

  service::Shell& shell_;
  std::deque<Hand> hands_;      // stable addresses
  model::Catalogue catalogue_;  // what scenes are read by
  grasping::CatalogueBodies bodies_;
  bool from_scene_ = false;
  std::unique_ptr<Simulation> simulation_;
  std::optional<ArmTeller> arm_;  // none: the hand flies
  service::Shell::Output<v1::HandState> hand_state_;
  service::Shell::Output<v1::HandTouch> hand_touch_;
  service::Shell::Output<v1::ObjectState> object_state_;
  service::Shell::Output<v1::SceneState> scene_state_;
  service::Shell::Output<v1::GraspReport> reports_;
  service::Shell::Output<v1::OperatorReply> replies_;
  service::OrderBook orders_;
  std::uint64_t sequence_ = 0, scene_sequence_ = 0;
  Duration state_period_{};
  Time next_state_{};
  bool scene_changed_ = true;

  std::mutex mutex_;
  std::condition_variable waiting_;
  std::deque<Closure> queue_;  // for the judge
  bool stopping_ = false;
  std::thread judge_;
};

}  // namespace prehend::simulation
