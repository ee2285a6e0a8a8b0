#include "services/performer/service/planner_ears.hpp"

#include <functional>
#include <utility>

#include "common/convert/grasp_candidates.hpp"
#include "common/dds/topics.hpp"

namespace prehend::performer {
namespace {

constexpr std::size_t max_objects = 1000;

}  // namespace

PlannerEars::PlannerEars(service::Shell& shell, std::string hand_name)
    : shell_(shell), hand_name_(std::move(hand_name)) {
  shell.subscribe(dds::grasp_candidates, std::function([this](const v2::GraspCandidates& message,
                                                              const dds::SampleInfo& info) {
                    if (message.hand().to_string() != hand_name_) return;
                    if (info.gone)
                      heard_.erase(message.track());
                    else if (heard_.size() < max_objects || heard_.contains(message.track()))
                      heard_[message.track()] = message;
                  }));
}

model::CandidateBook PlannerEars::of(const model::HandModel& hand) const {
  model::CandidateBook book;
  for (const auto& [track, message] : heard_) {
    const auto taken =
        convert::from_message(message, hand).and_then([&](model::GraspCandidates planned) {
          return book.observe(std::move(planned), hand);
        });
    if (!taken) shell_.status().drop(taken.error().what);
  }
  return book;
}

}  // namespace prehend::performer
