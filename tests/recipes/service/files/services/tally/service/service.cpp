#include "services/tally/service/service.hpp"

#include "common/dds/topics.hpp"

namespace prehend::tally {

Expected<std::unique_ptr<Service>> Service::create(service::Shell& shell) {
  return std::unique_ptr<Service>(new Service(shell));
}

Service::Service(service::Shell& shell) {
  shell.subscribe(dds::grasp_report, std::function([this, &shell](const v1::GraspReport& report,
                                                                  const dds::SampleInfo& info) {
                    if (info.gone) return;
                    const std::string grasp =
                        report.hand().to_string() + " " + std::to_string(report.sequence_number());
                    if (!tally_.add(grasp, report.held())) return;
                    shell.status().count("grasps");
                    if (report.held()) shell.status().count("held");
                  }));
  shell.status().running();
}

}  // namespace prehend::tally
