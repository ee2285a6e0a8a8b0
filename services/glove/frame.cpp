#include "frame.hpp"

namespace prehend::glove {

std::optional<model::Finger> finger_of(Site site) {
  switch (site) {
    case Site::thumb:
      return model::Finger::thumb;
    case Site::index:
      return model::Finger::index;
    case Site::middle:
      return model::Finger::middle;
    case Site::ring:
      return model::Finger::ring;
    case Site::little:
      return model::Finger::little;
    case Site::back_of_hand:
    case Site::forearm:
      break;
  }
  return std::nullopt;
}

const std::vector<Site>& sites_by_address() {
  static const std::vector<Site> sites{Site::back_of_hand, Site::thumb,  Site::index,
                                       Site::little,       Site::middle, Site::ring};
  return sites;
}

}  // namespace prehend::glove
