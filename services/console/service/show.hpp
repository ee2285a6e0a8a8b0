#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/base/error.hpp"
#include "common/model/hand_model.hpp"
#include "common/recording/types/type.hpp"
#include "common/service/config.hpp"
#include "common/web/site.hpp"
#include "services/console/core/access.hpp"
#include "services/console/core/consent.hpp"
#include "services/console/core/desk.hpp"
#include "services/console/core/hub.hpp"
#include "services/console/core/lab_view.hpp"
#include "services/console/core/orders.hpp"
#include "services/console/core/round.hpp"
#include "services/console/service/film.hpp"
#include "services/console/service/mailbox.hpp"

namespace prehend::console {

/// The site: letters from a lab, or from a recording, become what the hub gives to clients.
class Show : public web::Site {
 public:
  struct Options {
    /// Who may look, and who may give orders.
    Policy policy;
    /// Called at each tick; gives what has come.
    std::function<std::vector<Letter>()> letters;
    std::function<std::int64_t()> now_ns;
    /// Gives an order and returns the name by which its reply is known; nothing: there is no lab.
    std::function<std::string(const Order&)> give;
    /// Somebody holds the deadman, or lets it go; nothing: there is no lab.
    std::function<void(const Consent&)> consent;
    /// Takes a line of a hand that the page tracks, for the glove.
    std::function<void(const std::string&)> hand;
    /// Why it does not; the page says so. Empty: it does.
    std::string no_hand;
    /// Where the programs that track a hand lie, once they have been fetched.
    std::filesystem::path tracking;
    Pose X_TW = Pose::Identity();  // T: the tracker's frame
    /// Who publishes and subscribes, when that has changed.
    std::function<std::optional<std::vector<TopicEnds>>()> graph;
    /// That is shown instead of a lab, and led by clients.
    Film* film = nullptr;
  };
  static Expected<std::unique_ptr<Show>> create(const service::Config& config, Options options);

  std::variant<web::Answer, web::Upgrade> answer(const web::Request& request) override;
  void tick() override;

  const Policy& policy() const { return options_.policy; }
  /// By which the page is reached; known when the server listens.
  void set_hosts(std::vector<std::string> hosts) { options_.policy.hosts = std::move(hosts); }

 private:
  /// Hands are read when somebody first speaks of them.
  class Hands {
   public:
    explicit Hands(const service::Config& config);
    const model::HandModel* find(const std::string& model);

   private:
    std::map<std::string, std::optional<model::HandModel>> known_;
  };

  Show(Options options, recording::types::Library types, LabView view, Hub hub,
       std::shared_ptr<Hands> hands, std::vector<ServiceInfo> services);
  /// To anything but a WebSocket.
  web::Answer answer(const Verdict& verdict, std::string_view body);
  web::Answer page(bool set_cookie) const;
  web::Answer order(std::string_view body);
  web::Answer hand(std::string_view body);
  web::Answer consent(std::string_view body);
  void obey(const Hub::Call& call);
  /// Its answer.
  Expected<std::string> take_consent(std::string_view body);
  void answer(const std::vector<Desk::Answer>& answers);
  web::Answer tracking(const std::string& name) const;
  /// Says of nothing any more that it has been told.
  void begin();
  void hand_on(const Letter& letter);
  void publish(Documents documents);

  Options options_;
  std::vector<ServiceInfo> services_;  // nothing: there is no lab
  recording::types::Library types_;
  std::shared_ptr<Hands> hands_;
  const LabView fresh_;
  LabView view_ = fresh_;
  Hub hub_;
  Desk desk_;
  Round round_;
  /// The last message of each instance: its end brings nothing.
  std::map<std::pair<std::size_t, dds::Guid>, Value> last_;
  Time next_second_{};
  std::uint64_t queued_ = 0;
};

}  // namespace prehend::console
