#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/dds/participant.hpp"

namespace prehend::service {

/// Who writes on a topic of which one writer at a time is followed, to choose another by its name.
class Writers {
 public:
  void heard(const dds::GuidPrefix& writer, Time now);

  /// name_of: as its status calls a writer, service@host/123. A mere «service» is the one of two
  /// that does not lead. Fails with the names of those who are there.
  Expected<dds::GuidPrefix> named(const std::string& name,
                                  const std::optional<dds::GuidPrefix>& leader, Time now,
                                  const std::function<std::string(const dds::GuidPrefix&)>& name_of,
                                  std::string_view topic) const;

 private:
  std::map<dds::GuidPrefix, Time> heard_;  // when they last wrote
};

}  // namespace prehend::service
