#include "services/demonstration/core/segmentation/phase.hpp"

#include "common/base/named_values.hpp"

namespace prehend::demonstration {

namespace {

constexpr auto names = named_values<Phase>({{Phase::rest, "rest"},
                                            {Phase::approach, "approach"},
                                            {Phase::close, "close"},
                                            {Phase::hold, "hold"},
                                            {Phase::release, "release"},
                                            {Phase::retract, "retract"}});

}  // namespace

std::string_view to_string(Phase phase) {
  return names.name(phase);
}

}  // namespace prehend::demonstration
