#include "services/cli/service/listener.hpp"

#include <optional>

#include "common/dds/participant.hpp"
#include "common/service/membership.hpp"

namespace prehend::cli {

struct Listener::State {
  dds::Participant participant;
  std::optional<dds::Reader<v1::GloveFrame>> frames;
  std::optional<dds::Reader<v1::ObjectDetection>> detections;
  std::optional<dds::Reader<v2::GraspCandidates>> candidates;
  std::optional<dds::Reader<v2::HandCommand>> commands;
  std::optional<dds::Reader<v1::GraspReport>> reports;
  std::optional<dds::Reader<v1::ArmState>> arms;
  std::optional<dds::Reader<v1::ServiceStatus>> statuses;
};

Expected<Listener> Listener::create(const service::Config& config, bool everything) {
  auto participant = dds::Participant::create(service::membership(config, "prehend", "viewer"));
  if (!participant) return tl::unexpected(participant.error());
  auto state = std::make_unique<State>(State{std::move(*participant), {}, {}, {}, {}, {}, {}, {}});
  std::optional<Error> error;
  const auto open = [&](auto& reader, const auto& topic) {
    auto made = state->participant.reader(topic);
    if (made)
      reader.emplace(std::move(*made));
    else
      error = made.error();
  };
  open(state->statuses, dds::service_status);
  if (everything) {
    open(state->frames, dds::glove_frame);
    open(state->detections, dds::object_detection);
    open(state->candidates, dds::grasp_candidates);
    open(state->commands, dds::robot_command);
    open(state->reports, dds::grasp_report);
    if (!config.text("robot.arm").empty()) open(state->arms, dds::arm_state);
  }
  if (error) return tl::unexpected(*error);
  return Listener(std::move(state));
}

Listener::Listener(std::unique_ptr<State> state) : state_(std::move(state)) {}
Listener::Listener(Listener&&) noexcept = default;
Listener& Listener::operator=(Listener&&) noexcept = default;
Listener::~Listener() = default;

void Listener::poll(Observer& observer) {
  const auto take = [&](auto& reader) {
    if (!reader) return;
    for (const auto& sample : reader->take())
      if (!sample.info.gone) observer.hear(sample.data);
  };
  for (const auto& sample : state_->statuses->take()) {
    if (sample.info.gone)
      observer.lost_service(sample.data.service().to_string());
    else
      observer.hear(sample.data);
  }
  take(state_->frames);
  if (state_->detections)
    for (const auto& sample : state_->detections->take()) {
      if (sample.info.gone)
        observer.lost_object(sample.data.track());
      else
        observer.hear(sample.data);
    }
  take(state_->candidates);
  take(state_->commands);
  // What is heard of the arm ends with the report, so that comes last.
  take(state_->arms);
  take(state_->reports);
}

}  // namespace prehend::cli
