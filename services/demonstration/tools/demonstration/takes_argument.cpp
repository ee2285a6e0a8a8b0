#include "services/demonstration/tools/demonstration/takes_argument.hpp"

#include "common/base/log.hpp"
#include "common/base/log_format.hpp"

namespace prehend::demonstration {

Expected<Takes> told_takes(const std::string& folder) {
  auto takes = load_takes(folder);
  if (!takes) return takes;
  for (const Error& complaint : takes->complaints) log::warning(complaint);
  if (takes->bad_files > 0)
    log::warning("{} of {} files could not be used", takes->bad_files, takes->files);
  return takes;
}

}  // namespace prehend::demonstration
