#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "services/console/core/hub.hpp"
#include "services/console/core/view.hpp"

namespace prehend::console {

/// Orders that clients have given as calls of a service, until operator/reply or the end of
/// patience answers them. Pure.
class Desk {
 public:
  struct Answer {
    Hub::Call call;
    Expected<std::string> document;  // or why it was not done
  };

  /// id: of the order. for_all: many are asked, and all but one may refuse.
  void add(const std::string& id, bool for_all, Hub::Call call, Time now);
  /// What a message of operator/reply answers.
  std::vector<Answer> hear(View reply);
  /// What nobody has answered in time.
  std::vector<Answer> wait(Time now);

 private:
  struct Waiting {
    Hub::Call call;
    bool for_all = false;
    Time until{};
    std::string refused;  // by whom and why
  };
  std::map<std::string, Waiting> waiting_;  // by the order's id
};

}  // namespace prehend::console
